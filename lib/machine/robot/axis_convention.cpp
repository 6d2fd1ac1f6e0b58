// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/axis_convention.hpp"

#include <cmath>
#include <stdexcept>

namespace millpose {
namespace {

/// By elimination with the larger pivot: no division but by the pivots, which are ±1 for signs and one-way
/// couplings, so that these are undone exactly.
Matrix6 Inverted(Matrix6 m) {
  Matrix6 inverse = Matrix6::Identity();
  for (int column = 0; column < 6; ++column) {
    int pivot = column;
    for (int row = column + 1; row < 6; ++row)
      if (std::abs(m(row, column)) > std::abs(m(pivot, column))) pivot = row;
    // Written so that no number fails as well.
    if (!(std::abs(m(pivot, column)) > 1e-9))
      throw std::invalid_argument("an axis convention that cannot be undone");
    m.row(column).swap(m.row(pivot));
    inverse.row(column).swap(inverse.row(pivot));
    const double scale = m(column, column);
    m.row(column) /= scale;
    inverse.row(column) /= scale;
    for (int row = 0; row < 6; ++row) {
      const double share = m(row, column);
      if (row == column || share == 0) continue;
      m.row(row) -= share * m.row(column);
      inverse.row(row) -= share * inverse.row(column);
    }
  }
  return inverse;
}

}  // namespace

AxisConvention::AxisConvention(const Matrix6& matrix, const Joints& offset)
    : matrix_(matrix), inverse_(Inverted(matrix)), offset_(offset) {}

AxisConvention AxisConvention::OfSigns(const std::array<double, 6>& signs, const Joints& offset) {
  Joints diagonal;
  for (size_t i = 0; i < 6; ++i) diagonal[static_cast<Eigen::Index>(i)] = signs[i];
  return {Matrix6(diagonal.asDiagonal()), offset};
}

Joints AxisConvention::FromArm(const Joints& arm) const { return matrix_ * arm + offset_; }

Joints AxisConvention::ToArm(const Joints& counted) const { return inverse_ * (counted - offset_); }

AxisConvention AxisConvention::After(const AxisConvention& inner) const {
  return {matrix_ * inner.matrix_, matrix_ * inner.offset_ + offset_};
}

AxisConvention AxisConvention::Inverse() const { return {inverse_, -(inverse_ * offset_)}; }

Matrix6 AxisConvention::CountJacobian(const Matrix6& by_arm) const { return by_arm * inverse_; }

Joints AxisConvention::CountTorques(const Joints& about_arm) const {
  return inverse_.transpose() * about_arm;
}

Matrix6 AxisConvention::ArmStiffness(const Matrix6& of_counted) const {
  return matrix_.transpose() * of_counted * matrix_;
}

AxisConvention InnerConvention(const Arm& arm) { return AxisConvention::OfSigns(arm.sign, arm.offset); }

}  // namespace millpose
