// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/objectives/isotropy.hpp"

#include <limits>

#include "pose/objective_parameters.hpp"
#include "stiffness/indices_block.hpp"

namespace millpose {

Isotropy::Isotropy(const ObjectiveParameters& parameters) { ParameterReader("isotropy", parameters, {}); }

void Isotropy::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  PlaneIndicesBlock indices;
  IndicesInPlane(c, context.normal, indices);
  for (int i = 0; i < kLanes; ++i)
    out.v[i] = indices.mu.v[i] > 0 ? 1 / indices.mu.v[i] : std::numeric_limits<double>::infinity();
}

}  // namespace millpose
