// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/table_layer.hpp"

namespace millpose {

int Layer::LaneOf(size_t node) const {
  return static_cast<int>(std::upper_bound(lane_begin.begin() + 1, lane_begin.end(), node) -
                          lane_begin.begin()) -
         1;
}

bool Layer::usable() const {
  return std::any_of(objective.begin(), objective.end(), [](double value) { return std::isfinite(value); });
}

FreedomValues FreedomsOf(const Layer& layer, size_t node) {
  return layer.freedoms.empty() ? FreedomValues{layer.first[node]} : layer.freedoms[node];
}

namespace {

/// Takes the nodes of a layer in their order.
class LayerMaker {
 public:
  LayerMaker(const PointScorer& scorer, size_t count, bool all_revolutions, int courses)
      : bounds_(scorer.problem().bounds),
        dimensions_(scorer.problem().freedoms.size()),
        all_revolutions_(all_revolutions) {
    layer_.R_WT = scorer.ToolPose(FreedomValues(dimensions_, 0.0)).linear();
    layer_.lane_begin.assign(8 * static_cast<size_t>(courses) + 1, 0);
    for (auto& row : layer_.joints.q) row.reserve(count + kBlock);
    layer_.objective.reserve(count);
    if (dimensions_ > 1) layer_.freedoms.reserve(count);
    layer_.first.reserve(count);
    layer_.base.reserve(count);
    layer_.genetic.reserve(count);
  }

  void Add(int lane, const FreedomValues& freedoms, double objective, const Joints& q, bool genetic) {
    ++base_;
    while (lane_ < static_cast<size_t>(lane)) layer_.lane_begin[++lane_] = layer_.size();
    const double first = freedoms[0];
    const auto add = [&](const Joints& turned) {
      layer_.joints.Add(turned);
      layer_.objective.push_back(objective);
      layer_.first.push_back(first);
      layer_.base.push_back(base_);
      layer_.genetic.push_back(genetic);
    };
    if (all_revolutions_) {
      for (const Joints& turned : FullRevolutions(q, bounds_.lower, bounds_.upper)) add(turned);
    } else {
      add(q);
    }
    if (dimensions_ > 1) layer_.freedoms.resize(layer_.size(), freedoms);
  }
  void Add(const NodeSeed& seed) {
    Add(seed.lane(), seed.freedoms, seed.candidate.objective, seed.candidate.q, seed.genetic);
  }

  Layer Finish() {
    while (lane_ + 1 < layer_.lane_begin.size()) layer_.lane_begin[++lane_] = layer_.size();
    layer_.joints.Finish();
    return std::move(layer_);
  }

 private:
  const AdmissibleBounds& bounds_;
  size_t dimensions_;
  bool all_revolutions_;
  Layer layer_;
  size_t base_ = 0, lane_ = 0;
};

/// The admissible ones by lane and freedoms; seeds are too large to be moved about.
std::vector<const NodeSeed*> InOrder(const std::vector<NodeSeed>& seeds) {
  std::vector<const NodeSeed*> order;
  order.reserve(seeds.size());
  for (const NodeSeed& seed : seeds)
    if (seed.candidate.obstacle == Infeasibility::kNone) order.push_back(&seed);
  std::ranges::stable_sort(order, [](const NodeSeed* a, const NodeSeed* b) {
    return a->lane() != b->lane() ? a->lane() < b->lane() : a->freedoms < b->freedoms;
  });
  return order;
}

}  // namespace

Layer MakeLayer(const PointScorer& scorer, std::vector<NodeSeed> seeds, bool all_revolutions, int courses) {
  const std::vector<const NodeSeed*> order = InOrder(seeds);
  LayerMaker maker(scorer, order.size(), all_revolutions, courses);
  for (const NodeSeed* seed : order) maker.Add(*seed);
  return maker.Finish();
}

Layer MakeLayer(const PointScorer& scorer, const CandidateTable& table, std::vector<NodeSeed> others,
                bool all_revolutions) {
  const std::vector<const NodeSeed*> order = InOrder(others);
  LayerMaker maker(scorer, table.entries().size() + order.size(), all_revolutions, 1);
  auto other = order.begin();
  const bool one = scorer.problem().freedoms.size() == 1;
  FreedomValues freedoms(1);
  for (int branch = 0; branch < 8; ++branch) {
    const auto waits = [&] { return other != order.end() && (*other)->branch == branch; };
    for (const CandidateTable::Entry& entry : table.entries()) {
      if (entry.branch != branch) continue;
      if (one)
        freedoms[0] = table.At(0, static_cast<int>(entry.setting));
      else
        freedoms = table.Setting(entry.setting);
      while (waits() && (*other)->freedoms < freedoms) maker.Add(**other++);
      maker.Add(branch, freedoms, entry.objective, entry.q, false);
    }
    while (waits()) maker.Add(**other++);
  }
  return maker.Finish();
}

namespace {

NodeSeed SeedOf(const CandidateTable& table, const CandidateTable::Entry& entry, int course) {
  Candidate candidate;
  candidate.obstacle = Infeasibility::kNone;
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
