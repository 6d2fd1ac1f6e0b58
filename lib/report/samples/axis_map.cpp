// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/samples/axis_map.hpp"

#include <map>

#include "base/parallel.hpp"
#include "machine/collision/point_memory.hpp"
#include "planning/result/station.hpp"
#include "planning/result/verdict_map.hpp"
#include "report/samples/sample_curves.hpp"

namespace millpose {
namespace {

constexpr int kMostPairs = 255 - kPairZone;  // a zone is a byte; further pairs share the last number

uint8_t ZoneOfPair(int number) { return static_cast<uint8_t>(kPairZone + std::min(number, kMostPairs)); }

/// Zones of one point, all rotations of branch 0 first, before anything is checked that the plan has not.
std::vector<uint8_t> ZonesOf(const PlannedPoint& point, const PointCurves& curves,
                             const std::vector<int>& pair_numbers) {
  AxisVerdicts verdicts = UnpackVerdicts(point.verdicts);
  if (point.skip == Infeasibility::kNone && !point.freedoms.empty())
    verdicts[static_cast<size_t>(point.branch) * kAxisRotations +
             static_cast<size_t>(AxisCellOf(point.freedoms[0]).index)] = kVerdictFree;
  std::vector<uint8_t> zones(8 * curves.state.size(), kOutOfReach);
  for (size_t i = 0; i < zones.size(); ++i) {
    uint8_t& zone = zones[(i % 8) * kAxisRotations + i / 8];
    const int verdict = verdicts[(i % 8) * kAxisRotations + i / 8];
    switch (curves.state[i / 8][i % 8]) {
      case Infeasibility::kUnreachable:
        zone = kOutOfReach;
        break;
      case Infeasibility::kSingular:
        zone = kSingularZone;
        break;
      case Infeasibility::kLimit:
        zone = static_cast<uint8_t>(kLimitZone + curves.beyond[i / 8][i % 8]);
        break;
      default:  // admissible: the other obstacles are known of points alone
        if (verdict == kVerdictUnknown) {
          zone = kUncheckedZone;
        } else if (verdict == kVerdictFree) {
          zone = kFreeZone;
        } else {
          zone = ZoneOfPair(pair_numbers.at(static_cast<size_t>(verdict - kVerdictPair)));
        }
        break;
    }
  }
  return zones;
}

/// Where what was not checked interferes: the World's pair, −1 for a free pose; by place in the zones.
std::vector<std::pair<size_t, int>> CheckRest(const World& world, const PointScorer& scorer,
                                              const std::vector<FreedomValues>& rotations,
                                              const std::vector<uint8_t>& zones) {
  std::vector<Candidate> candidates(8 * rotations.size());
  scorer.Score(rotations, candidates);
  std::vector<std::pair<size_t, int>> found;
  Checker checker(world);
  PointMemory memory;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const size_t at = (i % 8) * kAxisRotations + i / 8;
    if (zones[at] != kUncheckedZone) continue;
    const auto hit = checker.Blocked(candidates[i].q, Phase::kCutting, rotations[i / 8], memory);
    found.emplace_back(at, hit ? hit->pair : -1);
  }
  return found;
}

/// All pairs by name, and the number of each of a pass's pairs among them.
std::vector<std::vector<int>> NumberPairs(const PlanResult& plan, std::map<std::string, int>& numbers,
                                          std::vector<std::string>& pairs) {
  std::vector<std::vector<int>> of_pass;
  for (const PassResult& pass : plan.passes) {
    std::vector<int>& list = of_pass.emplace_back();
    for (const std::string& name : pass.pairs) {
      const auto [known, added] = numbers.try_emplace(name, static_cast<int>(pairs.size()));
      if (added) pairs.push_back(name);
      list.push_back(known->second);
    }
  }
  return of_pass;
}

}  // namespace

BeyondLimit FarthestBeyond(const AdmissibleBounds& bounds, const Joints& q) {
  BeyondLimit farthest;
  for (int j = 0; j < 6; ++j) {
    // The turn that comes nearest to the middle of what is allowed.
    const double middle = 0.5 * (bounds.lower[j] + bounds.upper[j]),
                 half = 0.5 * (bounds.upper[j] - bounds.lower[j]);
    const double away = q[j] - middle;
    const double by = std::abs(away - 2 * kPi * std::floor(away / (2 * kPi) + 0.5)) - half;
    if (by > farthest.by) farthest = {j, by};
  }
  return farthest;
}

AxisMap MakeAxisMap(const PlanResult& plan, const Stations& stations, const std::vector<PointCurves>& curves,
                    bool full, const Execution& execution) {
  AxisMap map;
  map.full = full;
  std::map<std::string, int> numbers;
  const std::vector<std::vector<int>> of_pass = NumberPairs(plan, numbers, map.pairs);
  const RotationGrid grid = CurveGrid();
  assert(grid.count == kAxisRotations);
  std::vector<FreedomValues> rotations;
  for (int i = 0; i < grid.count; ++i) rotations.push_back({grid.first + i * grid.step});
  map.zones.resize(curves.size());
  std::vector<std::vector<std::pair<size_t, int>>> checked(curves.size());
  ParallelFor(curves.size(), execution.Threads(), execution.stop, [&](size_t k) {
    const PassResult& pass = plan.passes[static_cast<size_t>(curves[k].pass)];
    const PlannedPoint& point = pass.points[static_cast<size_t>(curves[k].point)];
    map.zones[k] = ZonesOf(point, curves[k], of_pass[static_cast<size_t>(curves[k].pass)]);
    if (!full) return;
    const std::shared_ptr<const Station> station = stations.Of(pass, static_cast<size_t>(curves[k].point));
    const PointScorer scorer(station->problem, point.point, pass.rotation_reference);
    checked[k] = CheckRest(station->world, scorer, rotations, map.zones[k]);
  });
  // Pairs get their numbers in the order of the points, whichever thread found them.
  for (size_t k = 0; k < checked.size(); ++k) {
    for (const auto& [at, pair] : checked[k]) {
      if (pair < 0) {
        map.zones[k][at] = kFreeZone;
        continue;
      }
      const auto [known, added] =
          numbers.try_emplace(stations.world().PairName(pair), static_cast<int>(map.pairs.size()));
      if (added) map.pairs.push_back(known->first);
      map.zones[k][at] = ZoneOfPair(known->second);
    }
  }
  return map;
}

}  // namespace millpose
