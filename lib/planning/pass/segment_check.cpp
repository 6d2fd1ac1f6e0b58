// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/segment_check.hpp"

#include "machine/robot/angles.hpp"

namespace millpose {

bool SegmentHits::any() const {
  return std::find(pose.begin(), pose.end(), 1) != pose.end() ||
         std::find(motion.begin(), motion.end(), 1) != motion.end();
}

std::vector<bool> SegmentHits::Points() const {
  std::vector<bool> points(pose.begin(), pose.end());
  for (size_t i = 0; i < motion.size(); ++i) {
    if (motion[i]) points[i] = points[(i + 1) % points.size()] = true;
  }
  return points;
}

EndShares SegmentChecker::ToLeave(std::span<const PathNode> path, bool closed) {
  if (!leave_) return {};
  const auto share = [&](size_t i) {
    return ShareToLeave(checks_.WorldAt(i), checks_.CarrierAt(i), path[i].q, *leave_);
  };
  return {share(0), closed ? 0 : share(path.size() - 1)};
}

bool SegmentChecker::Leaves(size_t i, const Joints& q, double share) const {
  if (share == 0) return true;
  Checker checker(checks_.WorldAt(i), share);
  return CanLeave(checker, checks_.CarrierAt(i), q, *leave_);
}

SegmentHits SegmentChecker::Check(std::span<const PathNode> path, bool closed, const EndShares& ends,
                                  const std::vector<bool>& known) {
  SegmentHits hits{std::vector<char>(path.size(), 0), std::vector<char>(path.size(), 0)};
  Each(path.size(), [&](PassCheckers& checkers, size_t i) {
    if (!known[i]) hits.pose[i] = !PoseFree(checkers, i, path[i].q);
    const size_t next = (i + 1) % path.size();
    if ((next == 0 && !closed) || (known[i] && known[next])) return;
    hits.motion[i] = !MotionFree(checkers, i, path[i].q, path[next].q);
  });
  if (!known.front() && !hits.pose.front()) hits.pose.front() = !Leaves(0, path.front().q, ends.first);
  if (!known.back() && !hits.pose.back())
    hits.pose.back() = !Leaves(path.size() - 1, path.back().q, ends.last);
  return hits;
}

bool SegmentChecker::PoseFree(PassCheckers& checkers, size_t i, const Joints& q) const {
  return checks_.gouges.At(q) == 0 && !known_[i]->OfPose(checkers.At(i), q);
}

bool SegmentChecker::MotionFree(PassCheckers& checkers, size_t i, const Joints& from,
                                const Joints& to) const {
  return checks_.gouges.Between(from, to) == 0 &&
         !known_[i]->OfMotion(checkers, i, from, NearestEquivalent(from, to), checks_);
}

void SegmentChecker::Each(size_t count, const std::function<void(PassCheckers&, size_t)>& work) {
  poses_checked_ += CheckInParallel(checks_, count, work).poses;
}

std::vector<bool> Widened(const std::vector<bool>& marked, size_t reach, bool closed) {
  const size_t count = marked.size();
  reach = std::min(reach, count - 1);
  std::vector<bool> wide(count, false);
  for (size_t i = 0; i < count; ++i) {
    for (size_t k = 0; marked[i] && k <= 2 * reach; ++k) {
      const size_t at = i + k;  // reach too far
      if (closed || (at >= reach && at - reach < count)) wide[(at + count - reach) % count] = true;
    }
  }
  return wide;
}

}  // namespace millpose
