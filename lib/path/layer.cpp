// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/layer.hpp"

namespace millpose {

int Layer::LaneOf(size_t node) const {
  return static_cast<int>(std::upper_bound(lane_begin.begin() + 1, lane_begin.end(), node) -
                          lane_begin.begin()) -
         1;
}

bool Layer::usable() const {
  return std::any_of(objective.begin(), objective.end(), [](double value) { return std::isfinite(value); });
}

namespace {

void Reserve(size_t count, Layer& layer) {
  for (auto& row : layer.joints.q) row.reserve(count + kBlock);
  layer.objective.reserve(count);
  layer.freedoms.reserve(count);
  layer.first.reserve(count);
  layer.base.reserve(count);
  layer.genetic.reserve(count);
}

}  // namespace

Layer MakeLayer(const PointScorer& scorer, std::vector<NodeSeed> seeds, bool all_revolutions, int courses) {
  std::vector<uint32_t> order;  // of the admissible ones: seeds are too large to be moved about
  order.reserve(seeds.size());
  for (uint32_t i = 0; i < seeds.size(); ++i)
    if (seeds[i].candidate.obstacle == Obstacle::kNone) order.push_back(i);
  std::ranges::stable_sort(order, [&](uint32_t i, uint32_t k) {
    const NodeSeed &a = seeds[i], &b = seeds[k];
    return a.lane() != b.lane() ? a.lane() < b.lane() : a.freedoms < b.freedoms;
  });
  const PoseProblem& problem = scorer.problem();
  Layer layer;
  layer.R_WT = scorer.ToolPose(FreedomValues(problem.freedoms.size(), 0.0)).linear();
  layer.lane_begin.assign(8 * static_cast<size_t>(courses) + 1, 0);
  Reserve(order.size(), layer);
  size_t base = 0, lane = 0;
  const auto add = [&](const NodeSeed& seed, const Joints& q, FreedomValues freedoms) {
    layer.joints.Add(q);
    layer.objective.push_back(seed.candidate.objective);
    layer.first.push_back(freedoms[0]);
    layer.freedoms.push_back(std::move(freedoms));
    layer.base.push_back(base);
    layer.genetic.push_back(seed.genetic);
  };
  for (const uint32_t i : order) {
    NodeSeed& seed = seeds[i];
    ++base;
    while (lane < static_cast<size_t>(seed.lane())) layer.lane_begin[++lane] = layer.size();
    if (all_revolutions) {
      for (const Joints& q : FullRevolutions(seed.candidate.q, problem.bounds.lower, problem.bounds.upper))
        add(seed, q, seed.freedoms);
    } else {
      add(seed, seed.candidate.q, std::move(seed.freedoms));
    }
  }
  while (lane + 1 < layer.lane_begin.size()) layer.lane_begin[++lane] = layer.size();
  layer.joints.Finish();
  return layer;
}

namespace {

NodeSeed SeedOf(const CandidateTable& table, const CandidateTable::Entry& entry, int course) {
  Candidate candidate;
  candidate.obstacle = Obstacle::kNone;
  candidate.objective = entry.objective;
  candidate.q = entry.q;
  return {table.Setting(entry.setting), candidate, entry.branch, false, course};
}

}  // namespace

std::vector<NodeSeed> SeedsOf(const CandidateTable& table) {
  std::vector<NodeSeed> seeds;
  seeds.reserve(table.entries().size() + 1);
  for (const CandidateTable::Entry& entry : table.entries()) seeds.push_back(SeedOf(table, entry, 0));
  return seeds;
}

std::vector<NodeSeed> SeedsOf(const CandidateTable& table, std::span<const size_t> leans) {
  std::vector<NodeSeed> seeds;
  for (const CandidateTable::Entry& entry : table.entries()) {
    const auto lean = std::ranges::find(leans, entry.setting % table.stride());
    if (lean != leans.end()) seeds.push_back(SeedOf(table, entry, static_cast<int>(lean - leans.begin())));
  }
  return seeds;
}

}  // namespace millpose
