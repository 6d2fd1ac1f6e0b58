// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/series_block.hpp"

#include <cassert>

#include "machine/stiffness/small_vector.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;
using small::Cross;
using small::Dot;
using small::Symmetric;
using small::Vec;

/// A 6×6 compliance by its blocks: displacement by force, rotation by force (columns), rotation by torque.
struct LinkGive {
  explicit LinkGive(const Matrix6& C)
      : tt{C(0, 0), C(1, 1), C(2, 2), C(0, 1), C(0, 2), C(1, 2)},
        rt{Column(C, 0), Column(C, 1), Column(C, 2)},
        rr{Column(C, 3), Column(C, 4), Column(C, 5)} {}
  static Vec Column(const Matrix6& C, Eigen::Index j) { return {C(3, j), C(4, j), C(5, j)}; }

  Symmetric tt;
  Vec rt[3], rr[3];
};

/// Displacement by force at `r` from the origin of the element: [I, −[r]×]·C·[I, −[r]×]ᵀ.
[[gnu::always_inline]] inline Symmetric At(const LinkGive& C, const Vec& r) {
  const Vec a0 = Cross(C.rt[0], r), a1 = Cross(C.rt[1], r), a2 = Cross(C.rt[2], r);
  const Vec d0 = Cross(C.rr[0], r), d1 = Cross(C.rr[1], r), d2 = Cross(C.rr[2], r);
  const Vec b0 = Cross({d0.x, d1.x, d2.x}, r), b1 = Cross({d0.y, d1.y, d2.y}, r),
            b2 = Cross({d0.z, d1.z, d2.z}, r);
  return {C.tt.xx + (a0.x + a0.x) + b0.x, C.tt.yy + (a1.y + a1.y) + b1.y, C.tt.zz + (a2.z + a2.z) + b2.z,
          C.tt.xy + (a1.x + a0.y) + b0.y, C.tt.xz + (a2.x + a0.z) + b0.z, C.tt.yz + (a2.y + a1.z) + b1.z};
}

/// A frame in B: its axes and its origin.
struct Frame {
  Vec x, y, z, p;
};

/// Adds R·m·Rᵀ with R the axes of `frame`.
[[gnu::always_inline]] inline void AddTurned(const Frame& frame, const Symmetric& m, ComplianceBlock& c,
                                             int i) {
  const Vec row_x{frame.x.x, frame.y.x, frame.z.x}, row_y{frame.x.y, frame.y.y, frame.z.y},
      row_z{frame.x.z, frame.y.z, frame.z.z};
  const Vec by_x = m * row_x, by_y = m * row_y, by_z = m * row_z;
  c.xx.v[i] += Dot(row_x, by_x);
  c.yy.v[i] += Dot(row_y, by_y);
  c.zz.v[i] += Dot(row_z, by_z);
  c.xy.v[i] += Dot(row_x, by_y);
  c.xz.v[i] += Dot(row_x, by_z);
  c.yz.v[i] += Dot(row_y, by_z);
}

[[gnu::always_inline]] inline Frame FlangeOf(const FlangeBlock& flange, int i) {
  const auto column = [&](const std::array<Lanes, 3>& from) __attribute__((always_inline)) {
    return Vec{from[0].v[i], from[1].v[i], from[2].v[i]};
  };
  return {column(flange.x), column(flange.y), column(flange.z), column(flange.p)};
}

/// The lengths that frames of links 1 to 5 need, mm.
struct Lengths {
  explicit Lengths(const Arm& arm)
      : d1(arm.d1), a1(arm.a1), dy(arm.dy), a2(arm.a2), d4(arm.d4), dz(arm.dz), d5(arm.d5) {}
  double d1, a1, dy, a2, d4, dz, d5;
};

[[gnu::always_inline]] inline void TurnX(Frame& frame, double sine, double cosine) {
  const Vec y = cosine * frame.y + sine * frame.z;
  frame.z = cosine * frame.z - sine * frame.y;
  frame.y = y;
}

[[gnu::always_inline]] inline void TurnY(Frame& frame, double sine, double cosine) {
  const Vec x = cosine * frame.x - sine * frame.z;
  frame.z = cosine * frame.z + sine * frame.x;
  frame.x = x;
}

