// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/compliance_block.hpp"

#include "machine/stiffness/small_vector.hpp"

namespace millpose {
namespace {

using small::Cross;
using small::Dot;
using small::Vec;

/// Lengths of the arm, mm, as they stand in registers.
struct Lengths {
  explicit Lengths(const Arm& arm) : d1(arm.d1), a1(arm.a1), a2(arm.a2), d5(arm.d5), d6(arm.d6) {}
  double d1, a1, a2, d5, d6;
};

/// What the Jacobian is made of in one lane, in B.
struct LaneGeometry {
  Vec point;                 // the point p_FT
  Vec arm;                   // from the wrist centre to the point
  Vec fourth_arm;            // from a point of axis 4 to the point
  Vec second;                // axis of joints 2 and 3
  Vec fourth, fifth, sixth;  // axes of the last joints
  double cos1, sin1;         // of q1
  double upper_x, upper_z;   // the elbow seen from the shoulder, in the arm's vertical plane
};

template <ArmFamily kFamily>
[[gnu::always_inline]] inline LaneGeometry GeometryOf(const Lengths& arm, const FlangeBlock& flange,
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
  g.arm = offset + arm.d6 * g.sixth;
  g.second = {-g.sin1, g.cos1, 0};
  if constexpr (kFamily == ArmFamily::kParallelAxes) {
    const double s234 = s23 * cosine(3) + c23 * sine(3), c234 = c23 * cosine(3) - s23 * sine(3);
    g.fourth = g.second;
    g.fifth = {-g.cos1 * c234, -g.sin1 * c234, s234};
    g.fourth_arm = g.arm - arm.d5 * g.fifth;
  } else {
    g.fourth = {g.cos1 * c23, g.sin1 * c23, -s23};
    g.fifth = cosine(3) * g.second + sine(3) * Vec{g.cos1 * s23, g.sin1 * s23, c23};
    g.fourth_arm = g.arm;
  }
  g.upper_x = arm.a2 * cosine(1);
  g.upper_z = -arm.a2 * sine(1);
  return g;
}

/// Velocities of `p` under unit speeds of joints 1, 2, 3.
struct ArmColumns {
  Vec first, second, third;
};
[[gnu::always_inline]] inline ArmColumns ColumnsOf(const Lengths& arm, const LaneGeometry& g, const Vec& p) {
  // In the vertical plane through the arm: joint 2's axis × (x, z) = (z, −x).
  const double x = p.x * g.cos1 + p.y * g.sin1 - arm.a1, z = p.z - arm.d1;
  const double x3 = x - g.upper_x, z3 = z - g.upper_z;
  return {{-p.y, p.x, 0}, {z * g.cos1, z * g.sin1, -x}, {z3 * g.cos1, z3 * g.sin1, -x3}};
}

/// Velocities of the point under unit joint speeds.
struct PointColumns {
  Vec v[6];
};
[[gnu::always_inline]] inline PointColumns PointColumnsOf(const Lengths& arm, const LaneGeometry& g) {
  const ArmColumns columns = ColumnsOf(arm, g, g.point);
  return {{columns.first, columns.second, columns.third, Cross(g.fourth, g.fourth_arm), Cross(g.fifth, g.arm),
           Cross(g.sixth, g.arm)}};
}

/// Sums of squares of the inverse Jacobian's entries, in its left and its right three columns; without
/// meaning where the Jacobian is not regular.
struct InverseSquares {
  double translational, rotational;
  bool regular;

