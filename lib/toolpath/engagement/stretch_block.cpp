// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/stretch_block.hpp"

#include <cmath>

namespace millpose {

void StretchBlock::Set(int lane, const SweptBar& bar, double lowest_height) {
  const Eigen::Vector3d across = bar.way - bar.way.dot(bar.axis) * bar.axis;
  const double square = across.squaredNorm();
  for (int i = 0; i < 3; ++i) {
    from[i].v[lane] = bar.from[i];
    way[i].v[lane] = bar.way[i];
    axis[i].v[lane] = bar.axis[i];
    share_along[i].v[lane] =
        square > 0 ? across[i] / square : 0;  // straight up or down: each share is beside
  }
  // What leans moves a place beside by the lean times how far the tip is from it: at most this much more
  // than the nearest.
  off.v[lane] = bar.off + (bar.way.norm() + bar.off) * bar.lean;
  lean.v[lane] = bar.lean;
  lowest.v[lane] = lowest_height;
}

uint32_t TakersIn(const StretchBlock& block, const Eigen::Vector3d& place, double height, double radius) {
  static const InstructionSet widest = WidestInstructionSet();
  const double x = place.x(), y = place.y(), z = place.z();
  const double *fx = block.from[0].v, *fy = block.from[1].v, *fz = block.from[2].v;
  const double *wx = block.way[0].v, *wy = block.way[1].v, *wz = block.way[2].v;
  const double *ax = block.axis[0].v, *ay = block.axis[1].v, *az = block.axis[2].v;
  const double *sx = block.share_along[0].v, *sy = block.share_along[1].v, *sz = block.share_along[2].v;
  const double *off = block.off.v, *lean = block.lean.v, *lowest = block.lowest.v;
  Lanes takes;
  double* out = takes.v;
  ForEachLane(widest, [&] [[gnu::always_inline]] (int l) {
    double dx = x - fx[l], dy = y - fy[l], dz = z - fz[l];
    double share = dx * sx[l] + dy * sy[l] + dz * sz[l];
    share = share > 0 ? share : 0.0;
    share = share < 1 ? share : 1.0;
    dx -= share * wx[l], dy -= share * wy[l], dz -= share * wz[l];
    const double square = dx * dx + dy * dy + dz * dz, up = dx * ax[l] + dy * ay[l] + dz * az[l];
    const double across = square - up * up, beside = std::sqrt(across > 0 ? across : 0.0);
    const bool near = beside - off[l] - std::sqrt(square) * lean[l] < radius;
    out[l] = (near & (lowest[l] <= height)) ? 1.0 : 0.0;
  });
  uint32_t bits = 0;
  for (int l = 0; l < kLanes; ++l) bits |= static_cast<uint32_t>(takes.v[l] != 0) << l;
  return bits;
}

}  // namespace millpose
