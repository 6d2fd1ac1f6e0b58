// SPDX-License-Identifier: GPL-3.0-or-later
// A dense reference for passes whose leans are free: every sequence on a grid, without windows and lanes.
#pragma once

#include "base/units.hpp"
#include "planning/pass/lean_courses.hpp"
#include "planning/pose/lean_problem.hpp"

namespace millpose {

/// The least sum of objectives over all sequences of grid nodes that keep the bounds of joint steps and
/// leans; +inf where there is none. Motion costs nothing.
inline double ExhaustiveLeanSum(const PoseProblem& problem, const PathOptions& options, const Pass& pass,
                                double rotation_step, double lean_step) {
  const int rotations = static_cast<int>(std::lround(2 * kPi / rotation_step));
  const int leans = static_cast<int>(std::lround(
                        (problem.freedoms[1]->Upper() - problem.freedoms[1]->Lower()) / lean_step)) +
                    1;
  const std::vector<MillingPoint> contacts = StepPoints(problem, pass.points);
  const std::vector<double> most_lean = LeanBounds(problem, options.max_lean_change, pass.points);
  struct Node {
    double objective = kInfinity, cost = kInfinity;
    Joints q;
  };
  const auto at = [&](int branch, int r, int lead, int tilt) {
    return ((static_cast<size_t>(branch) * static_cast<size_t>(rotations) + static_cast<size_t>(r)) *
                static_cast<size_t>(leans) +
            static_cast<size_t>(lead)) *
               static_cast<size_t>(leans) +
           static_cast<size_t>(tilt);
  };
  std::vector<Node> before, now;
  for (size_t t = 0; t < pass.points.size(); ++t) {
    const PointScorer scorer(problem, pass.points[t], pass.rotation_reference);
    now.assign(at(8, 0, 0, 0), {});
    std::vector<FreedomValues> line(static_cast<size_t>(rotations));
    std::vector<Candidate> candidates(8 * line.size());
    for (int lead = 0; lead < leans; ++lead)
      for (int tilt = 0; tilt < leans; ++tilt) {
        for (int r = 0; r < rotations; ++r)
          line[static_cast<size_t>(r)] = {-kPi + r * rotation_step,
                                          problem.freedoms[1]->Lower() + lead * lean_step,
                                          problem.freedoms[2]->Lower() + tilt * lean_step};
        scorer.Score(line, candidates);
        for (int r = 0; r < rotations; ++r)
          for (int branch = 0; branch < 8; ++branch) {
            const Candidate& candidate = candidates[8 * static_cast<size_t>(r) + static_cast<size_t>(branch)];
            if (candidate.obstacle != Infeasibility::kNone) continue;
            Node& node = now[at(branch, r, lead, tilt)];
            node.objective = candidate.objective;
            node.q = candidate.q;
            if (t == 0) node.cost = node.objective;
          }
      }
    if (t > 0) {
      const Joints most = StepBound(options.steps, problem.arm, contacts[t - 1], contacts[t]);
      const int reach = static_cast<int>(std::floor(most_lean[t - 1] / lean_step + 1e-9));
      const int turn =
          std::min(rotations / 2, static_cast<int>(std::ceil(most.tail<4>().sum() / rotation_step)) + 1);
      for (int branch = 0; branch < 8; ++branch)
        for (int r = 0; r < rotations; ++r)
          for (int lead = 0; lead < leans; ++lead)
            for (int tilt = 0; tilt < leans; ++tilt) {
              Node& node = now[at(branch, r, lead, tilt)];
              if (!std::isfinite(node.objective)) continue;
              for (int dl = std::max(0, lead - reach); dl <= std::min(leans - 1, lead + reach); ++dl)
                for (int dt = std::max(0, tilt - reach); dt <= std::min(leans - 1, tilt + reach); ++dt)
                  for (int dr = r - turn; dr <= r + turn; ++dr) {
                    const Node& from = before[at(branch, (dr + rotations) % rotations, dl, dt)];
                    if (!(from.cost + node.objective < node.cost)) continue;
                    const Joints step = (node.q - from.q).unaryExpr(&WrapToPi).cwiseAbs();
                    if ((step.array() <= most.array()).all()) node.cost = from.cost + node.objective;
                  }
            }
    }
    std::swap(before, now);
  }
  double least = kInfinity;
  for (const Node& node : before) least = std::min(least, node.cost);
  return least;
}

}  // namespace millpose
