// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/corner.hpp"

namespace millpose {

CornerRounding RoundingOf(const Pose& before, const Pose& corner, const Pose& after, const Motion& motion,
                          bool by_distance) {
  const Corner shape = CornerBetween(before, corner, after);
  if (by_distance) return RoundedBy(shape, motion.blend);
  const CornerRounding farthest = RoundedBy(shape, shape.shorter / 2);
  return {std::min(farthest.position, motion.blend), std::min(farthest.angle, motion.angle_blend)};
}

std::vector<Joints> LargestRounding(const Joints& before, const Joints& q, const Joints& after, int count) {
  const Joints first = (before + q) / 2, last = (q + after) / 2;
  std::vector<Joints> places;
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / (count - 1);
    places.emplace_back((1 - t) * (1 - t) * first + 2 * t * (1 - t) * q + t * t * last);
  }
  return places;
}

Joints RoundingOfWay(const Joints& before, const Joints& q, const Joints& after) {
  return ((after - q) / 2 - (q - before) / 2) / 4;
}

}  // namespace millpose