/// LinkFrames()[kLink] from the sines and cosines of a branch. `wrist` is −1 for the flipped wrist: axis 4
/// half a turn on and axis 5 reversed.
template <ArmFamily kFamily, int kLink>
[[gnu::always_inline]] inline Frame LinkFrame(const Lengths& arm, const ArmBranchBlock& branch, double wrist,
                                              int i) {
  const auto sine = [&](int k) __attribute__((always_inline)) { return branch.q[k].sin.v[i]; };
  const auto cosine = [&](int k) __attribute__((always_inline)) { return branch.q[k].cos.v[i]; };
  Frame frame{{cosine(0), sine(0), 0}, {-sine(0), cosine(0), 0}, {0, 0, 1}, {0, 0, arm.d1}};
  if constexpr (kLink == 1) return frame;
  frame.p = frame.p + arm.a1 * frame.x + arm.dy * frame.y;
  TurnY(frame, sine(1), cosine(1));
  if constexpr (kLink == 2) return frame;
  frame.p = frame.p + arm.a2 * frame.x;
  TurnY(frame, sine(2), cosine(2));
  if constexpr (kLink == 3) return frame;
  frame.p = frame.p + arm.d4 * frame.x + arm.dz * frame.z;
  if constexpr (kFamily == ArmFamily::kParallelAxes) {
    const Vec x = frame.x;
    frame.x = frame.y;
    frame.y = -1.0 * x;
  }
  TurnX(frame, wrist * sine(3), wrist * cosine(3));
  if constexpr (kLink == 4) return frame;
  frame.p = frame.p - arm.d5 * frame.y;
  TurnY(frame, wrist * sine(4), cosine(4));
  return frame;
}

template <ArmFamily kFamily, int kLink>
void AddLink(const Arm& arm, const Matrix6& C, const Vector3d& p_FT, const FlangeBlock& flange,
             const ArmBranchBlock& branch, double wrist, ComplianceBlock& out, InstructionSet set) {
  const Lengths lengths(arm);
  const LinkGive give(C);
  const Vec point_F{p_FT.x(), p_FT.y(), p_FT.z()};
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const Frame f = FlangeOf(flange, i);
        const Vec point = f.p + point_F.x * f.x + point_F.y * f.y + point_F.z * f.z;
        Frame link{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
        if constexpr (kLink > 0) link = LinkFrame<kFamily, kLink>(lengths, branch, wrist, i);
        const Vec r = point - link.p;
        AddTurned(link, At(give, {Dot(link.x, r), Dot(link.y, r), Dot(link.z, r)}), out, i);
      });
}

template <ArmFamily kFamily>
void AddLinkOf(int link, const Arm& arm, const Matrix6& C, const Vector3d& p_FT, const FlangeBlock& flange,
               const ArmBranchBlock& branch, double wrist, ComplianceBlock& out, InstructionSet set) {
  constexpr decltype(&AddLink<kFamily, 0>) kAdd[] = {AddLink<kFamily, 0>, AddLink<kFamily, 1>,
                                                     AddLink<kFamily, 2>, AddLink<kFamily, 3>,
                                                     AddLink<kFamily, 4>, AddLink<kFamily, 5>};
  kAdd[link](arm, C, p_FT, flange, branch, wrist, out, set);
}

}  // namespace

SeriesBlock::SeriesBlock(const Arm& arm, const std::vector<SeriesCompliance>& elements, const Vector3d& p_FT)
    : arm_(arm), p_FT_(p_FT) {
  on_.fill(Matrix6::Zero());
  for (const SeriesCompliance& element : elements) {
    assert(element.link >= 0 && element.link <= 6);
    links_ |= 1u << element.link;
    if (element.link < 6)
      on_[static_cast<size_t>(element.link)] += ComplianceAt(element, Vector3d::Zero());
    else
      on_flange_ += ComplianceAt(element, p_FT).topLeftCorner<3, 3>();
  }
}

void SeriesBlock::AddTo(const FlangeBlock& flange, const ArmBranchBlock& branch, bool flipped,
                        ComplianceBlock& c, InstructionSet set) const {
  const double wrist = flipped ? -1 : 1;
  for (int link = 0; link < 6; ++link) {
    if ((links_ >> link & 1u) == 0) continue;
    const auto add = arm_.family == ArmFamily::kParallelAxes ? AddLinkOf<ArmFamily::kParallelAxes>
                                                             : AddLinkOf<ArmFamily::kSphericalWrist>;
    add(link, arm_, on_[static_cast<size_t>(link)], p_FT_, flange, branch, wrist, c, set);
  }
  if ((links_ >> 6 & 1u) == 0) return;
  const Symmetric give{on_flange_(0, 0), on_flange_(1, 1), on_flange_(2, 2),
                       on_flange_(0, 1), on_flange_(0, 2), on_flange_(1, 2)};
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) { AddTurned(FlangeOf(flange, i), give, c, i); });
}

}  // namespace millpose
