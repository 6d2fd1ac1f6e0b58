// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "toolpath/deepest_gouge.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

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
  Gouge
      deepest;  ///< before anything was done; of a cutter wholly inside, how far its tip is from the surface
};

/// Into how many steps a way of the tip (mm) is cut where it is looked at between points.
int GougeSteps(const CutterShape& cutter, double way);

/// Checks a tool path in frame P against the whole part, at its points and between them in steps of a tenth
/// of the cutter's radius (0.5 mm at least), and does what `options` say. A cutter that touches no surface
/// because it is wholly inside a closed piece of the part counts as well. Throws Interrupted.
GougeReport CheckGouges(const Mesh& mesh, const CutterShape& cutter, const GougeOptions& options,
                        const Execution& execution, Toolpath& toolpath);

}  // namespace millpose
