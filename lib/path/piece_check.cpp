// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/piece_check.hpp"

#include "path/cut_check.hpp"
#include "robot/angles.hpp"

namespace millpose {

bool PieceHits::any() const {
  return std::find(pose.begin(), pose.end(), 1) != pose.end() ||
         std::find(motion.begin(), motion.end(), 1) != motion.end();
}

std::vector<bool> PieceHits::Points() const {
  std::vector<bool> points(pose.begin(), pose.end());
  for (size_t i = 0; i < motion.size(); ++i) {
    if (motion[i]) points[i] = points[(i + 1) % points.size()] = true;
  }
  return points;
}

EndShares PieceChecker::ToLeave(std::span<const PathNode> path, bool closed) {
  if (!leave_) return {};
  const auto share = [&](const PathNode& end) { return ShareToLeave(world_, carrier_, end.q, *leave_); };
  return {share(path.front()), closed ? 0 : share(path.back())};
}

bool PieceChecker::Leaves(const Joints& q, double share) const {
  if (share == 0) return true;
  Checker checker(world_, share);
  return CanLeave(checker, carrier_, q, *leave_);
}

PieceHits PieceChecker::Check(std::span<const PathNode> path, bool closed, const EndShares& ends,
                              const std::vector<bool>& known) {
  PieceHits hits{std::vector<char>(path.size(), 0), std::vector<char>(path.size(), 0)};
  Each(path.size(), [&](Checker& checker, size_t i) {
    if (!known[i]) hits.pose[i] = !PoseFree(checker, path[i].q);
    const size_t next = (i + 1) % path.size();
    if ((next == 0 && !closed) || (known[i] && known[next])) return;
    hits.motion[i] = !MotionFree(checker, path[i].q, path[next].q);
  });
  if (!known.front() && !hits.pose.front()) hits.pose.front() = !Leaves(path.front().q, ends.first);
  if (!known.back() && !hits.pose.back()) hits.pose.back() = !Leaves(path.back().q, ends.last);
  return hits;
}

bool PieceChecker::PoseFree(Checker& checker, const Joints& q) const {
  return !checker.Blocked(q, Phase::kCutting);
}

bool PieceChecker::MotionFree(Checker& checker, const Joints& from, const Joints& to) const {
  return !CheckCut(checker, carrier_, from, NearestEquivalent(from, to), resolution_);
}

void PieceChecker::Each(size_t count, const std::function<void(Checker&, size_t)>& work) {
  poses_checked_ += CheckInParallel(world_, count, threads_, stop_, work).poses;
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
