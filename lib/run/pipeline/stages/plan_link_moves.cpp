// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/plan_link_moves.hpp"

#include <map>

#include "planning/links/job_planner.hpp"
#include "planning/links/station_link_move.hpp"
#include "planning/result/skipped.hpp"

namespace millpose {
namespace {

using Ends = std::pair<LinkMoveEnd, LinkMoveEnd>;

class AllLinkMoves {
 public:
  AllLinkMoves(const Stations& stations, std::vector<PassResult>& passes, const LinkMoveOptions& options,
               const CheckpointStore& checkpoints, const Execution& execution)
      : stations_(stations),
        home_{-1, -1, stations.world().cell().home, stations.home()},
        passes_(passes),
        options_(options),
        checkpoints_(checkpoints),
        execution_(execution) {}

  PlannedLinkMoves Plan() {
    std::optional<size_t> resumed;  // in the first round: later ones find what this run has planned
    for (;;) {
      const std::vector<Ends> ends = LinkMoveEnds(home_, passes_);
      PlannedLinkMoves planned = PlanLinkMoves(stations_, ends, options_, checkpoints_, execution_);
      if (!resumed) resumed = planned.resumed;
      planned.resumed = *resumed;
      if (Checker(stations_.At(home_.external).world).At(home_.q, Phase::kFree)) return planned;
      barred_.clear();
      for (size_t i = 0; i < ends.size(); ++i)
        if (!planned.gaps[i].planned) Repair(ends[i], planned.gaps[i]);
      if (barred_.empty()) return planned;
      // From the last to the first: leaving one out renumbers those after it in its pass.
      for (auto at = barred_.rbegin(); at != barred_.rend(); ++at)
        // By its number: a trial has some of the passes only.
        LeaveOut(*std::ranges::find(passes_, at->first.first, &PassResult::pass), at->first.second,
                 Infeasibility::kAccess, at->second);
    }
  }

 private:
  /// Of a gap without a way: the way by home, or which of its pieces is to blame.
  void Repair(const Ends& ends, LinkMove& gap) {
    const auto& [from, to] = ends;
    if (from.pass < 0) return Bar(to, gap);
    if (to.pass < 0) return Bar(from, gap);
    LinkMoveEnd leaving = home_, coming = home_;
    leaving.external = from.external;
    coming.external = to.external;
    const std::vector<LinkMove> ways =
        PlanLinkMoves(stations_, {{from, leaving}, {coming, to}}, options_, checkpoints_, execution_).gaps;
    if (!ways[0].planned) Bar(from, ways[0]);
    if (!ways[1].planned) Bar(to, ways[1]);
    if (!ways[0].planned || !ways[1].planned) return;
    if (from.external == to.external)
      gap = ByWayOfHome(ways[0], ways[1]);
    else  // the external axes cannot move from one station to the other
      Bar(to, gap);
  }

  void Bar(const LinkMoveEnd& piece, const LinkMove& gap) {
    barred_.try_emplace({piece.pass, piece.piece}, gap.detail);
  }

  const Stations& stations_;
  LinkMoveEnd home_;
  std::vector<PassResult>& passes_;
  const LinkMoveOptions& options_;
  const CheckpointStore& checkpoints_;
  const Execution& execution_;
  std::map<std::pair<int, int>, std::string> barred_;  ///< pass and piece: why
};

}  // namespace

PlannedLinkMoves PlanAllLinkMoves(const Stations& stations, std::vector<PassResult>& passes,
                                  const LinkMoveOptions& options, const CheckpointStore& checkpoints,
                                  const Execution& execution) {
  return AllLinkMoves(stations, passes, options, checkpoints, execution).Plan();
}

}  // namespace millpose
