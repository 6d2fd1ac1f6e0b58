// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/layer.hpp"

namespace millpose {

int Layer::BranchOf(size_t node) const {
  int branch = 0;
  while (node >= branch_begin[branch + 1]) ++branch;
  return branch;
}

bool Layer::usable() const {
  return std::any_of(objective.begin(), objective.end(), [](double value) { return std::isfinite(value); });
}

Layer MakeLayer(const PointScorer& scorer, std::vector<NodeSeed> seeds, bool all_revolutions) {
  std::erase_if(seeds, [](const NodeSeed& s) { return s.candidate.obstacle != Obstacle::kNone; });
  std::stable_sort(seeds.begin(), seeds.end(), [](const NodeSeed& a, const NodeSeed& b) {
    return a.branch != b.branch ? a.branch < b.branch : a.freedoms < b.freedoms;
  });
  const PoseProblem& problem = scorer.problem();
  Layer layer;
  layer.R_WT = scorer.ToolPose(FreedomValues(problem.freedoms.size(), 0.0)).linear();
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
    for (int later = seed.branch + 1; later <= 8; ++later) layer.branch_begin[later] = layer.size();
  }
  layer.joints.Finish();
  return layer;
}

std::vector<NodeSeed> SeedsOf(const CandidateTable& table) {
  std::vector<NodeSeed> seeds;
  seeds.reserve(table.entries().size() + 1);
  for (const CandidateTable::Entry& entry : table.entries()) {
    Candidate candidate;
    candidate.obstacle = Obstacle::kNone;
    candidate.objective = entry.objective;
    candidate.q = entry.q;
    seeds.push_back({table.Setting(entry.setting), candidate, entry.branch, false});
  }
  return seeds;
}

}  // namespace millpose
