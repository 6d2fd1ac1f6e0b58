// SPDX-License-Identifier: GPL-3.0-or-later
// Parts and options that the tests of strategies share, and what holds for every tool path.
#pragma once

#include "toolpath/make_toolpath.hpp"

namespace millpose {

/// A plate of 100 mm with a square hole of 20 mm in its middle.
Mesh Plate();
/// Planes over support_pad's face.
ToolpathOptions PadOptions();
/// Rings on the wall of a cylinder of radius 60 mm, height 40 mm.
ToolpathOptions WallRings();

/// What options are refused with; "accepted" where they are not.
std::string PathRefusal(const Mesh& mesh, const ToolpathOptions& options);
size_t PointsOf(const Toolpath& toolpath);
/// What holds for every tool path whose positions lie on a mesh.
void ExpectSound(const Mesh& mesh, const Toolpath& toolpath, const ToolpathOptions& options);
/// Distance of a point from the nearest pass, mm.
double DistanceFromPath(const Toolpath& toolpath, const Eigen::Vector3d& p);

/// Of the places where the cutter passes what it has milled before on one side alone, the share (by points)
/// at which that is on its left, so that unmilled material is on its right. `aside` (mm): where it is looked
/// for.
double ClimbShare(const Toolpath& toolpath, double aside);

}  // namespace millpose
