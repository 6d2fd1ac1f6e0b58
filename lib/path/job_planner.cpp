// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/job_planner.hpp"

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;

/// `angle` plus full turns, as near to `reference` as they bring it.
double Near(double angle, double reference) {
  return angle + kTurn * std::round((reference - angle) / kTurn);
}

}  // namespace

std::vector<std::pair<GapEnd, GapEnd>> GapEnds(const Joints& home_joints,
                                               const std::vector<PassResult>& passes) {
  const GapEnd home{-1, -1, home_joints};
  std::vector<std::pair<GapEnd, GapEnd>> gaps;
  GapEnd from = home;
  for (const PassResult& pass : passes) {
    for (const Piece& piece : pass.pieces) {
      GapEnd start{pass.pass, piece.piece, pass.points[piece.first].q};
      GapEnd end{pass.pass, piece.piece, pass.points[piece.last].q};
      if (piece.closed) {  // the cut goes on from the last point round to the first
        for (int j = 0; j < 6; ++j) end.q[j] = Near(start.q[j], end.q[j]);
      }
      gaps.emplace_back(from, start);
      from = end;
    }
  }
  if (!gaps.empty()) gaps.emplace_back(from, home);
  return gaps;
}

}  // namespace millpose
