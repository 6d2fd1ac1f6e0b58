// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/base_window.hpp"

#include <array>

#include "base/units.hpp"
#include "job/assemble.hpp"
#include "job/compensate_job.hpp"
#include "program/controller_axes.hpp"
#include "run/pipeline/programs/program_motions.hpp"

namespace millpose {
namespace {

constexpr std::array<double, 3> kShares = {1, 0.5, 0.25};  // of the asked window that are tried
constexpr int kCorners = 16;
constexpr double kSameConfiguration =
    0.5;  // rad: a start farther from the planned one has another configuration

/// Corner number `i` of a window: signs of the shifts along and the turns about X, Y, Z. Of the 64 corners of
/// the six-dimensional window 16 are taken so that any three of the six stand in all their combinations (the
/// fractional factorial design 2^(6-2) with E = ABC, F = BCD).
Pose WindowCorner(int i, double shift, double turn) {
  std::array<double, 6> sign{};
  for (size_t k = 0; k < 4; ++k) sign[k] = (i >> k & 1) != 0 ? 1 : -1;
  sign[4] = sign[0] * sign[1] * sign[2];
  sign[5] = sign[1] * sign[2] * sign[3];
  Pose corner = Pose::Identity();
  corner.translation() = shift * Eigen::Vector3d(sign[0], sign[1], sign[2]);
  corner.linear() = FromAnglesZyx(turn * Eigen::Vector3d(sign[3], sign[4], sign[5]));
  return corner;
}

/// What goes wrong with the base shifted; empty when nothing does.
std::string WhatBars(const MotionProgram& planned, const Cell& cell, const Pose& X_PP,
                     const std::optional<ArmDeviations>& deviations, VerifyOptions options,
                     const Execution& execution) {
  MotionProgram program = planned;
  program.X_BP = *planned.X_BP * X_PP;
  program.files = {"shifted"};
  Cell shifted = cell;
  shifted.X_WP = cell.X_WP * X_PP;
  const Pose X_TF = planned.X_FT->inverse();
  for (Motion& motion : program.motions) {
    if (motion.X_BP) motion.X_BP = *motion.X_BP * X_PP;
    if (!motion.status) continue;
    // The controller goes where S and T of the text lead from the shifted pose.
    const auto q = AnglesAt(cell.arm, program.axes, *FrameOf(program, motion) * motion.X_PT * X_TF,
                            *motion.status, *motion.turn);
    if (!q) return fmt::format("the start of pass {} is out of reach", motion.pass);
    if ((*q - *motion.q).cwiseAbs().maxCoeff() > kSameConfiguration)
      return fmt::format("S and T of the start of pass {} lead to another joint position", motion.pass);
    motion.q = *q;
  }
  // Compared with itself: only its own motion can be wrong.
  std::optional<World> as_it_is;
  if (deviations) options.as_it_is = &as_it_is.emplace(AsItIs(shifted, *deviations));
  const std::vector<Finding> findings = Verify(program, World(shifted), &program, options, execution);
  return findings.empty() ? std::string() : findings.front().message;
}

}  // namespace

std::optional<BaseWindow> FindBaseWindow(const PlanResult& plan, const JobInputs& inputs, const Cell& cell,
                                         const Execution& execution) {
  const JobSettings& job = inputs.job;
  const bool wanted = job.program_options.base_shift > 0 || job.program_options.base_turn > 0;
  if (job.workpiece.targets.empty() || job.programs.empty() || !wanted) return std::nullopt;
  if (!WhyNotProgrammable(plan).empty()) return std::nullopt;
  const MotionProgram planned = MakeProgramMotions(plan, inputs, job.programs.front(), {}).planned;
  VerifyOptions options = MakeVerifyOptions(job, plan.arm);
  options.interference = true;
  options.most_findings = 1;
  BaseWindow window;
  for (const double share : kShares) {
    window.shift = share * job.program_options.base_shift;
    window.turn = share * job.program_options.base_turn;
    std::string obstacle;
    for (int i = 0; i < kCorners && obstacle.empty(); ++i)
      obstacle = WhatBars(planned, cell, WindowCorner(i, window.shift, window.turn),
                          CommandedDeviations(job, inputs.cell), options, execution);
    if (obstacle.empty()) return window;
    window.obstacle = obstacle;
  }
  window.shift = window.turn = 0;
  return window;
}

std::string BaseWindowText(const BaseWindow& window) {
  if (window.shift == 0 && window.turn == 0)
    return "the base must not be shifted: no window could be verified";
  return fmt::format("+-{} mm along and +-{} deg about X, Y, Z, reach and clearance verified",
                     Fixed(window.shift, 3), Fixed(window.turn * kDegPerRad, 4));
}

}  // namespace millpose
