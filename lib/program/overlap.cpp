// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/overlap.hpp"

#include "machine/motion/corner.hpp"

namespace millpose {

AllAxes OverlapOf(const MotionProgram& program, size_t i, const OverlapCorner& corner,
                  const Joints& acceleration) {
  const Joints first = (corner.q - corner.before) / corner.in,
               second = (corner.after - corner.q) / corner.out;
  const double shorter = std::min(corner.in, corner.out);
  if (!CoordinatedMotions(program, i) && !CoordinatedMotions(program, i + 1))
    return {OverlapRounding(first, second, acceleration, shorter), {}};
  double stop = StopTime(first, second, acceleration);
  const std::vector<Motion>& motions = program.motions;
  ExternalPosition change;
  for (size_t k = 0; k < program.external_axes.size(); ++k) {
    const double into = (motions[i].external[k] - motions[i - 1].external[k]) / corner.in;
    const double out = (motions[i + 1].external[k] - motions[i].external[k]) / corner.out;
    stop = std::max(stop, std::max(std::abs(into), std::abs(out)) / program.external_axes[k].acceleration);
    change.push_back(out - into);
  }
  const double share = std::min(stop, shorter) / 8;
  for (double& value : change) value *= share;
  return {share * (second - first), std::move(change)};
}

Pose FrameBeside(const MotionProgram& program, size_t i, const ExternalPosition& off) {
  const Motion& motion = program.motions[i];
  Pose X_BP = *FrameOf(program, motion);
  if (off.empty()) return X_BP;
  ExternalPosition there = motion.external;
  for (size_t k = 0; k < there.size(); ++k) there[k] += off[k];
  return BaseOnPart(program, there).inverse(Eigen::Isometry) * BaseOnPart(program, motion.external) * X_BP;
}

}  // namespace millpose
