// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/arm.hpp"

namespace millpose {

/// How somebody else counts an arm's six axes: a controller, the inner formula at Arm, the gears. Their
/// angles are
///   A' = matrix · A + offset
/// with the signs on the matrix's diagonal and couplings beside it: FANUC's J3 is the geometric J3 less J2, a
/// parallelogram's spring acts on A2 + A3. There is no other place for signs, offsets and couplings.
class AxisConvention {
 public:
  /// As the arm counts itself.
  AxisConvention() : AxisConvention(Matrix6::Identity(), Joints::Zero()) {}
  /// `matrix`: without units, invertible (else std::invalid_argument); `offset`: rad. Exact where the entries
  /// are 0, 1 and −1 and no coupling leads back to its own axis.
  AxisConvention(const Matrix6& matrix, const Joints& offset);
  /// Signs (+1 or −1) and offsets (rad) alone.
  static AxisConvention OfSigns(const std::array<double, 6>& signs, const Joints& offset);

  const Matrix6& matrix() const { return matrix_; }
  const Joints& offset() const { return offset_; }

  /// The arm's angles as they are counted here, and back; rad.
  Joints FromArm(const Joints& arm) const;
  Joints ToArm(const Joints& counted) const;

  /// First `inner`, then this: Count(q) = this->Count(inner.FromArm(q)).
  AxisConvention After(const AxisConvention& inner) const;
  /// Counts back.
  AxisConvention Inverse() const;

  /// The same Jacobian by the angles counted here: J' dA' = J dA.
  Matrix6 CountJacobian(const Matrix6& by_arm) const;
  /// The same torques (N·mm) about the axes as they are counted here, by the transpose: τ'·dA' = τ·dA.
  Joints CountTorques(const Joints& about_arm) const;
  /// Stiffness (N·mm/rad) about the arm's axes of springs that act on the angles counted here: Mᵀ·K·M, since
  /// τ = Mᵀ·τ'.
  Matrix6 ArmStiffness(const Matrix6& of_counted) const;

 private:
  Matrix6 matrix_, inverse_;
  Joints offset_;  ///< rad
};

/// From the arm's own angles to the inner angles q of the formula at Arm.
AxisConvention InnerConvention(const Arm& arm);

}  // namespace millpose
