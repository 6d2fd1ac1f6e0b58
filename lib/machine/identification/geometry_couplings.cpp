// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/geometry_couplings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "machine/identification/simplest_model.hpp"

namespace millpose {
namespace {

CouplingModel JudgedBy(const GeometryFit& fit, const std::vector<JointPair>& couplings) {
  CouplingModel model;
  model.couplings = couplings;
  for (size_t k = 0; k < couplings.size(); ++k) model.estimates.push_back(fit.Coupling(k));
  const std::vector<double>& squares = fit.left_out_squares();
  const auto count = static_cast<double>(squares.size());
  for (const double square : squares) model.mean_square += square / count;
  double spread = 0;
  for (const double square : squares) spread += (square - model.mean_square) * (square - model.mean_square);
  model.deviation = std::sqrt(spread / (count - 1) / count);
  return model;
}

/// That is looked for or known.
bool Has(const GeometryFitOptions& options, const JointPair& pair) {
  return std::ranges::find(options.couplings, pair) != options.couplings.end() ||
         std::ranges::any_of(options.law.couplings, [&](const JointCoupling& one) {
           return JointPair{one.joint, one.follows} == pair;
         });
}

}  // namespace

CouplingModels TryCouplings(const Arm& arm, const std::vector<TrackedPose>& poses,
                            const GeometryFitOptions& options, const GeometryFit& plain) {
  constexpr JointPair kOffered[] = {{3, 2}, {5, 4}, {6, 4}, {6, 5}};
  CouplingModels models;
  models.tried.push_back(JudgedBy(plain, {}));
  for (;;) {
    std::optional<CouplingModel> best;
    for (const JointPair& offered : kOffered) {
      GeometryFitOptions with = options;
      with.couplings = models.tried.back().couplings;
      if (Has(with, offered)) continue;
      with.couplings.push_back(offered);
      const CouplingModel next = JudgedBy(GeometryFit(arm, poses, with), with.couplings);
      if (!best || next.mean_square < best->mean_square) best = next;
    }
    if (!best) break;
    models.tried.push_back(*best);
  }
  ChooseSimplest(models);
  return models;
}

}  // namespace millpose
