// SPDX-License-Identifier: GPL-3.0-or-later
// What the mean cutting force moves at every planned point (docs/process-force.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/byte_sink.hpp"
#include "machine/stiffness/series.hpp"
#include "planning/result/plan_result.hpp"
#include "toolpath/engagement/process_force.hpp"

namespace millpose {

/// One planned cut point's predicted deflection.
struct DeflectedPoint {
  size_t number = 0;  ///< as in points.csv
  int pass = 0;
  Engagement engagement;
  Eigen::Vector3d force;           ///< the engagement's, in P, N
  PredictedDeflection deflection;  ///< mm
  Eigen::Vector3d moved;           ///< the same vector in P, mm
  double largest_normal = 0;       ///< along the normal under any force within the bounds, mm
  bool face = false;               ///< it leaves the finished face
};

/// How sure a force is: up to a share longer than computed, up to an angle (rad) off.
struct ForceDoubt {
  double length = 0, angle = 0;
};

/// The force on a plan's points and what it moves. Deflections hold at the plan's stiffness origin.
struct DeflectionReport {
  CuttingForce force;                  ///< where the mean force is greatest
  std::vector<DeflectedPoint> points;  ///< planned cut points in the plan's order
  std::optional<FaceDeflection> face;  ///< of the finished face; empty for fewer than 3 points
  ForceDoubt bounds;                   ///< as handed
  std::string source = {};             ///< of the job's own force coefficients, where it says one
};

/// What every report says about the figures.
inline constexpr char kDeflectionModel[] =
    "static compliance of what the cell models under the mean cutting force; no dynamics, no chatter, no "
    "prediction of flatness";

/// `finished_from` is the first pass of the layer that leaves the finished face: earlier layers are cut away
/// again and do not count in `face`, nor do points in air. `heaviest` is passed on.
DeflectionReport PredictDeflections(const PlanResult& plan, const CuttingForce& heaviest,
                                    const std::vector<SeriesCompliance>& compliances, int finished_from = 0,
                                    const ForceDoubt& bounds = {});

/// point,pass,side,width_mm,depth_mm,force_x_N … (in P),x_um … (in P),normal_um,feed_um,across_um,length_um;
/// 17 significant digits. Rows are made on `threads` threads, in order.
void WriteDeflectionCsv(const DeflectionReport& report, int threads, const ByteSink& sink);

}  // namespace millpose
