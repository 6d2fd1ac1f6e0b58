// SPDX-License-Identifier: GPL-3.0-or-later
// The admissible predicate a second time, slowly and from its definition: frames of the links and differences
// of them, nothing of lib/planning/pose and no closed form of lib/machine/robot.
#pragma once

#include <Eigen/SVD>

#include "base/decompositions.hpp"
#include "base/units.hpp"
#include "planning/pose/scorer.hpp"

namespace millpose {

/// All vectors equal to `q` up to full revolutions of single joints within the bounds, every combination
/// tried.
inline std::vector<Joints> RevolutionsWithin(const AdmissibleBounds& bounds, const Joints& q) {
  std::vector<Joints> found{q};
  for (int j = 0; j < 6; ++j) {
    std::vector<Joints> next;
    for (const Joints& from : found) {
      for (int k = -3; k <= 3; ++k) {
        Joints turned = from;
        turned[j] += k * 2 * kPi;
        if (turned[j] >= bounds.lower[j] && turned[j] <= bounds.upper[j]) next.push_back(turned);
      }
    }
    found = std::move(next);
  }
  return found;
}

/// Distances to the singularities from where the links are.
inline SingularityDistance MeasuredDistance(const Arm& arm, const Joints& q) {
  const std::array<Pose, 7> link = LinkFrames(arm, q);
  const Eigen::Vector3d first = link[1].linear().col(2), second = link[2].linear().col(1);
  const auto across = [&](Eigen::Vector3d v) { return Eigen::Vector3d(v - v.dot(second) * second); };
  const Eigen::Vector3d upper = across(link[3].translation() - link[2].translation()).normalized(),
                        fore = across(link[4].translation() - link[3].translation()).normalized();
  return {.wrist = link[4].linear().col(0).cross(link[6].linear().col(2)).norm(),
          .elbow = upper.cross(fore).norm(),
          .shoulder = std::abs(first.cross(second).dot(link[5].translation()))};
}

/// Dexterity from the singular values of a Jacobian of central differences.
inline double MeasuredDexterity(const PoseProblem& problem, const Joints& q) {
  constexpr double kStep = 1e-5;
  const Eigen::Matrix3d middle = (ForwardFlange(problem.arm, q) * problem.X_FT).linear();
  Matrix6 J;
  for (int j = 0; j < 6; ++j) {
    const Joints step = kStep * Joints::Unit(j);
    const Pose before = ForwardFlange(problem.arm, q - step) * problem.X_FT,
               after = ForwardFlange(problem.arm, q + step) * problem.X_FT;
    const Eigen::Matrix3d turn =
        (after.linear() - before.linear()) / (2 * kStep) * middle.transpose();  // [z]×
    J.col(j) << (after.translation() - before.translation()) / (2 * kStep) / problem.characteristic_length,
        turn(2, 1), turn(0, 2), turn(1, 0);
  }
  const Eigen::VectorXd s = SingularValues(J);
  return 6 / std::sqrt(s.squaredNorm() * s.cwiseInverse().squaredNorm());
}

/// What keeps the joint angles `q`, as they are, from being used. Misses of up to `slack` (sines, m) of the
/// bounds on singularity and dexterity count as none: an optimum may be on such a bound.
inline Infeasibility ReferenceInfeasibility(const PoseProblem& problem, const Joints& q,
                                            double slack = 1e-9) {
  const AdmissibleBounds& bounds = problem.bounds;
  for (int j = 0; j < 6; ++j)
    if (q[j] < bounds.lower[j] || q[j] > bounds.upper[j]) return Infeasibility::kLimit;
  for (const CoupledLimit& limit : bounds.coupled) {
    double sum = -limit.at_most;
    for (int j = 0; j < 6; ++j) sum += limit.factors[j] * q[j];
    if (sum > 1e-12) return Infeasibility::kLimit;
  }
  const SingularityDistance distance = MeasuredDistance(problem.arm, q);
  double missed = std::max(0.0, bounds.wrist_min - distance.wrist) +
                  std::max(0.0, bounds.elbow_min - distance.elbow) +
                  std::max(0.0, bounds.shoulder_min_mm - distance.shoulder) / 1000;
  if (bounds.dexterity_min > 0) missed += std::max(0.0, bounds.dexterity_min - MeasuredDexterity(problem, q));
  return missed > slack ? Infeasibility::kSingular : Infeasibility::kNone;
}

}  // namespace millpose
