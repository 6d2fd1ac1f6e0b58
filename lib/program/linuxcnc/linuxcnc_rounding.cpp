// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/linuxcnc/linuxcnc_rounding.hpp"

#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "program/overlap.hpp"

namespace millpose {
namespace {

constexpr double kNowhere = 1e-9;  // mm: so little that G64's bound shortens nothing

/// The largest blend (mm) with which the corner behind motion `i` keeps its orientation within the tolerance;
/// the tolerance of the tip where that is less.
double LargestAt(const MotionProgram& program, size_t i, const Arm& arm, const PostSettings& settings,
                 bool cartesian) {
  const PathTolerance& tolerance = settings.tolerance;
  const std::vector<Motion>& motions = program.motions;
  const Joints& q = *motions[i].q;
  const double in = LinearDuration(program, i, arm), out = LinearDuration(program, i + 1, arm);
  const AllAxes rounded =
      OverlapOf(program, i, {*motions[i - 1].q, q, *motions[i + 1].q, in, out}, arm.acceleration);
  // As seen from the base where the external axes stand at the corner.
  const Pose carried = rounded.external.empty() ? Pose::Identity()
                                                : FrameBeside(program, i, {}) *
                                                      FrameBeside(program, i, rounded.external).inverse();
  const Pose at = ForwardFlange(arm, q) * settings.X_FT;
  Pose passed = ForwardFlange(arm, q + rounded.q) * settings.X_FT;
  if (!rounded.external.empty()) passed = carried * passed;
  const double turned = AngleBetween(at.linear(), passed.linear());
  // What the bound counts: the tip, or the joints 1 to 3 at the arm's reach.
  const double reach = kDegPerRad / BlendDegrees(1, arm, settings.X_FT);
  const double off =
      cartesian ? (passed.translation() - at.translation()).norm() : rounded.q.head<3>().norm() * reach;
  if (turned <= tolerance.angle || off < kNowhere) return tolerance.position;
  return std::min(tolerance.position, off * tolerance.angle / turned);
}

}  // namespace

double LinearDuration(const MotionProgram& program, size_t i, const Arm& arm) {
  const Motion &from = program.motions[i - 1], &to = program.motions[i];
  const double length = (to.X_PT.translation() - from.X_PT.translation()).norm();
  double least = ((*to.q - *from.q).cwiseAbs().cwiseQuotient(arm.speed)).maxCoeff() * 2;
  for (size_t k = 0; k < program.external_axes.size(); ++k)
    least = std::max(least, std::abs(to.external[k] - from.external[k]) / program.external_axes[k].speed);
  return std::max(length / to.feed, least);
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
        blend = std::min(blend, LargestAt(program, end, arm, settings, cartesian));
    }
    for (; first < end; ++first) motions[first].blend = blend;
  }
}

}  // namespace millpose
