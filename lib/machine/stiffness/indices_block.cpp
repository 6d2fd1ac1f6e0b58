// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/indices_block.hpp"

#include "base/units.hpp"
#include "machine/stiffness/small_vector.hpp"

namespace millpose {
namespace {

using small::Dot;
using small::Symmetric;
using small::Vec;

Vec ToVec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

[[gnu::always_inline]] inline Symmetric LaneOf(const ComplianceBlock& c, int i) {
  return {c.xx.v[i], c.yy.v[i], c.zz.v[i], c.xy.v[i], c.xz.v[i], c.yz.v[i]};
}

}  // namespace

void IndicesInPlane(const ComplianceBlock& c, const Eigen::Vector3d& normal, PlaneIndicesBlock& out,
                    InstructionSet set) {
  const PlaneBasis basis = BasisOfPlane(normal);
  const Vec n = ToVec(normal), first = ToVec(basis.first), second = ToVec(basis.second);
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const Symmetric m = LaneOf(c, i), adjugate = small::Adjugate(m);
        const double det = small::Determinant(m, adjugate);
        const double scale = m.xx + m.yy + m.zz;
        const bool regular = det > kSingularCompliance * scale * scale * scale;
        // As in the scalar IndicesInPlane.
        const Vec a = adjugate * first, b = adjugate * second, along = adjugate * n, cn = m * n;
        const double root = std::sqrt(small::LargerEigenvalue(Dot(a, a), Dot(b, b), Dot(a, b)));
        const double t2 = regular ? det / (regular ? root : 1.0) : kInfinity;
        const double longer = root / (regular ? std::sqrt(Dot(cn, cn)) : 1.0);
        const double t1 = longer > t2 ? longer : t2;
        out.lambda_t1.v[i] = t1;
        out.lambda_t2.v[i] = t2;
        out.lambda_n.v[i] = regular ? det / (regular ? std::sqrt(Dot(along, along)) : 1.0) : kInfinity;
        out.mu.v[i] = regular ? t2 / (regular ? t1 : 1.0) : 0.0;
        out.normal_compliance.v[i] = Dot(n, cn);
      });
}

void DeflectionsInPlane(const ComplianceBlock& c, const Eigen::Vector3d& normal, PlaneDeflectionsBlock& out,
                        InstructionSet set) {
  const PlaneBasis basis = BasisOfPlane(normal);
  const Vec n = ToVec(normal), first = ToVec(basis.first), second = ToVec(basis.second);
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const Symmetric m = LaneOf(c, i);
        const Vec a = m * first, b = m * second;
        const double na = Dot(n, a), nb = Dot(n, b);
        out.normal.v[i] = Dot(n, m * n);
        out.in_plane.v[i] = small::LargerEigenvalue(Dot(first, a), Dot(second, b), Dot(first, b));
        out.largest.v[i] = std::sqrt(small::LargerEigenvalue(Dot(a, a), Dot(b, b), Dot(a, b)));
        out.cross.v[i] = std::sqrt(na * na + nb * nb);
      });
}

}  // namespace millpose
