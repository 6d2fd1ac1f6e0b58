// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/chen2021.hpp"

#include <limits>

#include "base/error.hpp"
#include "pose/objective_parameters.hpp"

namespace millpose {

Chen2021::Chen2021(const ObjectiveParameters& parameters) {
  const ParameterReader reader("chen2021", parameters, {{"w1", 0.5, 0.0}, {"w2", 0.5, 0.0}});
  w1_ = reader.Value("w1");
  w2_ = reader.Value("w2");
  if (w1_ + w2_ <= 0.0)
    throw InputError(Place{}, "objective chen2021: w1 and w2 are both 0; allowed: one above 0");
}

// With M = (c·cᵀ)⁻¹ and c symmetric, c⁻¹ = A/det with A the adjugate, so uᵀMu = |A·u|²/det². For a basis
// b1, b2 of the plane G = [A·b1, A·b2]ᵀ[A·b1, A·b2] has eigenvalues g1 ≤ g2 and λτ2 = |det|/√g2,
// λn = |det|/|A·n|. No 6×6, no eigensolver, no division before the end.
void Chen2021::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  const Eigen::Vector3d& n = context.normal;
  const Eigen::Vector3d b1 = n.unitOrthogonal(), b2 = n.cross(b1);
  const double w1 = w1_, w2 = w2_;
  for (int l = 0; l < kLanes; ++l) {
    const double xx = c.xx.v[l], yy = c.yy.v[l], zz = c.zz.v[l];
    const double xy = c.xy.v[l], xz = c.xz.v[l], yz = c.yz.v[l];
    const double axx = yy * zz - yz * yz, ayy = xx * zz - xz * xz, azz = xx * yy - xy * xy;
    const double axy = xz * yz - xy * zz, axz = xy * yz - xz * yy, ayz = xy * xz - xx * yz;
    const double det = xx * axx + xy * axy + xz * axz;
    const auto image = [&](const Eigen::Vector3d& u, double& x, double& y, double& z) {
      x = axx * u.x() + axy * u.y() + axz * u.z();
      y = axy * u.x() + ayy * u.y() + ayz * u.z();
      z = axz * u.x() + ayz * u.y() + azz * u.z();
    };
    double px, py, pz, rx, ry, rz, nx, ny, nz;
    image(b1, px, py, pz);
    image(b2, rx, ry, rz);
    image(n, nx, ny, nz);
    const double g11 = px * px + py * py + pz * pz, g22 = rx * rx + ry * ry + rz * rz;
    const double g12 = px * rx + py * ry + pz * rz, gnn = nx * nx + ny * ny + nz * nz;
    const double half = 0.5 * (g11 - g22);
    const double g2 = 0.5 * (g11 + g22) + std::sqrt(half * half + g12 * g12);
    const double value = std::abs(det) * (w1 / std::sqrt(g2) + w2 / std::sqrt(gnn));
    // det of a regular arm is far above the rounding of its terms; at a singular one it vanishes.
    const double scale = (xx + yy + zz) * (xx + yy + zz) * (xx + yy + zz);
    const bool regular = std::abs(det) > 1e-14 * scale && g2 > 0.0 && gnn > 0.0;
    out.v[l] = regular ? value : std::numeric_limits<double>::infinity();
  }
}

}  // namespace millpose
