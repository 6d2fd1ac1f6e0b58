// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/commanded_free.hpp"

#include <map>
#include <set>

#include "base/parallel.hpp"
#include "machine/robot/angles.hpp"
#include "planning/compensation/compensate.hpp"
#include "planning/links/job_planner.hpp"
#include "planning/links/retract.hpp"
#include "planning/pass/cut_check.hpp"
#include "planning/result/skipped.hpp"
#include "planning/result/station.hpp"
#include "program/verify/coordinated_path.hpp"

namespace millpose {
namespace {

constexpr double kAnyTurn = 1e9;  // rad

/// A straight motion of the tool between commanded poses, or to or from one.
struct Line {
  size_t pass, piece;
  Joints from, to;
  ExternalPosition external, external_to;
  double share = 1;  ///< of the cell's clearances
};

std::vector<Line> LinesOf(const PlanResult& plan) {
  std::vector<Line> lines;
  const auto commanded = [](const PlannedPoint& point) {
    return point.compensation ? point.compensation->q : point.q;
  };
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t k = 0; k < plan.passes[p].pieces.size(); ++k) {
      const Segment& piece = plan.passes[p].pieces[k];
      const auto& points = plan.passes[p].points;
      const auto add = [&](size_t from, size_t to) {
        if (points[from].compensation && points[to].compensation)
          lines.push_back({p, k, commanded(points[from]), commanded(points[to]),
                           ExternalAt(plan.passes[p], from), ExternalAt(plan.passes[p], to)});
      };
      for (auto i = static_cast<size_t>(piece.first); i < static_cast<size_t>(piece.last); ++i) add(i, i + 1);
      if (piece.closed) add(static_cast<size_t>(piece.last), static_cast<size_t>(piece.first));
    }
  const auto ends = LinkMoveEnds(HomeOf(plan), plan.passes);
  for (size_t g = 0; g < std::min(plan.gaps.size(), ends.size()); ++g) {
    const LinkMove& gap = plan.gaps[g];
    if (!gap.planned || gap.joints.empty()) continue;
    const auto add = [&](int pass, int number, bool entry) {
      if (pass < 0) return;
      const auto p = static_cast<size_t>(pass);
      const PassResult& own = plan.passes[p];
      const auto piece = std::ranges::find(own.pieces, number, &Segment::piece);
      const auto k = static_cast<size_t>(piece - own.pieces.begin());
      const int at = entry || piece->closed ? piece->first : piece->last;
      const Joints q = commanded(own.points[static_cast<size_t>(at)]);
      const ExternalPosition& external = ExternalAt(own, static_cast<size_t>(at));
      if (entry)
        lines.push_back({p, k, gap.joints.back(), q, external, external, gap.clearance_share});
      else
        lines.push_back({p, k, q, gap.joints.front(), external, external, gap.clearance_share});
    };
    add(gap.from_pass, gap.from_piece, false);
    add(gap.to_pass, gap.to_piece, true);
  }
  return lines;
}

/// What is in the way of a line along which the external axes move; empty when nothing.
std::string WhyNotAlong(const Stations& stations, const PlanResult& plan, const Line& line, double resolution,
                        double reserve) {
  const auto ride = std::make_shared<const CoordinatedMotion>(CoordinatedMotion{
      Mechanism(plan.external_axes), plan.X_WB, plan.X_WP, line.external, line.external_to});
  const Carrier carrier{plan.arm, plan.X_WB, plan.X_FT, ride};
  const Joints to = NearestEquivalent(line.from, line.to), free = Joints::Constant(kAnyTurn);
  const LineMotion motion = FollowLine(carrier, line.from, carrier.ToolPose(to, 1), -free, free);
  if (!motion.problem.empty()) return motion.problem;
  CoordinatedPath way{ride->from, ride->to, {}};
  for (size_t i = 0; i < motion.joints.size(); ++i)
    way.joints.emplace_back(static_cast<double>(i) / static_cast<double>(motion.joints.size() - 1),
                            motion.joints[i]);
  const std::optional<Interference> found =
      FindOnCoordinatedMotion(stations.world(), way, {line.share, reserve, resolution});
  return found ? NearText(*found) : std::string();
}

}  // namespace

std::vector<BlockedPiece> BlockedWhereCommanded(const Stations& stations, double resolution, double reserve,
                                                const Execution& execution, const PlanResult& plan) {
  const std::vector<Line> lines = LinesOf(plan);
  std::vector<std::string> found(lines.size());
  ParallelFor(lines.size(), execution.Threads(), execution.stop, [&](size_t i) {
    if (lines[i].external != lines[i].external_to) {
      found[i] = WhyNotAlong(stations, plan, lines[i], resolution, reserve);
      return;
    }
    const Station& station = stations.At(lines[i].external);
    const Carrier carrier{plan.arm, station.problem.X_WB, plan.X_FT};
    Checker checker(station.world, lines[i].share, reserve);
    if (const auto problem = CheckCut(checker, carrier, lines[i].from,
                                      NearestEquivalent(lines[i].from, lines[i].to), resolution))
      found[i] = Describe(checker, *problem);
  });
  std::vector<BlockedPiece> blocked;
  std::set<std::pair<size_t, size_t>> told;
  for (size_t i = 0; i < lines.size(); ++i)
    if (!found[i].empty() && told.emplace(lines[i].pass, lines[i].piece).second)
      blocked.push_back({lines[i].pass, lines[i].piece, found[i]});
  return blocked;
}

std::vector<std::string> KeepCommandedFree(const Stations& stations, const CompensationOptions& options,
                                           double resolution, const Execution& execution, PlanResult& plan) {
  const double reserve = options.deviations ? resolution : 0;
  std::vector<std::string> findings;
  for (const BlockedPiece& blocked : BlockedWhereCommanded(stations, resolution, reserve, execution, plan)) {
    const PassResult& pass = plan.passes[blocked.pass];
    const Segment& piece = pass.pieces[blocked.piece];
    LeaveNominal(options, blocked.pass, piece, plan);
    findings.push_back(fmt::format("pass {} piece {} is not compensated: where it is commanded, {}",
                                   pass.pass, piece.piece, blocked.why));
  }
  return findings;
}

size_t LeaveOutPieces(const std::vector<BlockedPiece>& pieces, Infeasibility reason, PlanResult& plan) {
  std::map<std::pair<size_t, size_t>, std::string> each;
  for (const BlockedPiece& piece : pieces) each.try_emplace({piece.pass, piece.piece}, piece.why);
  // From the last to the first: leaving one out renumbers those after it in its pass.
  for (auto at = each.rbegin(); at != each.rend(); ++at)
    LeaveOut(plan.passes[at->first.first], static_cast<int>(at->first.second), reason, at->second);
  return each.size();
}

}  // namespace millpose
