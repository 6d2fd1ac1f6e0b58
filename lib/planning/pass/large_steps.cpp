// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/large_steps.hpp"

#include "planning/ladder/edge_kernel.hpp"
#include "planning/result/pass_value.hpp"

namespace millpose {
namespace {

constexpr double kUsedUp = 0.7;  // share of a bound: the search knows steps on its grid alone

bool IsLarge(const Carrier& carrier, const PlannedPoint& from, const PlannedPoint& to,
             const PathOptions& options) {
  const auto barred = [](const PlannedPoint& point) {
    return point.skip != Infeasibility::kNone && point.skip != Infeasibility::kStep;
  };
  if (barred(from) || barred(to)) return false;
  if (from.skip == Infeasibility::kStep || to.skip == Infeasibility::kStep) return true;
  if (from.piece != to.piece) return std::isfinite(options.steps.most.minCoeff());
  const Joints step = (to.q - from.q).unaryExpr(&WrapToPi);
  if ((step.cwiseAbs().array() > kUsedUp * options.steps.most.array()).any()) return true;
  return HalfwayDeviation(carrier, from.q, from.q + step).position > kUsedUp * options.max_deviation;
}

}  // namespace

std::vector<char> LargeSteps(const Carrier& carrier, const Pass& pass, const PassResult& plan,
                             const PathOptions& options) {
  const size_t count = pass.points.size();
  std::vector<char> large(count, 0);
  const std::vector<size_t> places = PlacesOf(plan, pass);
  if (places.size() != count || count < 2) return large;
  const auto begin = static_cast<size_t>(std::max(0, plan.opened_at));
  const size_t steps = pass.closed ? count : count - 1;
  const auto mark = [&](size_t step) {
    if (step < steps) large[step] = 1;
  };
  for (size_t k = 0; k < steps; ++k) {
    const PlannedPoint &from = plan.points[places[k]], &to = plan.points[places[(k + 1) % count]];
    if (!IsLarge(carrier, from, to, options)) continue;
    const size_t t = (begin + k) % count;
    mark(t);
    mark(pass.closed ? (t + 1) % count : t + 1);
    mark(pass.closed ? (t + count - 1) % count : t - 1);
  }
  return large;
}

}  // namespace millpose
