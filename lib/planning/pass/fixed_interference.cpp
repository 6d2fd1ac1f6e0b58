// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/fixed_interference.hpp"

#include "base/parallel.hpp"
#include "machine/robot/angles.hpp"
#include "planning/pass/pass_checks.hpp"

namespace millpose {
namespace {

constexpr size_t kMostMet = 16;
constexpr size_t kStride = 16;  // what is met at a point is mostly met at those beside it too

}  // namespace

FixedInterference::FixedInterference(const Stations& stations, const PassResult& pass,
                                     const FixedRotationOptions& options)
    : stations_(stations), pass_(pass), options_(options) {
  for (size_t first = 0; first < kStride; ++first)
    for (size_t t = first; t < pass.points.size(); t += kStride)
      if (pass.points[t].skip == Infeasibility::kNone) order_.push_back(t);
}

bool FixedInterference::IsFree(double rotation, int branch) {
  // Made when it is needed: where axes move along passes all points together would be many.
  const PlannedIn in(stations_, pass_);
  const PassChecks checks{.world = in.along.empty() ? in.station.world : stations_.world(),
                          .carrier = in.CarrierAt(0),
                          .swept_resolution = options_.swept_resolution,
                          .rotates_first = true,
                          .threads = 1,
                          .stop = options_.stop,
                          .along = in.along};
  PassCheckers checkers(checks);
  const std::vector<PlannedPoint>& points = pass_.points;
  std::vector<std::optional<Joints>> known(points.size());
  const auto joints = [&](size_t t) -> const Joints& {
    if (!known[t])
      known[t] = PointScorer(in.At(t).problem, points[t].point, pass_.rotation_reference)
                     .ScoreOne({rotation}, branch)
                     .q;
    return *known[t];
  };
  const auto pose_hits = [&](size_t t) {
    return checkers.At(t).Blocked(joints(t), Phase::kCutting).has_value();
  };
  const auto way_hits = [&](size_t t) {  // from the point before
    if (t == 0 || points[t - 1].piece != points[t].piece || points[t - 1].skip != Infeasibility::kNone)
      return false;
    const Joints& from = joints(t - 1);
    return CheckCut(checkers, checks, t - 1, from, NearestEquivalent(from, joints(t))).has_value();
  };
  const auto all_free = [&](const auto& hits) {
    for (const size_t t : order_) {
      CheckStop(options_.stop);
      if (!hits(t)) continue;
      if (met_.size() < kMostMet) met_.push_back(t);
      return false;
    }
    return true;
  };
  for (const size_t t : met_)
    if (pose_hits(t) || way_hits(t)) return false;
  // Motions last: they cost most.
  if (!all_free(pose_hits)) return false;
  for (const Segment& piece : pass_.pieces) {
    const auto first = static_cast<size_t>(piece.first), end = static_cast<size_t>(piece.last);
    if (!Leaves(in.At(first), points[first].q, joints(first))) return false;
    if (!piece.closed && !Leaves(in.At(end), points[end].q, joints(end))) return false;
  }
  return all_free(way_hits);
}

/// Whether the tool can leave `q`, as near to everything as where it stands in the plan.
bool FixedInterference::Leaves(const Station& station, const Joints& planned, const Joints& q) const {
  const Carrier carrier{station.problem.arm, station.problem.X_WB, station.problem.X_FT};
  const double share = ShareToLeave(station.world, carrier, planned, options_.leave);
  if (share == 0) return true;
  Checker checker(station.world, share);
  return CanLeave(checker, carrier, q, options_.leave);
}

}  // namespace millpose
