// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/find_reach.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

/// The axis that is nearest to its limit, or farthest beyond it, and how far from it (rad); full revolutions
/// are taken off.
std::pair<int, double> LeastReserve(const AdmissibleBounds& bounds, const Joints& q) {
  std::pair<int, double> least{0, std::numeric_limits<double>::infinity()};
  for (int j = 0; j < 6; ++j) {
    const double middle = 0.5 * (bounds.lower[j] + bounds.upper[j]),
                 half = 0.5 * (bounds.upper[j] - bounds.lower[j]), away = q[j] - middle;
    const double reserve = half - std::abs(away - 2 * kPi * std::floor(away / (2 * kPi) + 0.5));
    if (reserve < least.second) least = {j, reserve};
  }
  return least;
}

PointReach ReachOf(const PoseProblem& problem, const MillingPoint& point, const Eigen::Vector3d& reference,
                   double step) {
  const int count = std::max(1, static_cast<int>(std::ceil(2 * kPi / step)));
  std::vector<FreedomValues> rotations;
  for (int i = 0; i < count; ++i) rotations.push_back({2 * kPi * i / count});
  std::vector<Candidate> candidates(8 * rotations.size());
  PointScorer(problem, point, reference).Score(rotations, candidates);
  PointReach reach;
  for (const Candidate& candidate : candidates) {
    const int passed = TestsPassed(candidate.obstacle), best = TestsPassed(reach.best);
    if (candidate.obstacle == Infeasibility::kUnreachable || passed < best) continue;
    const auto [axis, reserve] = LeastReserve(problem.bounds, candidate.q);
    if (passed > best || reserve > reach.reserve) reach = {candidate.obstacle, axis, reserve, candidate.q};
  }
  return reach;
}

}  // namespace

std::vector<PointReach> FindReach(const PreparedJob& prepared, double step, const Execution& execution) {
  struct Asked {
    size_t pass;
    const MillingPoint* point;
    ExternalPosition external;
  };
  std::vector<Asked> points;
  const std::vector<Pass>& passes = prepared.toolpath.passes;
  for (size_t p = 0; p < passes.size(); ++p) {
    std::vector<ExternalPosition> positions = PositionsAlong(prepared.external[p], passes[p]);
    for (size_t t = 0; t < positions.size(); ++t)
      points.push_back({p, &passes[p].points[t], std::move(positions[t])});
  }
  std::vector<PointReach> reach(points.size());
  const Stations stations = prepared.stations.AtOwnAxis();
  execution.progress.Begin("reach", points.size());
  ParallelFor(points.size(), execution.Threads(), execution.stop, [&](size_t i) {
    const auto& [pass, point, external] = points[i];
    const Eigen::Vector3d& reference = passes[pass].rotation_reference;
    if (prepared.external[pass].Moves())
      reach[i] = ReachOf(stations.Own(external)->problem, *point, reference, step);
    else
      reach[i] = ReachOf(stations.At(external).problem, *point, reference, step);
    execution.progress.Advance(1);
  });
  const auto within = std::ranges::count(reach, Infeasibility::kNone, &PointReach::best);
  execution.progress.End(fmt::format("{} of {} points within reach", within, points.size()));
  return reach;
}

}  // namespace millpose
