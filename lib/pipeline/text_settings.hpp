// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/assemble.hpp"

namespace millpose {

/// Settings of one post as far as the cell's texts need them: as MakePostSettings(), without asking whether
/// the controller can run the cell as it stands, its external axes among it.
PostSettings MakeTextSettings(const JobSettings& job, const CellSettings& cell,
                              const std::string& controller);

}  // namespace millpose
