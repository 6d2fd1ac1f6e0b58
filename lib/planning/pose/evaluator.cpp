// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/evaluator.hpp"

namespace millpose {

bool Fitter(const Individual& a, const Individual& b) {
  if (a.objective != b.objective) return a.objective < b.objective;
  return a.shortfall < b.shortfall;
}

void Evaluator::Consider(int branch, int lane, const FreedomValues& freedoms) {
  const Infeasibility obstacle = block_.obstacle[branch][lane];
  if (obstacle != Infeasibility::kNone) {
    if (!best_.found && obstacle > best_.reason) best_.reason = obstacle;
    return;
  }
  const double value = block_.objective[branch].v[lane];
  if (best_.found && value >= best_.objective) return;
  best_.found = true;
  best_.reason = Infeasibility::kNone;
  best_.freedoms = freedoms;
  best_.branch = branch;
  best_.objective = value;
  best_.q = CandidateOf(block_, branch, lane).q;
}

double Confine(const Freedom& freedom, double value) {
  const double range = freedom.Upper() - freedom.Lower();
  if (!freedom.Periodic()) return std::clamp(value, freedom.Lower(), freedom.Upper());
  return value - range * std::floor((value - freedom.Lower()) / range);
}

double Difference(const Freedom& freedom, double a, double b) {
  const double range = freedom.Upper() - freedom.Lower();
  return freedom.Periodic() ? (b - a) - range * std::round((b - a) / range) : b - a;
}

}  // namespace millpose
