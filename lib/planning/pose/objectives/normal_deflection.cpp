// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/indices_block.hpp"
#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

/// nᵀcn, mm/N: displacement along the surface normal n under 1 N along it. Unlike λn it is a displacement
/// (docs/stiffness.md). No parameters.
class NormalDeflection final : public PlainObjective {
 public:
  using PlainObjective::PlainObjective;
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;
};

void NormalDeflection::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneDeflectionsBlock deflections;
  DeflectionsInPlane(c, context.normal, deflections);
  out = deflections.normal;
}

}  // namespace

ObjectiveEntry NormalDeflectionEntry() {
  return {"normal_deflection", {}, [](const ObjectiveParameters&) {
            return std::make_unique<NormalDeflection>("normal_deflection", "mm/N");
          }};
}

}  // namespace millpose
