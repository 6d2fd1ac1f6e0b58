// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/compliance_block.hpp"

#include "stiffness/small_vector.hpp"

namespace millpose {
namespace {

using small::Cross;
using small::Dot;
using small::Vec;

/// What the Jacobian is made of in one lane, in B.
struct LaneGeometry {
  Vec point;                 // the point p_FT
  Vec arm;                   // from the wrist centre to the point
  Vec second;                // axis of joints 2 and 3
  Vec fourth, fifth, sixth;  // axes of the wrist
  double cos1, sin1;         // of q1
  double upper_x, upper_z;   // the elbow seen from the shoulder, in the arm's vertical plane
};

[[gnu::always_inline]] inline LaneGeometry GeometryOf(double a2, double d6, const FlangeBlock& flange,
                                                      const ArmBranchBlock& branch, const Vec& p_FT, int i) {
  const auto sine = [&](int k) __attribute__((always_inline)) { return branch.q[k].sin.v[i]; };
  const auto cosine = [&](int k) __attribute__((always_inline)) { return branch.q[k].cos.v[i]; };
  const auto column = [&](const std::array<Lanes, 3>& from) __attribute__((always_inline)) {
    return Vec{from[0].v[i], from[1].v[i], from[2].v[i]};
  };
  const double s23 = sine(1) * cosine(2) + cosine(1) * sine(2);
  const double c23 = cosine(1) * cosine(2) - sine(1) * sine(2);
  LaneGeometry g;
  g.cos1 = cosine(0);
  g.sin1 = sine(0);
  g.sixth = column(flange.z);
  const Vec offset = p_FT.x * column(flange.x) + p_FT.y * column(flange.y) + p_FT.z * g.sixth;
  g.point = column(flange.p) + offset;
  g.arm = offset + d6 * g.sixth;
  g.second = {-g.sin1, g.cos1, 0};
  g.fourth = {g.cos1 * c23, g.sin1 * c23, -s23};
  g.fifth = cosine(3) * g.second + sine(3) * Vec{g.cos1 * s23, g.sin1 * s23, c23};
  g.upper_x = a2 * cosine(1);
  g.upper_z = -a2 * sine(1);
  return g;
}

/// Velocities of `p` under unit speeds of joints 1, 2, 3.
struct ArmColumns {
  Vec first, second, third;
};
[[gnu::always_inline]] inline ArmColumns ColumnsOf(double d1, double a1, const LaneGeometry& g,
                                                   const Vec& p) {
  // In the vertical plane through the arm: joint 2's axis × (x, z) = (z, −x).
  const double x = p.x * g.cos1 + p.y * g.sin1 - a1, z = p.z - d1;
  const double x3 = x - g.upper_x, z3 = z - g.upper_z;
  return {{-p.y, p.x, 0}, {z * g.cos1, z * g.sin1, -x}, {z3 * g.cos1, z3 * g.sin1, -x3}};
}

}  // namespace

void LinearCompliance(const Arm& arm, const FlangeBlock& flange, const ArmBranchBlock& branch,
                      const Eigen::Vector3d& p_FT, ComplianceBlock& out, InstructionSet set) {
  const Vec point{p_FT.x(), p_FT.y(), p_FT.z()};
  const double d1 = arm.d1, a1 = arm.a1, a2 = arm.a2, d6 = arm.d6;
  double give[6];
  for (int k = 0; k < 6; ++k) give[k] = 1 / arm.stiffness[k];
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const LaneGeometry g = GeometryOf(a2, d6, flange, branch, point, i);
        const ArmColumns columns = ColumnsOf(d1, a1, g, g.point);
        const Vec v[6] = {columns.first,          columns.second,        columns.third,
                          Cross(g.fourth, g.arm), Cross(g.fifth, g.arm), Cross(g.sixth, g.arm)};
        small::Symmetric c{0, 0, 0, 0, 0, 0};
        for (int k = 0; k < 6; ++k) {
          const Vec scaled = give[k] * v[k];
          c.xx += scaled.x * v[k].x;
          c.yy += scaled.y * v[k].y;
          c.zz += scaled.z * v[k].z;
          c.xy += scaled.x * v[k].y;
          c.xz += scaled.x * v[k].z;
          c.yz += scaled.y * v[k].z;
        }
        out.xx.v[i] = c.xx;
        out.yy.v[i] = c.yy;
        out.zz.v[i] = c.zz;
        out.xy.v[i] = c.xy;
        out.xz.v[i] = c.xz;
        out.yz.v[i] = c.yz;
      });
}

