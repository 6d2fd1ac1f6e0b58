// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "machine/stiffness/indices_block.hpp"
#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

/// Chen 2021 eq. 23: f = w1·λτ2 + w2·λn, mm/N, of the ellipsoid of the linear compliance c at the stiffness
/// origin. λτ2 is the smaller semi-axis of its section with the milling plane (eq. 19), λn its radius along
/// the plane's normal (eq. 21). Parameters w1, w2 ≥ 0, default 0.5 each (they reproduce the paper's optimum).
///
/// With `reference_t2` and `reference_n` (mm/N, both or none) the radii are divided by them first, so that
/// the weights are shares of the two: f = w1·λτ2/reference_t2 + w2·λn/reference_n, without unit.
class Chen2021 final : public Objective {
 public:
  explicit Chen2021(const ObjectiveParameters& parameters);
  std::string Name() const override { return "chen2021"; }
  bool DependsOnFeed() const override { return false; }
  bool ReadsToolAxis() const override { return false; }
  std::string Unit() const override { return normalised_ ? "1" : "mm/N"; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;

 private:
  double w1_, w2_;
  bool normalised_;
};

Chen2021::Chen2021(const ObjectiveParameters& parameters)
    : w1_(parameters.at("w1")), w2_(parameters.at("w2")) {
  if (w1_ + w2_ <= 0.0)
    throw InputError(SourceLocation{}, "objective chen2021: w1 and w2 are both 0; allowed: one above 0");
  const double reference_t2 = parameters.at("reference_t2"), reference_n = parameters.at("reference_n");
  normalised_ = reference_t2 > 0.0 && reference_n > 0.0;
  if (!normalised_ && reference_t2 + reference_n > 0.0)
    throw InputError(
        SourceLocation{},
        "objective chen2021: only one of reference_t2 and reference_n is above 0; allowed: both, or none");
  if (!normalised_) return;
  w1_ /= reference_t2;
  w2_ /= reference_n;
}

void Chen2021::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneIndicesBlock indices;
  IndicesInPlane(c, context.normal, indices);
  for (int i = 0; i < kLanes; ++i) {
    const double along =
        indices.lambda_n.v[i];  // +inf where c is singular; a weight of 0 must not make that NaN
    out.v[i] = std::isfinite(along) ? w1_ * indices.lambda_t2.v[i] + w2_ * along : along;
  }
}

}  // namespace

ObjectiveEntry Chen2021Entry() {
  return {"chen2021",
          {{"w1", 0.5, 0.0}, {"w2", 0.5, 0.0}, {"reference_t2", 0.0, 0.0}, {"reference_n", 0.0, 0.0}},
          [](const ObjectiveParameters& all) { return std::make_unique<Chen2021>(all); },
          false,
          false,
          true};
}

}  // namespace millpose
