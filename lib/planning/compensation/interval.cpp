// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/interval.hpp"

#include "base/trig.hpp"
#include "machine/stiffness/compliance.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// The forces within bounds of a stated one, as far as their product with a vector goes.
class ForceCone {
 public:
  ForceCone(const Vector3d& force, const ForceBounds& bounds)
      : force_(force),
        length_(force.norm()),
        least_(std::max(0.0, 1 - bounds.length)),
        most_(1 + bounds.length),
        angle_(bounds.angle) {}

  /// The largest g·F over them. The least is −Largest(−g).
  double Largest(const Vector3d& g) const {
    const double along = g.dot(force_), across = g.cross(force_).norm();
    const double off = std::max(0.0, Atan2(across, along) - angle_);
    const double product = g.norm() * length_ * SinCos(off).cos;
    return product * (product > 0 ? most_ : least_);
  }

 private:
  Vector3d force_;
  double length_, least_, most_, angle_;
};

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
