// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "toolpath/cutter.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// Where a cutter goes deepest into a part.
struct Gouge {
  double depth = 0;  ///< of a point of the surface in the cutter, from the cutter's own surface, mm; 0: none
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  int face = -1;
};

/// The point of the mesh's surface that lies deepest in the cutter, up to its length; depths of at most
/// `tolerance` (mm) count as none. The cutter is convex, so the depth is concave over a triangle: a tangent
/// plane of it bounds it from above, and triangles are halved until the bound is met (to 1e-4 mm or 0.1 % of
/// the depth). docs/gouges.md.
Gouge DeepestGouge(const Mesh& mesh, const CutterShape& cutter, const Eigen::Vector3d& tip,
                   const Eigen::Vector3d& axis, double tolerance);

/// What is done about points at which the cutter would go into the part.
enum class GougeAction : uint8_t {
  kSkip,    ///< they are marked (MillingPoint::gouge) and not milled; leads are left out
  kLift,    ///< they are moved along the tool axis until the cutter is clear
  kReport,  ///< they stay as they are
};

struct GougeOptions {
  GougeAction action = GougeAction::kSkip;
  double tolerance = 0.05;  ///< depth that is allowed, mm
};

/// What was found, in the frame of the tool path.
struct GougeReport {
  size_t points = 0;          ///< at which or next to which the cutter goes into the part, leads included
  size_t leads_left_out = 0;  ///< with kSkip
  double largest_lift = 0;    ///< with kLift, mm
  Gouge deepest;              ///< before anything was done
};

/// Checks a tool path in frame P against the whole part, at its points and between them in steps of a tenth
/// of the cutter's radius (0.5 mm at least), and does what `options` say. Throws Interrupted.
GougeReport CheckGouges(const Mesh& mesh, const CutterShape& cutter, const GougeOptions& options, int threads,
                        Toolpath& toolpath, std::stop_token stop);

}  // namespace millpose