  /// Adds a row.
  [[gnu::always_inline]] void Add(const Vec& linear, const Vec& angular) {
    translational += Dot(linear, linear);
    rotational += Dot(angular, angular);
  }
};

// With A the velocities of the wrist centre under joints 1..3, B their spins, W the wrist's axes and r from
// the wrist centre to the point, J = [A − [r]×B, −[r]×W; B, W] and
//   J⁻¹ = [A⁻¹, A⁻¹[r]×; −W⁻¹BA⁻¹, W⁻¹ − W⁻¹BA⁻¹[r]×],
// whose rows are taken one by one below; only three 3×3 adjugates are needed.
[[gnu::always_inline]] inline InverseSquares SphericalInverse(const Lengths& arm, const LaneGeometry& g) {
  const ArmColumns at_wrist = ColumnsOf(arm, g, g.point - g.arm);
  const Vec spin[3] = {{0, 0, 1}, g.second, g.second};
  const Vec axis[3] = {g.fourth, g.fifth, g.sixth};
  const Vec a_rows[3] = {Cross(at_wrist.second, at_wrist.third), Cross(at_wrist.third, at_wrist.first),
                         Cross(at_wrist.first, at_wrist.second)};
  const Vec w_rows[3] = {Cross(axis[1], axis[2]), Cross(axis[2], axis[0]), Cross(axis[0], axis[1])};
  const double a_det = Dot(at_wrist.first, a_rows[0]), w_det = Dot(axis[0], w_rows[0]);
  const bool regular = a_det != 0 && w_det != 0;
  const double a_scale = 1 / (regular ? a_det : 1.0), w_scale = 1 / (regular ? w_det : 1.0);
  InverseSquares sum{0, 0, regular};
  // A row vector times [r]× is row × r.
  Vec inverse[3];
  for (int k = 0; k < 3; ++k) {
    inverse[k] = a_scale * a_rows[k];
    sum.Add(inverse[k], Cross(inverse[k], g.arm));
  }
  for (int k = 0; k < 3; ++k) {
    const Vec w = w_scale * w_rows[k];
    const Vec wb = Dot(w, spin[0]) * inverse[0] + Dot(w, spin[1]) * inverse[1] + Dot(w, spin[2]) * inverse[2];
    sum.Add(wb, w - Cross(wb, g.arm));
  }
  return sum;
}

// At the wrist centre, v = v1·p1 + v2·p2 + v3·p3 + v4·p4 (p: joint speeds) and spin = z·p1 + y·(p2 + p3 + p4)
// + w5·p5 + w6·p6. Along y only joint 1 moves it, so p1 = v·y/(v1·y); the duals of y, w5, w6 then give the
// sum of p2..p4, p5 and p6; and the duals of v2 − v4 and v3 − v4 in the arm's plane give p2 and p3.
[[gnu::always_inline]] inline InverseSquares ParallelInverse(const Lengths& arm, const LaneGeometry& g) {
  const ArmColumns at_wrist = ColumnsOf(arm, g, g.point - g.arm);
  const Vec& y = g.second;
  const Vec v4 = Cross(g.fourth, g.fourth_arm - g.arm);
  const Vec u2 = at_wrist.second - v4, u3 = at_wrist.third - v4;
  const Vec w_rows[3] = {Cross(g.fifth, g.sixth), Cross(g.sixth, y), Cross(y, g.fifth)};
  const Vec u_rows[2] = {Cross(u3, y), Cross(y, u2)};
  const double side = Dot(at_wrist.first, y), w_det = Dot(y, w_rows[0]), u_det = Dot(u2, u_rows[0]);
  const bool regular = side != 0 && w_det != 0 && u_det != 0;
  const double w_scale = 1 / (regular ? w_det : 1.0), u_scale = 1 / (regular ? u_det : 1.0);
  InverseSquares sum{0, 0, regular};

  // Rows as they take the velocity at the wrist centre and the spin; from the point the spin's part gains
  // linear × r.
  struct Row {
    Vec linear, angular;
  };
  const auto add = [&](const Row& row) __attribute__((always_inline)) {
    sum.Add(row.linear, row.angular + Cross(row.linear, g.arm));
  };
  const Row first{(1 / (regular ? side : 1.0)) * y, {0, 0, 0}};
  add(first);
  Row last[3];  // the sum of joints 2..4, joint 5, joint 6
  for (int k = 0; k < 3; ++k) {
    last[k].angular = w_scale * w_rows[k];
    last[k].linear = -last[k].angular.z * first.linear;
  }
  add(last[1]);
  add(last[2]);
  Row fourth = last[0];
  for (const Vec& u_row : u_rows) {
    const Vec dual = u_scale * u_row;
    const double along = Dot(dual, v4);
    const Row row{dual - Dot(dual, at_wrist.first) * first.linear - along * last[0].linear,
                  -along * last[0].angular};
    add(row);
    fourth.linear = fourth.linear - row.linear;
    fourth.angular = fourth.angular - row.angular;
  }
  add(fourth);
  return sum;
}

template <ArmFamily kFamily>
void LinearComplianceOf(const Arm& arm, const FlangeBlock& flange, const ArmBranchBlock& branch,
                        const Vec& point, ComplianceBlock& out, InstructionSet set) {
  const Lengths lengths(arm);
  double give[6];
  for (int k = 0; k < 6; ++k) give[k] = 1 / arm.stiffness[k];
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const PointColumns columns =
            PointColumnsOf(lengths, GeometryOf<kFamily>(lengths, flange, branch, point, i));
        small::Symmetric c{0, 0, 0, 0, 0, 0};
        for (int k = 0; k < 6; ++k) {
          const Vec& v = columns.v[k];
          const Vec scaled = give[k] * v;
          c.xx += scaled.x * v.x;
          c.yy += scaled.y * v.y;
          c.zz += scaled.z * v.z;
          c.xy += scaled.x * v.y;
          c.xz += scaled.x * v.z;
          c.yz += scaled.y * v.z;
        }
        out.xx.v[i] = c.xx;
        out.yy.v[i] = c.yy;
        out.zz.v[i] = c.zz;
        out.xy.v[i] = c.xy;
        out.xz.v[i] = c.xz;
        out.yz.v[i] = c.yz;
      });
}

