// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/linuxcnc/linuxcnc_rounding.hpp"

#include "base/units.hpp"
#include "motion/line.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "robot/kinematics.hpp"

namespace millpose {
namespace {

constexpr double kNowhere = 1e-9;  // mm: so little that G64's bound shortens nothing

/// The largest blend (mm) with which the corner behind motion `i` keeps its orientation within the tolerance;
/// the tolerance of the tip where that is less.
double LargestAt(const std::vector<Motion>& motions, size_t i, const Arm& arm, const PostSettings& settings,
                 bool cartesian) {
  const PathTolerance& tolerance = settings.tolerance;
  const Motion &before = motions[i - 1], &corner = motions[i], &after = motions[i + 1];
  const double in = LinearDuration(before, corner, arm), out = LinearDuration(corner, after, arm);
  const Joints rounded = OverlapRounding((*corner.q - *before.q) / in, (*after.q - *corner.q) / out,
                                         arm.acceleration, std::min(in, out));
  const Pose at = ForwardFlange(arm, *corner.q) * settings.X_FT;
  const Pose passed = ForwardFlange(arm, *corner.q + rounded) * settings.X_FT;
  const double turned = AngleBetween(at.linear(), passed.linear());
  // What the bound counts: the tip, or the joints 1 to 3 at the arm's reach.
  const double reach = kDegPerRad / BlendDegrees(1, arm, settings.X_FT);
  const double off =
      cartesian ? (passed.translation() - at.translation()).norm() : rounded.head<3>().norm() * reach;
  if (turned <= tolerance.angle || off < kNowhere) return tolerance.position;
  return std::min(tolerance.position, off * tolerance.angle / turned);
}

}  // namespace

double LinearDuration(const Motion& from, const Motion& to, const Arm& arm) {
  const double length = (to.X_PT.translation() - from.X_PT.translation()).norm();
  const double turning = ((*to.q - *from.q).cwiseAbs().cwiseQuotient(arm.speed)).maxCoeff() * 2;
  return std::max(length / to.feed, turning);
}

void ChooseOverlap(MotionProgram& program, const Arm& arm, const PostSettings& settings, bool cartesian) {
  std::vector<Motion>& motions = program.motions;
  const auto straight = [&](size_t i) { return motions[i].type == MotionType::kLinear; };
  for (size_t first = 1; first < motions.size(); ++first) {
    if (!straight(first)) continue;
    size_t end = first;
    double blend = settings.tolerance.position;
    for (; end < motions.size() && straight(end); ++end) {
      if (!motions[end].exact && end + 1 < motions.size() && straight(end + 1))
        blend = std::min(blend, LargestAt(motions, end, arm, settings, cartesian));
    }
    for (; first < end; ++first) motions[first].blend = blend;
  }
}

}  // namespace millpose
