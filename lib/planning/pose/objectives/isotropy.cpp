// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "machine/stiffness/indices_block.hpp"
#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

/// 1/μ = λτ1/λτ2 ≥ 1: how slim the section of the ellipsoid with the milling plane is (Chen 2021, 4.1, where
/// μ is to be large). It says nothing about how stiff the pose is. No parameters.
class Isotropy final : public PlainObjective {
 public:
  using PlainObjective::PlainObjective;
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;
};

void Isotropy::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneIndicesBlock indices;
  IndicesInPlane(c, context.normal, indices);
  for (int i = 0; i < kLanes; ++i)
    out.v[i] = indices.mu.v[i] > 0 ? 1 / indices.mu.v[i] : std::numeric_limits<double>::infinity();
}

}  // namespace

ObjectiveEntry IsotropyEntry() {
  return {
      "isotropy", {}, [](const ObjectiveParameters&) { return std::make_unique<Isotropy>("isotropy", "1"); }};
}

}  // namespace millpose
