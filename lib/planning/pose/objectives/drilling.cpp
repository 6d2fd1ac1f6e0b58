// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/indices_block.hpp"
#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

/// aᵀca, mm/N: displacement along the tool axis a under 1 N along it, for drilling and plunging. No
/// parameters.
class Drilling final : public PlainObjective {
 public:
  using PlainObjective::PlainObjective;
  bool ReadsToolAxis() const override { return true; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;
};

void Drilling::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneDeflectionsBlock deflections;
  DeflectionsInPlane(c, context.tool_axis, deflections);
  out = deflections.normal;
}

}  // namespace

ObjectiveEntry DrillingEntry() {
  return {"drilling", {}, [](const ObjectiveParameters&) {
            return std::make_unique<Drilling>("drilling", "mm/N");
          }};
}

}  // namespace millpose
