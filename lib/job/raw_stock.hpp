// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/triangles.hpp"
#include "job/inputs.hpp"

namespace millpose {

/// The surface of a job's raw part (`workpiece.stock`), in P, mm; of a cylinder a prism around it that is
/// wider by 0.06 % at most. Bent with the part where that was registered so. Without faces where the job has
/// none. Throws InputError for a file that is no mesh.
Triangles RawStock(const JobInputs& inputs);

}  // namespace millpose
