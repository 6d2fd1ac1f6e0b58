// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "geometry/mesh/mesh.hpp"
#include "toolpath/milling_point.hpp"
#include "toolpath/toolpath_options.hpp"

namespace millpose {

/// Makes the passes that mill a region of a mesh, in frame P, in the order of milling. All positions lie on
/// the mesh (1e-6 mm). A pass ends at the region's border, at rims and at creases; the parts of an
/// interrupted lane are passes that follow each other (unless they are ordered by travel). The tool axis is
/// the normal, turned by `lead` towards the feed direction (about normal × feed) and then by `tilt` about the
/// feed direction (to its right, seen against the normal). Throws InputError for options out of range and for
/// a region that holds nothing; Interrupted.
Toolpath MakeToolpath(const Mesh& mesh, const ToolpathOptions& options, std::stop_token stop);

/// Seen from another frame: every position p becomes X p, every direction R d.
void Transform(const Eigen::Isometry3d& X, Pass& pass);
Toolpath Transformed(const Toolpath& toolpath, const Eigen::Isometry3d& X);

}  // namespace millpose
