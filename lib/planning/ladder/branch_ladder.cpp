// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/branch_ladder.hpp"

#include <tuple>

namespace millpose {
namespace {

constexpr size_t kMostLooks = 64;  // at one point for interference, from its best candidate on
constexpr size_t kReach = 6;       // rotation steps between neighbouring sampled points
constexpr double kUnreached = std::numeric_limits<double>::infinity();

}  // namespace

bool IsBetter(const BranchScore& a, const BranchScore& b) {
  return a.free != b.free ? a.free > b.free : a.worst < b.worst;
}

std::array<BranchScore, 8> PromisesOf(const std::vector<CandidateTable>& tables) {
  std::array<BranchScore, 8> promises;
  for (const CandidateTable& table : tables) {
    std::array<double, 8> least;
    least.fill(kUnreached);
    for (const CandidateTable::Entry& entry : table.entries())
      least[entry.branch] = std::min(least[entry.branch], entry.objective);
    for (size_t branch = 0; branch < 8; ++branch) {
      if (least[branch] == kUnreached) continue;
      ++promises[branch].free;
      promises[branch].worst = std::max(promises[branch].worst, least[branch]);
    }
  }
  return promises;
}

/// Of a way to a node: what cannot be reached comes last.
struct BranchLadder::Cost {
  size_t breaks = std::numeric_limits<size_t>::max();
  double worst = kUnreached, sum = kUnreached;
  bool any() const { return worst < kUnreached; }
  bool operator<(const Cost& other) const {
    return std::tie(breaks, worst, sum) < std::tie(other.breaks, other.worst, other.sum);
  }
};

/// For each setting the cheapest of those within kReach of it, and of equal ones the first. By the least of
/// what lies left and right of it in blocks as wide as that (van Herk 1992, Pattern Recognition Letters 13).
std::vector<size_t> BranchLadder::CheapestNear(const std::vector<Cost>& costs) {
  constexpr size_t kWidth = 2 * kReach + 1;
  const size_t count = costs.size(), padded = count + 2 * kReach;
  std::vector<size_t> up_to(padded), from(padded), near(count);
  for (size_t i = 0; i < padded; ++i) {
    const size_t here = (i + count - kReach) % count;
    up_to[i] = from[i] = here;
    if (i % kWidth != 0 && !(costs[here] < costs[up_to[i - 1]])) up_to[i] = up_to[i - 1];
  }
  for (size_t i = padded - 1; i-- > 0;)
    if ((i + 1) % kWidth != 0 && costs[from[i + 1]] < costs[from[i]]) from[i] = from[i + 1];
  for (size_t s = 0; s < count; ++s) {
    const size_t first = from[s], second = up_to[s + 2 * kReach];
    near[s] = costs[second] < costs[first] ? second : first;
  }
  return near;
}

BranchLadder::BranchLadder(const AdmissibleBounds& bounds, const std::vector<CandidateTable>& tables,
                           size_t branch)
    : tables_(&tables) {
  const Joints range = bounds.upper - bounds.lower;
  for (int j = 0; j < 6; ++j)
    if (range[j] > kPi && range[j] < 3 * kPi) stopped_.push_back(j);
  for (const CandidateTable& table : tables) {
    Layer layer{std::vector<Node>(table.settings())};
    for (size_t i = 0; i < table.entries().size(); ++i) {
      const CandidateTable::Entry& entry = table.entries()[i];
      if (entry.branch != branch) continue;
      layer.nodes[entry.setting] = {entry.objective, i};
    }
    layers_.push_back(std::move(layer));
  }
}

/// Looks at those of the chosen nodes that it is not known of, and takes out the others; returns whether
/// none was taken out.
template <class Look>
bool BranchLadder::AllAre(bool Node::*what, const std::vector<Choice>& chosen, const Look& look) {
  bool all = true;
  for (size_t t = 0; t < layers_.size(); ++t) {
    const size_t setting = chosen[t].setting;
    if (setting == kNoSetting) continue;
    Node& node = layers_[t].nodes[setting];
    if (node.*what) continue;
    node.*what = look(t, node, setting);
    if (node.*what) continue;
    all = false;
    node.objective = kUnreached;
    layers_[t].blocked = true;
  }
  return all;
}

BranchScore BranchLadder::Score(const Looks& look, const std::optional<BranchScore>& best) {
  size_t looks = 0;
  const auto stands = [&](size_t t, const Node& node, size_t setting) {
    ++looks;
    return look.stands(t, (*tables_)[t].entries()[node.entry].q, (*tables_)[t].Setting(setting));
  };
  const auto leaves = [&](size_t t, const Node& node, size_t) {
    return look.leaves(t, (*tables_)[t].entries()[node.entry].q);
  };
  while (true) {
    const std::vector<Choice> chosen = Choose();
    BranchScore bound = Result(chosen);
    // Where all points are free no pass that is broken or lacks one is better, and each node less makes the
    // worst of the others no less.
    if (best && best->free == layers_.size() && !IsBetter(bound, *best)) return bound;
    if (AllAre(&Node::stands, chosen, stands) && AllAre(&Node::leaves, chosen, leaves)) return bound;
    if (looks > kMostLooks * layers_.size()) return Result(std::vector<Choice>(layers_.size()));
  }
}

/// Of every layer; no setting where no node is left.
std::vector<BranchLadder::Choice> BranchLadder::Choose() const {
  std::vector<size_t> used;
  for (size_t t = 0; t < layers_.size(); ++t)
    if (std::ranges::any_of(layers_[t].nodes, [](const Node& node) { return node.objective < kUnreached; }))
      used.push_back(t);
  std::vector<Choice> chosen(layers_.size());
  if (used.empty()) return chosen;
  const size_t count = layers_.front().nodes.size();
  std::vector<Choice> from(used.size() * count);
  std::vector<Cost> before(count, Cost{0, 0, 0}), now(count);
  for (size_t u = 0; u < used.size(); ++u) {
    const std::vector<Node>& nodes = layers_[used[u]].nodes;
    const auto least = static_cast<size_t>(std::min_element(before.begin(), before.end()) - before.begin());
    const std::vector<size_t> near = CheapestNear(before);
    for (size_t s = 0; s < count; ++s) {
      now[s] = {};
      if (nodes[s].objective == kUnreached) continue;
      size_t best = u == 0 ? s : BestBefore(before, near[s], used[u - 1], used[u], s);
      const bool broken = best == kNoSetting || before[least].breaks + 1 < before[best].breaks;
      if (broken) best = least;
      from[u * count + s] = {best, broken};
      now[s] = {before[best].breaks + (broken ? 1 : 0), std::max(before[best].worst, nodes[s].objective),
                before[best].sum + nodes[s].objective};
    }
    std::swap(before, now);
  }
  auto s = static_cast<size_t>(std::min_element(before.begin(), before.end()) - before.begin());
  for (size_t u = used.size(); u-- > 0;) {
    const Choice& choice = from[u * count + s];
    chosen[used[u]] = {s, choice.after_break};
    s = choice.setting;
  }
  return chosen;
}

/// The cheapest setting of layer t from which the joints can go to setting `to` of layer u; none where none
/// leads there. `near`: of CheapestNear.
size_t BranchLadder::BestBefore(const std::vector<Cost>& costs, size_t near, size_t t, size_t u,
                                size_t to) const {
  if (!costs[near].any()) return kNoSetting;
  if (Leads(t, near, u, to)) return near;
  const size_t count = costs.size();
  size_t best = kNoSetting;
  for (size_t d = 0; d <= 2 * kReach; ++d) {
    const size_t other = (to + count + d - kReach) % count;
    if (costs[other].any() && (best == kNoSetting || costs[other] < costs[best]) && Leads(t, other, u, to))
      best = other;
  }
  return best;
}

/// Whether the joints can go from a node of layer t to one of layer u without a limit between them. An axis
/// with far more than a turn goes round as far as it must.
bool BranchLadder::Leads(size_t t, size_t from, size_t u, size_t to) const {
  const Joints& q0 = (*tables_)[t].entries()[layers_[t].nodes[from].entry].q;
  const Joints& q1 = (*tables_)[u].entries()[layers_[u].nodes[to].entry].q;
  return std::ranges::none_of(stopped_, [&](int j) { return std::abs(q1[j] - q0[j]) > kPi; });
}

BranchScore BranchLadder::Result(const std::vector<Choice>& chosen) const {
  BranchScore score;
  for (size_t t = 0; t < layers_.size(); ++t) {
    const Choice& choice = chosen[t];
    if (choice.setting != kNoSetting && choice.after_break) {
      score.points.push_back({Infeasibility::kStep, 0});
    } else if (choice.setting != kNoSetting) {
      score.points.push_back({Infeasibility::kNone, layers_[t].nodes[choice.setting].objective});
      ++score.free;
      score.worst = std::max(score.worst, score.points.back().objective);
    } else if ((*tables_)[t].entries().empty()) {
      score.points.push_back({(*tables_)[t].reason(), 0});
    } else {
      score.points.push_back({layers_[t].blocked ? Infeasibility::kInterference : Infeasibility::kStep, 0});
    }
  }
  return score;
}

}  // namespace millpose
