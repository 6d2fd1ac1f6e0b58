// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/objectives/drilling.hpp"

#include "pose/objective_parameters.hpp"
#include "stiffness/indices_block.hpp"

namespace millpose {

Drilling::Drilling(const ObjectiveParameters& parameters) { ParameterReader("drilling", parameters, {}); }

void Drilling::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneDeflectionsBlock deflections;
  DeflectionsInPlane(c, context.tool_axis, deflections);
  out = deflections.normal;
}

}  // namespace millpose
