// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/path_speed.hpp"

#include <limits>

namespace millpose {
namespace {

constexpr double kSlack = 1e-6;     // relative: no place is slow by less
constexpr double kNoLength = 1e-3;  // mm: a motion that only turns has no speed of the tip

/// From how far before the corner it is rounded, mm.
double ReachAt(const MotionProgram& program, const Motion& motion, const Corner& corner) {
  if (program.blend_is_distance) return motion.blend;
  const double angle = motion.angle_blend > 0 ? motion.angle_blend : std::numeric_limits<double>::infinity();
  return LargestReach(corner, {motion.blend, angle});
}

}  // namespace

SpeedEstimate EstimateSpeed(const MotionProgram& program, const PathDynamics& dynamics, double wanted) {
  SpeedEstimate estimate;
  const std::vector<Motion>& motions = program.motions;
  const auto asked = [&](double feed) { return wanted > 0 ? std::min(feed, wanted) : feed; };
  const auto add = [&](SlowPlace place) {
    if (place.speed >= place.feed * (1 - kSlack)) return;
    estimate.lowest_share = std::min(estimate.lowest_share, place.speed / place.feed);
    estimate.places.push_back(place);
  };
  for (size_t i = 1; i < motions.size(); ++i) {
    const Motion& motion = motions[i];
    if (motion.type != MotionType::kLinear || motion.feed <= 0) continue;
    const double length = (motion.X_PT.translation() - motions[i - 1].X_PT.translation()).norm();
    if (length < kNoLength) continue;
    add({i, asked(motion.feed), BlockSpeed(length, dynamics), true});
    if (motion.exact || i + 1 == motions.size() || motions[i + 1].type != MotionType::kLinear) continue;
    const Corner corner = CornerBetween(motions[i - 1].X_PT, motion.X_PT, motions[i + 1].X_PT);
    if (corner.shorter < kNoLength) continue;
    add({i, asked(std::min(motion.feed, motions[i + 1].feed)),
         CornerSpeed(corner, ReachAt(program, motion, corner), dynamics), false});
  }
  return estimate;
}

}  // namespace millpose
