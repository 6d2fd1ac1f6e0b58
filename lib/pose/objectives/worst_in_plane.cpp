// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/objectives/worst_in_plane.hpp"

#include "pose/objective_parameters.hpp"
#include "stiffness/indices_block.hpp"

namespace millpose {

WorstInPlane::WorstInPlane(const ObjectiveParameters& parameters) {
  ParameterReader("worst_in_plane", parameters, {});
}

void WorstInPlane::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneDeflectionsBlock deflections;
  DeflectionsInPlane(c, context.normal, deflections);
  out = deflections.largest;
}

}  // namespace millpose
