// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/links/link_move_planner.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "machine/motion/time_law.hpp"
#include "planning/links/joint_route.hpp"
#include "planning/links/retract.hpp"

namespace millpose {
namespace {

constexpr double kClearanceBound = 100;  // mm; clearances along a gap are reported up to this
const double kClearanceStep = DegToRad(1);

std::string Name(const LinkMoveEnd& end) {
  return end.pass < 0 ? "home" : fmt::format("pass {}, piece {}", end.pass, end.piece);
}

class LinkMovePlanner {
 public:
  LinkMovePlanner(const World& world, const std::pair<LinkMoveEnd, LinkMoveEnd>& ends,
                  const LinkMoveOptions& options, double clearance_share, const std::stop_token& stop)
      : world_(world),
        options_(options),
        stop_(stop),
        from_(ends.first),
        to_(ends.second),
        carrier_{world.cell().arm, world.cell().X_WB, world.cell().X_FT},
        clearance_share_(clearance_share),
        checker_(world, clearance_share),
        limits_(LimitsAround(carrier_.arm, options.leave.limit_margin, from_.q)) {
    limits_.Include(to_.q);
  }

  LinkMove Plan() {
    LinkMove gap = PlanWay();
    gap.poses_checked = checker_.poses_checked() + route_poses_;
    return gap;
  }

 private:
  LinkMove PlanWay() {
    LinkMove gap;
    gap.from_pass = from_.pass, gap.from_piece = from_.piece;
    gap.to_pass = to_.pass, gap.to_piece = to_.piece;
    const Retract leave = Leave(from_), enter = Leave(to_);
    gap.X_WT_retracted = leave.X_WT_end;
    gap.X_WT_approach = enter.X_WT_end;
    if (!leave.problem.empty() || !enter.problem.empty()) {
      gap.detail = leave.problem.empty() ? fmt::format("approach to {}: {}", Name(to_), enter.problem)
                                         : fmt::format("retract from {}: {}", Name(from_), leave.problem);
      return gap;
    }
    const JointRoute route = Route(leave.joints.back(), enter.joints.back());
    if (route.corners.empty()) {
      gap.detail = fmt::format("{} to {}: {}", Name(from_), Name(to_), route.problem);
      return gap;
    }
    gap.planned = true;
    gap.joints = route.corners;
    gap.clearance = ClearanceAlong(route.corners);
    gap.duration = Duration(leave.joints) + Duration(route.corners) + Duration(enter.joints);
    return gap;
  }

  /// The retract from one end; at home there is none.
  Retract Leave(const LinkMoveEnd& end) {
    CheckStop(stop_);
    if (end.pass < 0) {
      Retract stay{{end.q}, carrier_.ToolPose(end.q), {}};
      if (const auto found = checker_.At(end.q, Phase::kFree)) stay.problem = NearText(*found);
      return stay;
    }
    return FindRetract(checker_, carrier_, end.q, limits_, options_.leave);
  }

  JointRoute Route(const Joints& from, const Joints& to) {
    RouteOptions route;
    route.limits = limits_;
    route.max_iterations = options_.max_iterations;
    route.resolution = options_.leave.swept_resolution;
    route.clearance_share = clearance_share_;
    route.speed_share = options_.speed_share;
    route.stop = stop_;
    const auto end = [](const LinkMoveEnd& e) {
      return static_cast<uint64_t>(e.pass + 1) * 4096 + static_cast<uint64_t>(e.piece + 1);
    };
    const RandomStream random(options_.seed, (end(from_) << 32) + end(to_));
    JointRoute found = FindRoute(world_, from, to, route, random);
    route_poses_ += found.poses_checked;
    return found;
  }

  double ClearanceAlong(const std::vector<Joints>& corners) {
    double smallest = checker_.Clearance(corners.front(), Phase::kFree, kClearanceBound);
    for (size_t i = 1; i < corners.size(); ++i) {
      const Joints step = corners[i] - corners[i - 1];
      const int count = std::max(1, static_cast<int>(std::ceil(step.cwiseAbs().maxCoeff() / kClearanceStep)));
      for (int k = 1; k <= count; ++k) {
        const Joints q = corners[i - 1] + static_cast<double>(k) / count * step;
        smallest = std::min(smallest, checker_.Clearance(q, Phase::kFree, smallest));
      }
    }
    return smallest;
  }

  double Duration(const std::vector<Joints>& joints) const {
    const Arm& arm = carrier_.arm;
    return PathDuration(joints, options_.speed_share * arm.speed, options_.speed_share * arm.acceleration);
  }

  const World& world_;
  const LinkMoveOptions& options_;
  const std::stop_token& stop_;
  LinkMoveEnd from_, to_;
  Carrier carrier_;
  double clearance_share_;
  Checker checker_;
  JointLimits limits_;
  long long route_poses_ = 0;
};

}  // namespace

LinkMove PlanLinkMove(const World& world, const LinkMoveEnd& from, const LinkMoveEnd& to,
                      const LinkMoveOptions& options, std::stop_token stop) {
  LinkMove first;
  long long poses = 0;
  LinkMoveOptions fewer = options;  // all retries together have no more iterations than the first try
  fewer.max_iterations = std::max(1, options.max_iterations / static_cast<int>(kClearanceShares.size() - 1));
  for (const double share : kClearanceShares) {
    LinkMove gap = LinkMovePlanner(world, {from, to}, share == 1 ? options : fewer, share, stop).Plan();
    poses += gap.poses_checked;
    gap.poses_checked = poses;
    if (gap.planned) {
      gap.clearance_share = share;
      if (share < 1)
        gap.detail = fmt::format("{} to {}: clearances reduced to {:.0f} % ({})", Name(from), Name(to),
                                 100 * share, first.detail);
      return gap;
    }
    if (share == 1) first = std::move(gap);
  }
  first.poses_checked = poses;
  return first;
}

}  // namespace millpose
