// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/links/retract.hpp"

namespace millpose {
namespace {

constexpr std::array<double, 4> kMultiples{1, 2, 4, 0.5};

/// The retract by just the height of the options.
Retract RetractByHeight(Checker& checker, const Carrier& carrier, const Joints& q, const JointLimits& limits,
                        const RetractOptions& options) {
  Retract retract;
  retract.X_WT_end = carrier.ToolPose(q) * Pose(Eigen::Translation3d(0, 0, options.height));
  LineMotion line = FollowLine(carrier, q, retract.X_WT_end, limits.lower, limits.upper);
  retract.problem = line.problem;
  for (const Joints& along : line.joints) {
    if (!retract.problem.empty()) break;
    if (const CoupledLimit* beyond = FirstBeyond(limits.coupled, along, kRevolutionRounding))
      retract.problem = CoupledText(*beyond, along);
  }
  if (retract.problem.empty())
    if (const auto found = checker.BlockedAlong(line.joints, Phase::kCutting, options.swept_resolution))
      retract.problem = NearText(checker.Measure(*found));
  if (retract.problem.empty()) {
    if (const auto found = checker.At(line.joints.back(), Phase::kFree)) {
      retract.problem = fmt::format("{:.1f} mm out, {}", options.height, NearText(*found));
    }
  }
  retract.joints = std::move(line.joints);
  return retract;
}

}  // namespace

JointLimits LimitsAround(const Arm& arm, double margin, const Joints& q) {
  JointLimits limits{arm.lower.array() + margin, arm.upper.array() - margin, arm.coupled_limits};
  for (CoupledLimit& limit : limits.coupled) limit.at_most -= margin;
  limits.Include(q);
  return limits;
}

void JointLimits::Include(const Joints& q) {
  lower = lower.cwiseMin(q);
  upper = upper.cwiseMax(q);
  for (CoupledLimit& limit : coupled) limit.at_most = std::max(limit.at_most, limit.factors.dot(q));
}

Retract FindRetract(Checker& checker, const Carrier& carrier, const Joints& q, const JointLimits& limits,
                    const RetractOptions& options) {
  Retract first;
  for (const double multiple : kMultiples) {
    RetractOptions by = options;
    by.height *= multiple;
    Retract retract = RetractByHeight(checker, carrier, q, limits, by);
    if (retract.problem.empty()) return retract;
    if (multiple == kMultiples[0]) first = std::move(retract);
  }
  return first;
}

bool CanLeave(Checker& checker, const Carrier& carrier, const Joints& q, const RetractOptions& options) {
  const JointLimits limits = LimitsAround(carrier.arm, options.limit_margin, q);
  return FindRetract(checker, carrier, q, limits, options).problem.empty();
}

double ShareToLeave(const World& world, const Carrier& carrier, const Joints& q,
                    const RetractOptions& options) {
  for (const double share : {1.0, kClearanceShares.back()}) {
    Checker checker(world, share);
    if (CanLeave(checker, carrier, q, options)) return share;
  }
  return 0;
}

std::string NearText(const Interference& found) {
  if (found.distance <= 0) return fmt::format("{} touches {}", found.second, found.first);
  return fmt::format("{} is {:.2f} mm from {}", found.second, found.distance, found.first);
}

}  // namespace millpose
