// SPDX-License-Identifier: GPL-3.0-or-later
// Paths to be smoothed.
#pragma once

#include "machine/motion/cut_feed.hpp"
#include "planning/smoothing/smoothing.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {

/// A row of points with a path along it that turns about the tool axis as `rotation` says.
struct RoughRow {
  PoseProblem problem = MakeProblem(Kr500R2830());
  std::vector<MillingPoint> points;
  std::vector<PointScorer> scorers;
  std::vector<PathNode> path;
  std::vector<FreedomRange> ranges;

  /// `turned` is added to the rotation and branch of least objective at which all points are admissible.
  template <typename Rotation>
  RoughRow(int count, double spacing, const Rotation& turned) {
    for (int t = 0; t < count; ++t) {
      points.push_back(PanelPoint(spacing * (t - 0.5 * count), 100));
      points.back().arc_length = spacing * t;
      scorers.emplace_back(problem, points.back(), Eigen::Vector3d::UnitZ());
      ranges.push_back({-10, 10});
    }
    for (int place = 0; place < 72 * 8; ++place) {
      std::vector<PathNode> tried;
      double objective = 0;
      for (int t = 0; t < count; ++t) {
        PathNode node;
        node.branch = place % 8;
        node.freedoms = {DegToRad(5.0 * (place / 8)) - kPi + turned(t)};
        const Candidate candidate = scorers[t].ScoreOne(node.freedoms, node.branch);
        if (candidate.obstacle != Infeasibility::kNone) break;
        node.q = candidate.q;
        objective += node.objective = candidate.objective;
        tried.push_back(node);
      }
      if (std::ssize(tried) == count && (path.empty() || objective < Objective())) path = std::move(tried);
    }
    EXPECT_FALSE(path.empty());
  }

  SmoothOptions Options() const {
    SmoothOptions options;
    options.loss = 0.01;
    options.max_step.assign(points.size(), Joints::Constant(DegToRad(5)));
    options.max_deviation = 0.5;
    options.before = MeasurePath(scorers, points, options, path);
    return options;
  }
  double Objective() const {
    double sum = 0;
    for (const PathNode& node : path) sum += node.objective;
    return sum;
  }
  /// Root mean square of the joint accelerations, rad/s².
  double Rms() const {
    std::vector<CutSample> cut;
    for (size_t t = 0; t < path.size(); ++t) {
      cut.push_back({path[t].q, points[t].arc_length, points[t].feed_rate});
    }
    return TimeRms(cut, RatesAlong(cut).acceleration).norm();
  }
};

/// Steps of a grid, as the search leaves them along an obstacle.
inline double Stairs(int t) { return DegToRad(std::round(0.23 * t)); }

}  // namespace millpose
