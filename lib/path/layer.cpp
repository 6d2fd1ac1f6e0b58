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

Layer MakeLayer(const PointScorer& scorer, std::vector<NodeSeed> seeds, bool all_revolutions, int courses) {
  std::erase_if(seeds, [](const NodeSeed& s) { return s.candidate.obstacle != Obstacle::kNone; });
  std::stable_sort(seeds.begin(), seeds.end(), [](const NodeSeed& a, const NodeSeed& b) {
    return a.lane() != b.lane() ? a.lane() < b.lane() : a.freedoms < b.freedoms;
  });
  const PoseProblem& problem = scorer.problem();
  Layer layer;
  layer.R_WT = scorer.ToolPose(FreedomValues(problem.freedoms.size(), 0.0)).linear();
  layer.lane_begin.assign(8 * static_cast<size_t>(courses) + 1, 0);
  size_t base = 0;
  for (const NodeSeed& seed : seeds) {
    ++base;
    std::vector<Joints> variants{seed.candidate.q};
    if (all_revolutions)
      variants = FullRevolutions(seed.candidate.q, problem.bounds.lower, problem.bounds.upper);
    for (const Joints& q : variants) {
      layer.joints.Add(q);
      layer.objective.push_back(seed.candidate.objective);
      layer.freedoms.push_back(seed.freedoms);
      layer.first.push_back(seed.freedoms[0]);
      layer.base.push_back(base);
      layer.genetic.push_back(seed.genetic);
    }
    std::fill(layer.lane_begin.begin() + seed.lane() + 1, layer.lane_begin.end(), layer.size());
  }
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
