// SPDX-License-Identifier: GPL-3.0-or-later
// A trim's way with its entries, rounds, tabs and leads.
#pragma once

#include "toolpath/strategies/trim_offset.hpp"

namespace millpose {

/// One pass that trims along `path` in all its rounds. `contour`: what leads keep away from. Throws
/// InputError where leads or tabs have no room.
Pass TrimPass(const Trim& trim, const ToolpathOptions& options, const Contour& contour,
              const OffsetPath& path);

}  // namespace millpose
