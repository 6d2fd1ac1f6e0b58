// SPDX-License-Identifier: GPL-3.0-or-later
// Thrust and torque of a twist drill (docs/process-force.md).
#pragma once

#include "toolpath/engagement/process_force.hpp"

namespace millpose {

/// The lips of a twist drill: straight edges from the axis to the diameter, on a cone of `point_angle`.
struct DrillLips {
  CuttingMaterial material;
  double diameter = 0;     ///< mm
  int teeth = 2;           ///< lips
  double point_angle = 0;  ///< of the whole cone, rad; π is flat

  /// How far the lips at a radius lie above the tip, both mm.
  double Height(double radius) const;
};

/// What the tool feels along its axis and about it; forces across it cancel between the lips.
struct DrillLoad {
  double thrust = 0;  ///< N, towards the holder
  double torque = 0;  ///< N·mm
};

/// The load of a ring that the lips cut: `width`, its outer diameter, `depth`, a_p = (D − d)/2, both mm; from
/// the full it is D and D/2. `feed_per_tooth`: mm along the axis, above 0.
///
/// Each lip takes a chip of thickness h = f_z·sin κ, κ half the point's angle, with k_c = k_c1.1·h^(−m_c)
/// (Kienzle). The torque follows from k_c alone: it is the work per volume. The thrust is
/// 0.63·a_p·f·k_c·sin κ with the feed per revolution f (ISCAR, rotating tools catalogue 2017, page 601,
/// "Calculations").
DrillLoad LoadOfDrill(const DrillLips& lips, double width, double depth, double feed_per_tooth);

}  // namespace millpose
