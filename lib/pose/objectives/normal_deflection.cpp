// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/objectives/normal_deflection.hpp"

#include "pose/objective_parameters.hpp"
#include "stiffness/indices_block.hpp"

namespace millpose {

NormalDeflection::NormalDeflection(const ObjectiveParameters& parameters) {
  ParameterReader("normal_deflection", parameters, {});
}

void NormalDeflection::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneDeflectionsBlock deflections;
  DeflectionsInPlane(c, context.normal, deflections);
  out = deflections.normal;
}

}  // namespace millpose
