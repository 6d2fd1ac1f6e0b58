// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/rotated_flange.hpp"

#include "base/trig.hpp"

namespace millpose {

RotatedFlange::RotatedFlange(const Pose& X_BT, const Pose& X_TF) {
  // Columns x and y of R_BT·Rz(θ) are x·cos θ + y·sin θ and y·cos θ − x·sin θ.
  const Matrix34 tool = X_TF.matrix().topRows<3>();
  const Eigen::Vector3d x = X_BT.linear().col(0), y = X_BT.linear().col(1), z = X_BT.linear().col(2);
  constant_ = z * tool.row(2);
  constant_.col(3) += X_BT.translation();
  cosine_ = x * tool.row(0) + y * tool.row(1);
  sine_ = y * tool.row(0) - x * tool.row(1);
}

SineCosineLanes SinCosOf(const Lanes& angle, InstructionSet set) {
  SineCosineLanes out;
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const SineCosine of = SinCos(angle.v[i]);
        out.sin.v[i] = of.sin;
        out.cos.v[i] = of.cos;
      });
  return out;
}

void RotatedFlange::Set(const SineCosineLanes& angle, FlangeBlock& out, InstructionSet set) const {
  const Lanes &sine = angle.sin, &cosine = angle.cos;
  const std::array<std::array<Lanes, 3>*, 4> columns{&out.x, &out.y, &out.z, &out.p};
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double a = constant_(row, column), b = cosine_(row, column), c = sine_(row, column);
      Lanes& to = (*columns[column])[row];
      ForEachLane(
          set, [&](int i)
                   __attribute__((always_inline)) { to.v[i] = a + (b * cosine.v[i] + c * sine.v[i]); });
    }
  }
}

void RotatedFlange::SetLane(size_t lane, const SineCosineLanes& angle, FlangeBlock& out) const {
  const double sine = angle.sin.v[lane], cosine = angle.cos.v[lane];
  const Matrix34 at = constant_ + (cosine_ * cosine + sine_ * sine);
  for (int row = 0; row < 3; ++row) {
    out.x[row].v[lane] = at(row, 0);
    out.y[row].v[lane] = at(row, 1);
    out.z[row].v[lane] = at(row, 2);
    out.p[row].v[lane] = at(row, 3);
  }
}

}  // namespace millpose
