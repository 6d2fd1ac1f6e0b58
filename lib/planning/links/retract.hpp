// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/units.hpp"
#include "machine/collision/world.hpp"
#include "machine/motion/line.hpp"

namespace millpose {

struct RetractOptions {
  double height = 50;                 ///< mm along the tool axis
  double swept_resolution = 0.5;      ///< mm
  double limit_margin = DegToRad(1);  ///< to the arm's limits, rad
};

/// Shares of the cell's clearances with which gaps are tried, one after the other; less than all of it is
/// reported.
inline constexpr std::array<double, 4> kClearanceShares{1, 0.9, 0.5, 0.25};

/// How the tool leaves the material, or comes to it when run backwards.
struct Retract {
  std::vector<Joints> joints;        ///< from the piece outwards; one entry at home
  Pose X_WT_end = Pose::Identity();  ///< tool at its end
  std::string problem;               ///< empty: it is free
};

/// What the joints must keep within, rad.
struct JointLimits {
  Joints lower, upper;
  std::vector<CoupledLimit> coupled = {};

  /// No narrower than `q`.
  void Include(const Joints& q);
};

/// The arm's limits less a margin (rad), but no narrower than `q`: where a piece ends may be planned nearer.
JointLimits LimitsAround(const Arm& arm, double margin, const Joints& q);

/// The straight retract along the tool axis from `q`, within limits: by the height asked for,
/// else by 2 or 4 times that (a pocket), else by half of it (no room). While it leaves, the cutter may still
/// be at the material (Phase::kCutting); at its end the whole tool keeps its clearance. The problem is that
/// of the height asked for.
Retract FindRetract(Checker& checker, const Carrier& carrier, const Joints& q, const JointLimits& limits,
                    const RetractOptions& options);

/// Whether the tool can leave `q`, with a share of the clearances that `checker` was made with.
bool CanLeave(Checker& checker, const Carrier& carrier, const Joints& q, const RetractOptions& options);

/// The largest share of the clearances with which `q` can be left: 1, the smallest of kClearanceShares, or 0.
double ShareToLeave(const World& world, const Carrier& carrier, const Joints& q,
                    const RetractOptions& options);

/// "link3_front is 9.81 mm from workpiece".
std::string NearText(const Interference& found);

}  // namespace millpose
