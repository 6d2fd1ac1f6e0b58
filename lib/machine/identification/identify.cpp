// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/identify.hpp"

#include "base/student.hpp"
#include "base/units.hpp"
#include "machine/identification/identify_system.hpp"
#include "machine/identification/leave_one_out.hpp"

namespace millpose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using identify::Fitted;
using identify::Solution;

void FillResiduals(const Fitted& fit, const IdentifyOptions& options, Identification& result) {
  const VectorXd off = fit.system.L * fit.solution.c - fit.system.x;
  std::vector<double> squares(result.pose_of_case.size(), 0);
  double square = 0;
  for (Eigen::Index row = 0; row < off.size(); ++row)
    if (fit.system.displaces[static_cast<size_t>(row)])
      squares[fit.system.case_of_row[static_cast<size_t>(row)]] += off[row] * off[row];
  for (const double one : squares) {
    result.residuals.push_back(options.displacement_deviation * std::sqrt(one));
    square += result.residuals.back() * result.residuals.back();
  }
  result.rms = std::sqrt(square / static_cast<double>(squares.size()));
}

/// What the data say of each unknown, by 95 %.
struct Intervals {
  VectorXd lower, upper, deviation;
};

/// Of what solves the normal equations with unknowns of any sign: about the bounded solution, in which some
/// are 0, the others seem surer than they are. A compliance's interval is cut off at 0, and reaches at least
/// one standard deviation: far below 0 nothing would be left. All hold the bounded solution.
Intervals IntervalsOf(const Fitted& fit, double level) {
  const MatrixXd weighted = fit.weights.asDiagonal() * fit.system.L;
  const Solution any = identify::SolveSubset(fit.system.L.transpose() * weighted,
                                             weighted.transpose() * fit.system.x, fit.free);
  const VectorXd& c = fit.solution.c;
  const VectorXd deviation = level * any.inverse.diagonal().cwiseSqrt();
  const VectorXd half = StudentQuantile(fit.freedom()) * deviation;
  VectorXd lower = any.c - half, upper = any.c + half;
  for (Eigen::Index j = 0; j < c.size() - (fit.system.payload ? 1 : 0); ++j) {
    lower[j] = std::max(lower[j], 0.0);
    upper[j] = std::max(upper[j], deviation[j]);
  }
  return {lower.cwiseMin(c), upper.cwiseMax(c), deviation};
}

constexpr const char* kTooFew = "not determined: no more measured numbers than unknowns";
constexpr const char* kAtZero = "not determined: the data put its compliance at 0 or below";

void FillEstimates(const Fitted& fit, const Intervals& intervals, Identification& result) {
  const Solution& solution = fit.solution;
  const std::vector<char>& free = fit.free;
  for (size_t j = 0; j < 6; ++j) {
    JointEstimate& joint = result.joints[j];
    if (!free[j]) continue;
    const auto at = static_cast<Eigen::Index>(j);
    const double c = solution.c[at];
    joint.lower = 1 / intervals.upper[at];
    joint.upper = intervals.lower[at] > 0 ? 1 / intervals.lower[at] : kInfinity;
    joint.determined = solution.active[j];
    if (!joint.determined) {
      joint.reason = kAtZero;
      continue;
    }
    joint.stiffness = 1 / c;
    joint.deviation = intervals.deviation[at] / (c * c);
  }
  for (size_t k = 0; k < result.beside.size(); ++k) {
    GiveEstimate& give = result.beside[k];
    if (!free[6 + k]) continue;
    const auto at = static_cast<Eigen::Index>(6 + k);
    give.determined = solution.active[6 + k];
    if (!give.determined) give.reason = kAtZero;
    give.compliance = solution.c[at];
    give.lower = intervals.lower[at];
    give.upper = intervals.upper[at];
  }
}

void FillPayload(const Fitted& fit, const Intervals& intervals, PayloadEstimate& payload) {
  if (!fit.system.payload) {
    payload.reason = kTooFew;
    return;
  }
  payload.reason = fit.reasons.back();
  payload.determined = payload.reason.empty();
  if (!payload.determined) return;
  payload.weight = fit.solution.c.tail<1>()[0];
  payload.lower = intervals.lower.tail<1>()[0];
  payload.upper = intervals.upper.tail<1>()[0];
}

void FillInfluence(const Fitted& fit, Identification& result) {
  const identify::LeaveOneOut without(fit, result.pose_of_case);
  if (result.poses < 2) return;
  for (size_t pose = 0; pose < result.poses; ++pose) {
    const identify::LeaveOneOut::Rest rest = without.Without(pose);
    for (size_t j = 0; j < 6; ++j) {
      JointEstimate& joint = result.joints[j];
      if (!joint.determined) continue;
      const double c = rest.c[static_cast<Eigen::Index>(j)];
      const double change = c > 0 ? std::abs(1 / c / joint.stiffness - 1) : kInfinity;
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
    if (axis != kOwn[link - 1]) gives.push_back({link, axis, Give::Kind::kTilts});
  return gives;
}

Give TakingUpOf(int joint) { return {joint, 0, Give::Kind::kTakesUp}; }

Identification IdentifyJointStiffness(const Arm& arm, const std::vector<LoadCase>& cases,
                                      const IdentifyOptions& options) {
  Identification result;
  result.pose_of_case = identify::PosesOf(cases);
  result.poses = result.pose_of_case.back() + 1;
  for (const Give& give : options.beside) result.beside.emplace_back().give = give;
  if (options.payload) result.payload.emplace();
  std::optional<identify::System> weight;
  if (options.payload) weight = identify::MakeWeightSystem(arm, cases, options);
  const Fitted fit = identify::FitSystem(identify::MakeSystem(arm, cases, options),
                                         weight ? &*weight : nullptr, options.robust);
  for (size_t j = 0; j < 6 + result.beside.size(); ++j)
    (j < 6 ? result.joints[j].reason : result.beside[j - 6].reason) = fit.reasons[j];
  result.condition = identify::Condition(fit.system.L, fit.reasons);
  const double freedom = fit.freedom();
  if (freedom < 1) {
    for (JointEstimate& joint : result.joints)
      if (joint.reason.empty()) joint.reason = kTooFew;
    if (result.payload) result.payload->reason = kTooFew;
    return result;
  }
  const VectorXd residual = fit.system.L * fit.solution.c - fit.system.x;
  result.level = std::sqrt(residual.dot(fit.weights.cwiseProduct(residual)) / freedom);
  const Intervals intervals = IntervalsOf(fit, result.level);
  FillEstimates(fit, intervals, result);
  if (result.payload) FillPayload(fit, intervals, *result.payload);
  FillResiduals(fit, options, result);
  FillInfluence(fit, result);
  return result;
}

}  // namespace millpose
