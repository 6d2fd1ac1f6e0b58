// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/describe_point.hpp"

#include "machine/stiffness/pose_stiffness.hpp"
#include "planning/pose/evaluator.hpp"
#include "planning/pose/lean_problem.hpp"

namespace millpose {

void DescribePoint(const PoseProblem& problem, const PathNode& node, PlannedPoint& point) {
  point.freedoms = node.freedoms;
  if (HasLean(problem)) point.point = AtLean(problem, point.point, node.freedoms);
  for (size_t d = 0; d < point.freedoms.size(); ++d)
    point.freedoms[d] = Confine(*problem.freedoms[d], point.freedoms[d]);
  point.branch = node.branch;
  point.q = node.q;
  point.objective = node.objective;
  point.from_genetic = node.genetic;
  const Eigen::Vector3d tip = problem.X_FT.translation();
  const Eigen::Vector3d origin = problem.origin == StiffnessOrigin::kToolTip ? tip : Eigen::Vector3d::Zero();
  const Eigen::Vector3d normal = problem.X_WB.linear().transpose() * point.point.normal;
  const PoseStiffness stiffness =
      EvaluatePose(problem.arm, node.q, origin, normal, problem.characteristic_length, problem.compliances);
  if (stiffness.indices) point.indices = *stiffness.indices;
  point.lambda_3 = stiffness.lambda[2];
  point.lambda_3_direction = problem.X_WB.linear() * stiffness.directions.col(2);
  point.dexterity = Dexterity(Jacobian(problem.arm, node.q, tip), problem.characteristic_length);
}

}  // namespace millpose
