// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/links/job_planner.hpp"

#include "machine/robot/angles.hpp"
#include "planning/result/station.hpp"

namespace millpose {

LinkMoveEnd HomeOf(const PlanResult& plan) {
  return {-1, -1, plan.home, Mechanism(plan.external_axes).Home()};
}

std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>> LinkMoveEnds(const LinkMoveEnd& home,
                                                              const std::vector<PassResult>& passes) {
  std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>> gaps;
  LinkMoveEnd from = home;
  for (const PassResult& pass : passes) {
    for (const Segment& piece : pass.pieces) {
      const auto at = [&](int point) {
        const auto t = static_cast<size_t>(point);
        return LinkMoveEnd{pass.pass, piece.piece, pass.points[t].q, ExternalAt(pass, t)};
      };
      LinkMoveEnd start = at(piece.first), end = at(piece.last);
      if (piece.closed)
        end.q = NearestEquivalent(end.q, start.q);  // the cut goes on round to the first point
      gaps.emplace_back(from, start);
      from = end;
    }
  }
  if (!gaps.empty()) gaps.emplace_back(from, home);
  return gaps;
}

}  // namespace millpose
