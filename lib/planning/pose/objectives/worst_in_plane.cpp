// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/indices_block.hpp"
#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

/// σmax(cB), mm/N, with B a basis of the milling plane: the largest displacement of the tip in any direction
/// under 1 N in the plane. It bounds what milling forces do; eq. 23 does not (docs/stiffness.md). No
/// parameters.
class WorstInPlane final : public PlainObjective {
 public:
  using PlainObjective::PlainObjective;
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;
};

void WorstInPlane::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneDeflectionsBlock deflections;
  DeflectionsInPlane(c, context.normal, deflections);
  out = deflections.largest;
}

}  // namespace

ObjectiveEntry WorstInPlaneEntry() {
  return {"worst_in_plane", {}, [](const ObjectiveParameters&) {
            return std::make_unique<WorstInPlane>("worst_in_plane", "mm/N");
          }};
}

}  // namespace millpose