// With A the velocities of the wrist centre under joints 1..3, B their spins, W the wrist's axes and r from
// the wrist centre to the point, J = [A − [r]×B, −[r]×W; B, W] and
//   J⁻¹ = [A⁻¹, A⁻¹[r]×; −W⁻¹BA⁻¹, W⁻¹ − W⁻¹BA⁻¹[r]×],
// whose rows are taken one by one below; only three 3×3 adjugates are needed.
void DexterityOfBlock(const Arm& arm, const FlangeBlock& flange, const ArmBranchBlock& branch,
                      const Eigen::Vector3d& p_FT, double characteristic_length, Lanes& out,
                      InstructionSet set) {
  const Vec point{p_FT.x(), p_FT.y(), p_FT.z()};
  const double d1 = arm.d1, a1 = arm.a1, a2 = arm.a2, d6 = arm.d6;
  const double square_length = characteristic_length * characteristic_length;
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const LaneGeometry g = GeometryOf(a2, d6, flange, branch, point, i);
        const ArmColumns at_point = ColumnsOf(d1, a1, g, g.point);
        const ArmColumns at_wrist = ColumnsOf(d1, a1, g, g.point - g.arm);
        const Vec spin[3] = {{0, 0, 1}, g.second, g.second};
        const Vec axis[3] = {g.fourth, g.fifth, g.sixth};

        const Vec linear[6] = {at_point.first,        at_point.second,       at_point.third,
                               Cross(axis[0], g.arm), Cross(axis[1], g.arm), Cross(axis[2], g.arm)};
        double square = 0;
        for (int k = 0; k < 6; ++k) square += Dot(linear[k], linear[k]);
        square = square / square_length + 6;

        const Vec a_rows[3] = {Cross(at_wrist.second, at_wrist.third), Cross(at_wrist.third, at_wrist.first),
                               Cross(at_wrist.first, at_wrist.second)};
        const Vec w_rows[3] = {Cross(axis[1], axis[2]), Cross(axis[2], axis[0]), Cross(axis[0], axis[1])};
        const double a_det = Dot(at_wrist.first, a_rows[0]), w_det = Dot(axis[0], w_rows[0]);
        const bool regular = a_det != 0 && w_det != 0;
        const double a_scale = 1 / (regular ? a_det : 1.0), w_scale = 1 / (regular ? w_det : 1.0);
        // A row vector times [r]× is row × r.
        double translational = 0, rotational = 0;
        Vec inverse[3];
        for (int k = 0; k < 3; ++k) {
          inverse[k] = a_scale * a_rows[k];
          const Vec turned = Cross(inverse[k], g.arm);
          translational += Dot(inverse[k], inverse[k]);
          rotational += Dot(turned, turned);
        }
        for (int k = 0; k < 3; ++k) {
          const Vec w = w_scale * w_rows[k];
          const Vec wb =
              Dot(w, spin[0]) * inverse[0] + Dot(w, spin[1]) * inverse[1] + Dot(w, spin[2]) * inverse[2];
          const Vec rest = w - Cross(wb, g.arm);
          translational += Dot(wb, wb);
          rotational += Dot(rest, rest);
        }
        const double product = square * (square_length * translational + rotational);
        out.v[i] = regular && product < 1e300 ? 6 / std::sqrt(product) : 0.0;  // not when NaN
      });
}

}  // namespace millpose
