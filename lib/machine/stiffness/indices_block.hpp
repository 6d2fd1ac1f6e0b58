// SPDX-License-Identifier: GPL-3.0-or-later
// The milling plane's indices for a block of compliances, one per lane: closed forms without eigensolvers.
#pragma once

#include "machine/stiffness/compliance.hpp"
#include "machine/stiffness/compliance_block.hpp"

namespace millpose {

/// MillingPlaneIndices per lane. Where c is singular all of λ are +inf and μ is 0.
struct PlaneIndicesBlock {
  Lanes lambda_t1, lambda_t2, lambda_n, mu, normal_compliance;
};
void IndicesInPlane(const ComplianceBlock& c, const Eigen::Vector3d& normal, PlaneIndicesBlock& out,
                    InstructionSet set = WidestInstructionSet());

/// PlaneDeflections per lane.
struct PlaneDeflectionsBlock {
  Lanes normal, in_plane, largest, cross;
};
void DeflectionsInPlane(const ComplianceBlock& c, const Eigen::Vector3d& normal, PlaneDeflectionsBlock& out,
                        InstructionSet set = WidestInstructionSet());

}  // namespace millpose
