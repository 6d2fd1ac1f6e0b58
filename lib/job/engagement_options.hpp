// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/mesh.hpp"
#include "job/inputs.hpp"
#include "toolpath/engagement/engagement.hpp"

namespace millpose {

/// What a job says of cutter, material and stock. Precondition: it has `process.cutting`. Throws InputError
/// for what cannot be or contradicts the tool path.
EngagementOptions MakeEngagementOptions(const JobInputs& inputs, const Mesh& mesh);

}  // namespace millpose
