// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/corner_bound.hpp"

#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/verify/stations.hpp"

namespace millpose {
namespace {

double DistanceFromLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& p) {
  const Eigen::Vector3d way = to - from;
  const double squared = way.squaredNorm();
  const double share = squared > 0 ? std::clamp((p - from).dot(way) / squared, 0.0, 1.0) : 0;
  return (p - from - share * way).norm();
}

/// Where a path from `from` to `to` is after `length` mm; `to` where it is shorter.
Pose AfterLength(const Pose& from, const Pose& to, double length) {
  const PoseLine line(from, to);
  return length < line.length() ? line.At(length / line.length()) : to;
}

/// A place of the programmed path near a corner.
struct NearCorner {
  Eigen::Vector3d tip, turn;  ///< mm; rotation vector from the corner's orientation
  double along;               ///< mm from the corner, negative before it
};

/// The places on one side of the corner within reach, from it outwards: `step` −1 or 1.
std::vector<NearCorner> WithinSide(const std::vector<Pose>& tools, size_t corner, int step, double reach) {
  std::vector<NearCorner> within;
  const Eigen::Matrix3d back = tools[corner].linear().transpose();
  double done = 0;
  for (size_t k = corner; done < reach; k += static_cast<size_t>(step)) {
    if (step < 0 ? k == 0 : k + 1 == tools.size()) break;
    const Pose &from = tools[k], &to = tools[k + static_cast<size_t>(step)];
    const Pose place = AfterLength(from, to, reach - done);
    done += (place.translation() - from.translation()).norm();
    within.push_back({place.translation(), RotationVector(place.linear() * back), step * done});
    if ((to.translation() - place.translation()).norm() > 0) break;
  }
  return within;
}

}  // namespace

CornerRounding WithinReach(const std::vector<Pose>& tools, size_t corner, double reach) {
  const std::vector<NearCorner> before = WithinSide(tools, corner, -1, reach),
                                behind = WithinSide(tools, corner, 1, reach);
  if (before.empty() || behind.empty()) return {};
  const NearCorner &begin = before.back(), &end = behind.back();
  const double length = end.along - begin.along;
  if (length <= 0) return {};
  CornerRounding most;
  const auto look = [&](const NearCorner& place) {
    const double share = (place.along - begin.along) / length;
    most.position = std::max(most.position, DistanceFromLine(begin.tip, end.tip, place.tip));
    most.angle = std::max(most.angle, (place.turn - begin.turn - share * (end.turn - begin.turn)).norm());
  };
  look({tools[corner].translation(), Eigen::Vector3d::Zero(), 0});
  for (const auto* side : {&before, &behind})
    for (size_t k = 0; k + 1 < side->size(); ++k) look((*side)[k]);
  const double times = before.size() + behind.size() > 2 ? 2 : 1;
  return {times * most.position, times * most.angle};
}

CornerRounding CornerBoundAt(const Replayed& replayed, const Cell& cell, size_t i) {
  const std::vector<Motion>& motions = replayed.program.motions;
  const auto is_corner = [&](size_t k) {
    return k > 0 && k + 1 < motions.size() && HasFeed(motions[k]) && HasFeed(motions[k + 1]) &&
           !motions[k].exact;
  };
  const double reach = motions[i].blend;
  if (!is_corner(i) || reach <= 0) return {};
  const auto tool = [&](size_t k) {
    return Pose(BaseInPart(cell, motions[k].external) * ForwardFlange(cell.arm, replayed.replay.targets[k]) *
                cell.X_FT);
  };
  std::vector<Pose> tools = {tool(i)};
  size_t corner = 0;
  double length = 0;
  for (size_t k = i; length < reach && k > 0 && (k == i || is_corner(k)); --k, ++corner) {
    tools.insert(tools.begin(), tool(k - 1));
    length += (tools[1].translation() - tools[0].translation()).norm();
  }
  length = 0;
  for (size_t k = i; length < reach && is_corner(k); ++k) {
    tools.push_back(tool(k + 1));
    length += (tools.back().translation() - tools[tools.size() - 2].translation()).norm();
  }
  return WithinReach(tools, corner, reach);
}

std::optional<CornerBound> FindCornerBound(const MotionProgram& program, const Cell& cell) {
  if (program.corner_assumption.empty()) return std::nullopt;
  std::vector<Finding> said;  // by Verify()
  const Replayed replayed{program, ReplayTargets(program, cell, said), {}};
  CornerBound widest{0, 0, program.corner_assumption};
  bool rounded = false;
  for (size_t i = 0; i < program.motions.size(); ++i) {
    const CornerRounding here = CornerBoundAt(replayed, cell, i);
    rounded |= !program.motions[i].exact && program.motions[i].blend > 0;
    widest.position = std::max(widest.position, here.position);
    widest.angle = std::max(widest.angle, here.angle);
  }
  return rounded ? std::optional(widest) : std::nullopt;
}

double CheckCornerBounds(const Replayed& replayed, const Cell& cell, const VerifyOptions& options,
                         std::vector<Finding>& findings) {
  double most = 0;
  if (replayed.program.corner_assumption.empty()) return most;
  for (size_t i = 0; i < replayed.program.motions.size(); ++i) {
    const CornerRounding bound = CornerBoundAt(replayed, cell, i);
    most = std::max(most, bound.position);
    // A cell that says nothing allows no such corner, be it one of a straight path.
    const Motion& motion = replayed.program.motions[i];
    const bool allowed = options.max_corner > 0 || motion.exact || motion.blend <= 0 || !HasFeed(motion);
    if (allowed && bound.position <= options.max_corner && bound.angle <= options.angle_tolerance) continue;
    findings.push_back(
        At(replayed.program, i, Cause::kCorner,
           fmt::format("the corner's path is not documented by the maker and bounded by {:.4f} mm and {:.4f} "
                       "deg; allowed: {:.4f} mm (max_corner_mm) and {:.4f} deg (path_tolerance_deg)",
                       bound.position, bound.angle * kDegPerRad, options.max_corner,
                       options.angle_tolerance * kDegPerRad)));
  }
  return most;
}

std::string Describe(const CornerBound& bound) {
  return fmt::format("the corner's path, bounded by {:.4f} mm and {:.4f} deg, provided that {}",
                     bound.position, bound.angle * kDegPerRad, bound.assumption);
}

}  // namespace millpose
