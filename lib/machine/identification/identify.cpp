// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/identify.hpp"

#include "base/student.hpp"
#include "base/units.hpp"
#include "machine/identification/identify_system.hpp"

namespace millpose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using identify::Solution;
using identify::System;

void FillResiduals(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options,
                   const VectorXd& c, Identification& result) {
  IdentifyOptions unweighted = options;
  unweighted.displacement_deviation = 1;
  double square = 0;
  for (size_t i = 0; i < cases.size(); ++i) {
    LoadCase load = cases[i];
    load.rotation.reset();
    const System one = identify::MakeSystem(arm, {load}, unweighted);
    result.residuals.push_back((one.L * c - one.x).norm());
    square += result.residuals.back() * result.residuals.back();
  }
  result.rms = std::sqrt(square / static_cast<double>(cases.size()));
}

/// By 95 %, of each compliance.
VectorXd HalfWidths(const Solution& solution, double level, double freedom, const MatrixXd& N) {
  const double t = StudentQuantile(freedom);
  VectorXd half(N.cols());
  for (Eigen::Index j = 0; j < N.cols(); ++j)
    half[j] =
        t * level * std::sqrt(solution.active[static_cast<size_t>(j)] ? solution.inverse(j, j) : 1 / N(j, j));
  return half;
}

constexpr const char* kAtZero = "not determined: the data put its compliance at 0 or below";

void FillEstimates(const Solution& solution, const std::vector<char>& free, double level, double freedom,
                   const MatrixXd& N, Identification& result) {
  const VectorXd half = HalfWidths(solution, level, freedom, N);
  for (size_t j = 0; j < 6; ++j) {
    JointEstimate& joint = result.joints[j];
    if (!free[j]) continue;
    const auto at = static_cast<Eigen::Index>(j);
    const double c = solution.c[at];
    joint.lower = 1 / (c + half[at]);
    joint.upper = c > half[at] ? 1 / (c - half[at]) : kInfinity;
    joint.determined = solution.active[j];
    if (!joint.determined) {
      joint.reason = kAtZero;
      continue;
    }
    joint.stiffness = 1 / c;
    joint.deviation = half[at] / StudentQuantile(freedom) / (c * c);
  }
  for (size_t k = 0; k < result.beside.size(); ++k) {
    GiveEstimate& give = result.beside[k];
    if (!free[6 + k]) continue;
    const auto at = static_cast<Eigen::Index>(6 + k);
    give.determined = solution.active[6 + k];
    if (!give.determined) give.reason = kAtZero;
    give.compliance = solution.c[at];
    give.lower = std::max(0.0, solution.c[at] - half[at]);
    give.upper = solution.c[at] + half[at];
  }
}

void FillInfluence(const System& system, const std::vector<char>& free, bool robust, Identification& result) {
  for (size_t pose = 0; pose < result.poses; ++pose) {
    const System rest = identify::Without(system, result.pose_of_case, pose);
    if (rest.L.rows() < rest.L.cols()) return;
    std::vector<char> still = free;
    const std::vector<std::string> reasons = identify::Observability(rest.L);
    for (size_t j = 0; j < still.size(); ++j) still[j] = free[j] && reasons[j].empty();
    VectorXd weights;
    const Solution solution = identify::Solve(rest, still, robust, weights);
    for (size_t j = 0; j < 6; ++j) {
      JointEstimate& joint = result.joints[j];
      if (!joint.determined) continue;
      const double change = solution.active[j]
                                ? std::abs(1 / solution.c[static_cast<Eigen::Index>(j)] / joint.stiffness - 1)
                                : kInfinity;
      if (change <= joint.largest_change) continue;
      joint.largest_change = change;
      joint.most_influential = pose;
    }
  }
}

}  // namespace

std::vector<Give> TiltingOf(int link) {
  constexpr int kOwn[] = {2, 1, 1, 0, 1, 2};  // the joint's axis, of the frame after it
  std::vector<Give> gives;
  for (int axis = 0; axis < 3; ++axis)
    if (axis != kOwn[link - 1]) gives.push_back({link, axis, false});
  return gives;
}

Identification IdentifyJointStiffness(const Arm& arm, const std::vector<LoadCase>& cases,
                                      const IdentifyOptions& options) {
  Identification result;
  result.pose_of_case = identify::PosesOf(cases);
  result.poses = result.pose_of_case.back() + 1;
  for (const Give& give : options.beside) result.beside.emplace_back().give = give;
  const System system = identify::MakeSystem(arm, cases, options);
  const std::vector<std::string> reasons = identify::Observability(system.L);
  std::vector<char> free;
  for (size_t j = 0; j < reasons.size(); ++j) {
    (j < 6 ? result.joints[j].reason : result.beside[j - 6].reason) = reasons[j];
    free.push_back(reasons[j].empty());
  }
  result.condition = identify::Condition(system.L, reasons);
  const double freedom =
      static_cast<double>(system.x.size()) - static_cast<double>(std::ranges::count(free, 1));
  if (freedom < 1) {
    for (JointEstimate& joint : result.joints)
      if (joint.reason.empty()) joint.reason = "not determined: no more measured numbers than unknowns";
    return result;
  }
  VectorXd weights;
  const Solution solution = identify::Solve(system, free, options.robust, weights);
  const VectorXd residual = system.L * solution.c - system.x;
  result.level = std::sqrt(residual.dot(weights.cwiseProduct(residual)) / freedom);
  const MatrixXd N = system.L.transpose() * weights.asDiagonal() * system.L;
  FillEstimates(solution, free, result.level, freedom, N, result);
  FillResiduals(arm, cases, options, solution.c, result);
  FillInfluence(system, free, options.robust, result);
  return result;
}

}  // namespace millpose
