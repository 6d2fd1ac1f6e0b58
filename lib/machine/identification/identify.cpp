// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/identify.hpp"

#include <Eigen/Cholesky>
#include <bit>

#include "base/student.hpp"
#include "base/units.hpp"
#include "machine/identification/identify_system.hpp"

namespace millpose {
namespace {

using identify::Rows;
using identify::Six;
using identify::System;

/// Least squares c ≥ 0 over the joints in `free`.
struct Solution {
  Six c = Six::Zero();
  Matrix6 inverse = Matrix6::Zero();  ///< of the normal matrix over the free joints above 0
  std::array<bool, 6> active{};       ///< free and above 0
};

/// Minimum of ½cᵀNc − gᵀc over the joints of `subset` (bits), the others 0.
Solution SolveSubset(const Matrix6& N, const Six& g, unsigned subset) {
  std::vector<int> keep;
  for (int j = 0; j < 6; ++j)
    if (subset >> j & 1u) keep.push_back(j);
  Solution solution;
  if (keep.empty()) return solution;
  const auto scale = [&](int j) { return 1 / std::sqrt(N(j, j)); };
  const auto size = static_cast<Eigen::Index>(keep.size());
  Eigen::MatrixXd M(size, size);
  Eigen::VectorXd h(size);
  for (Eigen::Index a = 0; a < size; ++a) {
    h[a] = g[keep[a]] * scale(keep[a]);
    for (Eigen::Index b = 0; b < size; ++b) M(a, b) = N(keep[a], keep[b]) * scale(keep[a]) * scale(keep[b]);
  }
  const Eigen::MatrixXd inverse = M.llt().solve(Eigen::MatrixXd::Identity(size, size));
  const Eigen::VectorXd c = inverse * h;
  for (Eigen::Index a = 0; a < size; ++a) {
    solution.c[keep[a]] = c[a] * scale(keep[a]);
    solution.active[keep[a]] = true;
    for (Eigen::Index b = 0; b < size; ++b)
      solution.inverse(keep[a], keep[b]) = inverse(a, b) * scale(keep[a]) * scale(keep[b]);
  }
  return solution;
}

/// The exact minimum with c ≥ 0: the best of all subsets whose free compliances come out positive.
Solution SolveNonNegative(const Matrix6& N, const Six& g, unsigned free) {
  Solution best = SolveSubset(N, g, free);
  const auto positive = [](const Solution& s) {
    for (int j = 0; j < 6; ++j)
      if (s.active[j] && s.c[j] <= 0) return false;
    return true;
  };
  if (positive(best)) return best;
  double least = kInfinity;
  for (unsigned subset = 0; subset < 64; ++subset) {
    if ((subset & ~free) != 0) continue;
    const Solution candidate = SolveSubset(N, g, subset);
    const double value = 0.5 * candidate.c.dot(N * candidate.c) - g.dot(candidate.c);
    if (!positive(candidate) || value >= least) continue;
    least = value;
    best = candidate;
  }
  return best;
}

double Median(Eigen::VectorXd values) {
  std::sort(values.begin(), values.end());
  const Eigen::Index n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// Solves with or without Huber's weights; `weights` leaves as used.
Solution Solve(const System& system, unsigned free, bool robust, Eigen::VectorXd& weights) {
  weights = Eigen::VectorXd::Ones(system.x.size());
  Solution solution;
  constexpr int kIterations = 50;
  constexpr double kHuber = 1.345;
  for (int iteration = 0; iteration < (robust ? kIterations : 1); ++iteration) {
    const Matrix6 N = system.L.transpose() * weights.asDiagonal() * system.L;
    const Six g = system.L.transpose() * weights.cwiseProduct(system.x);
    solution = SolveNonNegative(N, g, free);
    if (!robust) break;
    const Eigen::VectorXd size = (system.L * solution.c - system.x).cwiseAbs();
    const double scale = 1.4826 * Median(size);
    for (Eigen::Index i = 0; i < size.size(); ++i)
      weights[i] = size[i] <= kHuber * scale ? 1.0 : kHuber * scale / size[i];
  }
  return solution;
}

System Without(const System& system, const std::vector<size_t>& pose_of_case, size_t pose) {
  std::vector<Eigen::Index> keep;
  for (size_t i = 0; i < system.case_of_row.size(); ++i)
    if (pose_of_case[system.case_of_row[i]] != pose) keep.push_back(static_cast<Eigen::Index>(i));
  return {system.L(keep, Eigen::all), system.x(keep), {}};
}

void CountPoses(const std::vector<LoadCase>& cases, Identification& result) {
  for (size_t i = 0; i < cases.size(); ++i) {
    if (i > 0 && cases[i].q != cases[i - 1].q) ++result.poses;
    result.pose_of_case.push_back(result.poses);
  }
  ++result.poses;
}

void FillResiduals(const Arm& arm, const std::vector<LoadCase>& cases, const Six& c, Identification& result) {
  IdentifyOptions unweighted;
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

void FillEstimates(const Solution& solution, unsigned free, double level, double freedom, const Matrix6& N,
                   Identification& result) {
  const double t = StudentQuantile(freedom);
  for (int j = 0; j < 6; ++j) {
    JointEstimate& joint = result.joints[j];
    if (!(free >> j & 1u)) continue;
    const double c = solution.c[j];
    const double deviation = level * std::sqrt(solution.active[j] ? solution.inverse(j, j) : 1 / N(j, j));
    joint.lower = 1 / (c + t * deviation);
    joint.upper = c > t * deviation ? 1 / (c - t * deviation) : kInfinity;
    joint.determined = solution.active[j];
    if (!joint.determined) {
      joint.reason = "not determined: the data put its compliance at 0 or below";
      continue;
    }
    joint.stiffness = 1 / c;
    joint.deviation = deviation / (c * c);
  }
}

void FillInfluence(const System& system, unsigned free, bool robust, Identification& result) {
  for (size_t pose = 0; pose < result.poses; ++pose) {
    const System rest = Without(system, result.pose_of_case, pose);
    if (rest.L.rows() < 6) return;
    unsigned still = 0;
    const auto reasons = identify::Observability(rest.L);
    for (int j = 0; j < 6; ++j) still |= (free >> j & 1u) && reasons[j].empty() ? 1u << j : 0u;
    Eigen::VectorXd weights;
    const Solution solution = Solve(rest, still, robust, weights);
    for (int j = 0; j < 6; ++j) {
      JointEstimate& joint = result.joints[j];
      if (!joint.determined) continue;
      const double change =
          solution.active[j] ? std::abs(1 / solution.c[j] / joint.stiffness - 1) : kInfinity;
      if (change <= joint.largest_change) continue;
      joint.largest_change = change;
      joint.most_influential = pose;
    }
  }
}

}  // namespace

Identification IdentifyJointStiffness(const Arm& arm, const std::vector<LoadCase>& cases,
                                      const IdentifyOptions& options) {
  Identification result;
  CountPoses(cases, result);
  const System system = identify::MakeSystem(arm, cases, options);
  const std::array<std::string, 6> reasons = identify::Observability(system.L);
  unsigned free = 0;
  for (int j = 0; j < 6; ++j) {
    result.joints[j].reason = reasons[j];
    free |= reasons[j].empty() ? 1u << j : 0u;
  }
  result.condition = identify::Condition(system.L, reasons);
  const double freedom = static_cast<double>(system.x.size()) - std::popcount(free);
  if (freedom < 1) {
    for (JointEstimate& joint : result.joints)
      if (joint.reason.empty()) joint.reason = "not determined: no more measured numbers than unknowns";
    return result;
  }
  Eigen::VectorXd weights;
  const Solution solution = Solve(system, free, options.robust, weights);
  const Eigen::VectorXd residual = system.L * solution.c - system.x;
  result.level = std::sqrt(residual.dot(weights.cwiseProduct(residual)) / freedom);
  const Matrix6 N = system.L.transpose() * weights.asDiagonal() * system.L;
  FillEstimates(solution, free, result.level, freedom, N, result);
  FillResiduals(arm, cases, solution.c, result);
  FillInfluence(system, free, options.robust, result);
  return result;
}

}  // namespace millpose
