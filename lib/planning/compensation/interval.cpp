// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/interval.hpp"

#include "machine/stiffness/compliance.hpp"

namespace millpose {

namespace {

using Eigen::Vector3d;

}  // namespace

ComplianceParts::ComplianceParts(const Arm& arm, const Joints& q, const Vector3d& p_FT,
                                 const std::vector<SeriesCompliance>& elements)
    : beside_(!elements.empty()) {
  const Matrix6 J = Jacobian(arm, q, p_FT);
  for (int j = 0; j < 6; ++j) {
    const Vector3d column = J.block<3, 1>(0, j);
    parts_[static_cast<size_t>(j)] = column * column.transpose() / arm.stiffness[j];
  }
  parts_.back() = SeriesComplianceAt(arm, q, p_FT, elements).topLeftCorner<3, 3>();
  sum_ = (Compliance(J, arm.stiffness) + SeriesComplianceAt(arm, q, p_FT, elements)).topLeftCorner<3, 3>();
}

std::array<Vector3d, ComplianceParts::kParts> ComplianceParts::Towards(const Vector3d& direction) const {
  std::array<Vector3d, kParts> towards;
  for (size_t i = 0; i < kParts; ++i) towards[i] = parts_[i] * direction;
  return towards;
}

Compensation::Along ComplianceParts::Along(const Vector3d& direction, const Vector3d& force,
                                           const ForceBounds& forces,
                                           const StiffnessBounds& stiffness) const {
  Compensation::Along found;
  found.expected = direction.dot(sum_ * force);
  found.low = found.high = found.expected;
  std::array<Vector3d, kParts> soft, stiff;  // what each part gives where it is softest and stiffest
  const std::array<Vector3d, kParts> parts = Towards(direction);
  for (size_t i = 0; i < kParts; ++i) {
    const double share = i < 6 ? stiffness.joints[static_cast<Eigen::Index>(i)] : stiffness.beside;
    soft[i] = parts[i] / (1 - share);
    stiff[i] = parts[i] / (1 + share);
  }
  const ForceCone cone(force, forces);
  for (unsigned corner = 0; corner < (beside_ ? 128U : 64U); ++corner) {
    Vector3d g = Vector3d::Zero();
    for (size_t i = 0; i < kParts; ++i) g += (corner >> i) & 1U ? soft[i] : stiff[i];
    found.high = std::max(found.high, cone.Largest(g));
    found.low = std::min(found.low, -cone.Largest(-g));
  }
  return found;
}

}  // namespace millpose
