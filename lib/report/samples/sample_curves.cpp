// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/samples/sample_curves.hpp"

#include <limits>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "planning/pose/generations.hpp"
#include "planning/result/station.hpp"
#include "report/samples/axis_map.hpp"

namespace millpose {
namespace {

constexpr size_t kWorstSampled = 200;  // when not all points are sampled

struct PlanPlace {
  int pass, point;
  size_t number;  ///< of the job's points, from 0
  double objective;
};

std::vector<PlanPlace> ChosenPlaces(const PlanResult& plan, size_t most) {
  std::vector<PlanPlace> places;
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    const std::vector<PlannedPoint>& points = plan.passes[p].points;
    for (size_t i = 0; i < points.size(); ++i)
      places.push_back({static_cast<int>(p), static_cast<int>(i), places.size(), points[i].objective});
  }
  if (places.size() <= most) return places;
  std::vector<PlanPlace> worst = places;
  const size_t kept = std::min(kWorstSampled, most / 2);
  const auto worse = [](const PlanPlace& a, const PlanPlace& b) {
    return a.objective != b.objective ? a.objective > b.objective : a.number < b.number;
  };
  std::partial_sort(worst.begin(), worst.begin() + static_cast<std::ptrdiff_t>(kept), worst.end(), worse);
  worst.resize(kept);
  const size_t stride = (places.size() + most - kept - 1) / (most - kept);
  std::vector<char> keep(places.size(), 0);
  for (size_t i = 0; i < places.size(); i += stride) keep[i] = 1;
  for (const PlanPlace& place : worst) keep[place.number] = 1;
  std::erase_if(places, [&](const PlanPlace& place) { return !keep[place.number]; });
  return places;
}

/// The arm branches, as ScoreBlock takes them, on which bounds bar some pose of a block.
unsigned Barred(const ScoredBlock& block) {
  unsigned barred = 0;
  for (unsigned branch = 0; branch < 8; ++branch)
    for (const Infeasibility obstacle : block.obstacle[branch])
      if (obstacle != Infeasibility::kNone && obstacle != Infeasibility::kUnreachable)
        barred |= 1u << (branch & 3);
  return barred;
}

/// The bounds bar few poses of most points: only where they do, the problem without them is asked as well.
void SampleRotations(const PointScorer& scorer, const PointScorer& unbounded, const RotationGrid& grid,
                     PointCurves& curves) {
  const auto count = static_cast<size_t>(grid.count);
  curves.objective.resize(count);
  curves.state.resize(count);
  curves.beyond.resize(count);
  ScoredBlock block, free;
  for (size_t first = 0; first < count; first += kLanes) {
    std::array<double, kLanes> rotations{};
    for (size_t l = 0; l < kLanes; ++l)  // the last fills up
      rotations[l] = grid.first + static_cast<double>(std::min(first + l, count - 1)) * grid.step;
    scorer.ScoreBlock(rotations, kAllArmBranches, block);
    if (const unsigned barred = Barred(block); barred != 0) unbounded.ScoreBlock(rotations, barred, free);
    for (size_t l = 0; l < kLanes && first + l < count; ++l) {
      for (size_t branch = 0; branch < 8; ++branch) {
        const Infeasibility state = block.obstacle[branch][l];
        double& objective = curves.objective[first + l][branch];
        curves.state[first + l][branch] = state;
        objective = std::numeric_limits<double>::infinity();
        if (state == Infeasibility::kNone)
          objective = block.objective[branch].v[l];
        else if (state != Infeasibility::kUnreachable && free.obstacle[branch][l] == Infeasibility::kNone)
          objective = free.objective[branch].v[l];
        if (state != Infeasibility::kLimit) continue;
        const Joints q = CandidateOf(block, static_cast<int>(branch), static_cast<int>(l)).q;
        curves.beyond[first + l][branch] =
            static_cast<uint8_t>(FarthestBeyond(scorer.problem().bounds, q).joint);
      }
    }
  }
}

}  // namespace

PoseProblem WithoutBounds(PoseProblem problem) {
  problem.bounds = {.lower = Joints::Constant(-2 * kPi), .upper = Joints::Constant(2 * kPi)};
  return problem;
}

RotationGrid CurveGrid() { return {-kPi, DegToRad(3), 120}; }

std::vector<PointCurves> SampleCurves(const PlanResult& plan, const Stations& stations,
                                      const GeneticOptions& options, size_t most,
                                      const Execution& execution) {
  assert(stations.problem().freedoms.size() == 1 && "the page shows the rotation about the tool axis alone");
  const RotationGrid grid = CurveGrid();
  const std::vector<PlanPlace> places = ChosenPlaces(plan, most);
  std::vector<PointCurves> all(places.size());
  ParallelFor(places.size(), execution.Threads(), execution.stop, [&](size_t i) {
    const PlanPlace& place = places[i];
    const PassResult& pass = plan.passes[place.pass];
    const std::shared_ptr<const Station> station = stations.Of(pass, static_cast<size_t>(place.point));
    const PoseProblem& problem = station->problem;
    const PoseProblem free = WithoutBounds(problem);
    PointCurves& curves = all[i];
    curves.pass = place.pass;
    curves.point = place.point;
    const PointScorer scorer(problem, pass.points[place.point].point, pass.rotation_reference);
    SampleRotations(scorer, PointScorer(free, pass.points[place.point].point, pass.rotation_reference), grid,
                    curves);
    // The paper's formulation has no generations over the rotation.
    if (!pass.points[place.point].paper.empty()) return;
    const RandomStream stream(plan.seed, place.number);
    for (const GenerationRecord& record : Generations(scorer, problem, options, stream)) {
      const bool none = record.admissible == 0;
      curves.best.push_back(none ? std::numeric_limits<double>::quiet_NaN() : record.best);
      curves.mean.push_back(none ? std::numeric_limits<double>::quiet_NaN() : record.mean);
    }
  });
  return all;
}

}  // namespace millpose