template <ArmFamily kFamily>
void DexterityOf(const Arm& arm, const FlangeBlock& flange, const ArmBranchBlock& branch, const Vec& point,
                 double characteristic_length, Lanes& out, InstructionSet set) {
  const Lengths lengths(arm);
  const double square_length = characteristic_length * characteristic_length;
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const LaneGeometry g = GeometryOf<kFamily>(lengths, flange, branch, point, i);
        const PointColumns columns = PointColumnsOf(lengths, g);
        double square = 0;
        for (int k = 0; k < 6; ++k) square += Dot(columns.v[k], columns.v[k]);
        square = square / square_length + 6;
        InverseSquares inverse;
        if constexpr (kFamily == ArmFamily::kParallelAxes) {
          inverse = ParallelInverse(lengths, g);
        } else {
          inverse = SphericalInverse(lengths, g);
        }
        const double product = square * (square_length * inverse.translational + inverse.rotational);
        out.v[i] = inverse.regular && product < 1e300 ? 6 / std::sqrt(product) : 0.0;  // not when NaN
      });
}

}  // namespace

void LinearCompliance(const Arm& arm, const FlangeBlock& flange, const ArmBranchBlock& branch,
                      const Eigen::Vector3d& p_FT, ComplianceBlock& out, InstructionSet set) {
  const Vec point{p_FT.x(), p_FT.y(), p_FT.z()};
  if (arm.family == ArmFamily::kParallelAxes)
    LinearComplianceOf<ArmFamily::kParallelAxes>(arm, flange, branch, point, out, set);
  else
    LinearComplianceOf<ArmFamily::kSphericalWrist>(arm, flange, branch, point, out, set);
}

void DexterityOfBlock(const Arm& arm, const FlangeBlock& flange, const ArmBranchBlock& branch,
                      const Eigen::Vector3d& p_FT, double characteristic_length, Lanes& out,
                      InstructionSet set) {
  const Vec point{p_FT.x(), p_FT.y(), p_FT.z()};
  if (arm.family == ArmFamily::kParallelAxes)
    DexterityOf<ArmFamily::kParallelAxes>(arm, flange, branch, point, characteristic_length, out, set);
  else
    DexterityOf<ArmFamily::kSphericalWrist>(arm, flange, branch, point, characteristic_length, out, set);
}

}  // namespace millpose
