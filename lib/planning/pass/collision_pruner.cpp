// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/collision_pruner.hpp"

#include <algorithm>

#include "base/trig.hpp"
#include "planning/ladder/table_layer.hpp"

namespace millpose {
namespace {

/// The node of a branch whose first freedom is nearest to `value`; kNoNode where the branch has none.
size_t Nearest(const Layer& layer, int lane, double value) {
  const auto first = layer.first.begin() + static_cast<std::ptrdiff_t>(layer.lane_begin[lane]);
  const auto last = layer.first.begin() + static_cast<std::ptrdiff_t>(layer.lane_begin[lane + 1]);
  if (first == last) return kNoNode;
  auto nearest = std::lower_bound(first, last, value);
  if (nearest == last || (nearest != first && value - nearest[-1] < *nearest - value)) --nearest;
  return static_cast<size_t>(nearest - layer.first.begin());
}

}  // namespace

std::optional<Sequence> CollisionPruner::Straight(const std::function<std::optional<Sequence>()>& search,
                                                  const Joins& joins) {
  for (;;) {
    std::optional<Sequence> sequence = search();
    if (!sequence || Straighten(*sequence, joins)) return sequence;
  }
}

bool CollisionPruner::Straighten(const Sequence& sequence, const Joins& joins) {
  constexpr double kTighter = 0.97;
  bool straight = true;
  std::vector<Bent> excusable;
  for (size_t t = 0; t < graph_.size(); ++t) {
    const std::optional<Transition> motion = graph_.TransitionOf(sequence, t);
    if (!motion) continue;
    const double deviation = law_.Bend(t, motion->q, motion->step);
    if (deviation <= law_.bound()) continue;
    const Joints unchanged = UnchangedStep(t, motion->from), beside = StepBeside(t, motion->from);
    const auto most = [&](const Joints& step) {
      return std::max(law_.bound(), kSearchedBend * law_.Bend(t, motion->q, step));
    };
    const auto bent = [&](double bound, const Joints& least) {
      return Bent{t, *motion, kTighter * std::sqrt(bound / deviation), least};
    };
    const double exact = most(unchanged), wide = std::max(exact, most(beside));
    if (deviation > wide) {
      Bar(bent(wide, unchanged.cwiseAbs().cwiseMax(beside.cwiseAbs())));
      straight = false;
    } else if (deviation > exact && joins && !excused_[t]) {
      excusable.push_back(bent(exact, unchanged));
    }
  }
  return straight && !BarWhatMayGo(excusable, sequence, joins);
}

void CollisionPruner::Bar(const Bent& bent) {
  if (!Tighten(bent.t, bent.motion, bent.share, bent.least)) graph_.Bar(bent.t, bent.motion);
}

/// Bars those motions without which there still is a sequence as good as the given one; the layers of the
/// others are excused from now on. True when some were barred.
bool CollisionPruner::BarWhatMayGo(std::span<const Bent> bents, const Sequence& sequence,
                                   const Joins& joins) {
  if (bents.empty()) return false;
  std::vector<Joints> before;
  for (const Bent& bent : bents) {
    before.push_back(graph_.max_step()[bent.t]);
    Bar(bent);
  }
  if (joins(sequence)) return true;
  for (size_t k = 0; k < bents.size(); ++k) {
    const Bent& bent = bents[k];
    graph_.BoundStep(bent.t, before[k]);
    graph_.Unbar(bent.t, bent.motion);  // was not: a search has chosen it
  }
  if (bents.size() == 1) return BarAlone(bents[0], sequence, joins);
  const size_t half = bents.size() / 2;
  const bool first = BarWhatMayGo(bents.first(half), sequence, joins);
  return BarWhatMayGo(bents.subspan(half), sequence, joins) || first;
}

/// Bars one motion and no other of its layer, as often as that is worth it; else the layer is excused.
bool CollisionPruner::BarAlone(const Bent& bent, const Sequence& sequence, const Joins& joins) {
  constexpr int kMostAlone = 16;
  graph_.Bar(bent.t, bent.motion);
  if (++barred_alone_[bent.t] <= kMostAlone && joins(sequence)) return true;
  graph_.Unbar(bent.t, bent.motion);
  excused_[bent.t] = 1;
  return false;
}

/// Bounds the steps from layer t to `share` of a motion's, or to a little more than `least`. True when that
/// bars the motion.
bool CollisionPruner::Tighten(size_t t, const Transition& motion, double share, const Joints& least) {
  // A joint's share in a bend grows with its lever and with the square of its step.
  const Carrier& carrier = graph_.checks().carrier;
  const Arm& arm = carrier.arm;
  const double hand = std::abs(arm.d5) + std::abs(arm.d6) + carrier.X_FT.translation().norm();
  const double whole = arm.a1 + arm.a2 + Hypot(arm.d4, arm.dz) + hand;
  Joints scale = Joints::Ones();
  scale.tail<3>().setConstant(std::sqrt(hand / whole));
  const double bound = share * motion.step.cwiseAbs().cwiseProduct(scale).maxCoeff();
  const Joints limit = graph_.max_step()[t].cwiseMin(
      (bound * scale.cwiseInverse()).cwiseMax(kSearchedBend * least.cwiseAbs()));
  graph_.BoundStep(t, limit);
  return (motion.step.cwiseAbs().array() > limit.array()).any();
}

/// The step from a node to where the freedoms are the same at the next point, whether or not a node is there.
Joints CollisionPruner::UnchangedStep(size_t from, size_t node) const {
  const Layer& layer = graph_.layer(from);
  return law_.UnchangedStep(from, FreedomsOf(layer, node), layer.BranchOf(node), layer.joints.At(node));
}

/// The step from a node to the nearest of its branch in the next layer.
Joints CollisionPruner::StepBeside(size_t from, size_t node) const {
  const Layer &layer = graph_.layer(from), &next = graph_.layer(graph_.Next(from));
  const size_t beside = Nearest(next, layer.LaneOf(node), layer.first[node]);
  if (beside == kNoNode) return Joints::Zero();
  return (next.joints.At(beside) - layer.joints.At(node)).unaryExpr(&WrapToPi);
}

bool CollisionPruner::Check(const Sequence& sequence) {
  const size_t count = graph_.size();
  std::vector<std::pair<size_t, size_t>> nodes;
  for (size_t t = 0; t < count; ++t) {
    if (sequence.nodes[t] != kNoNode) nodes.emplace_back(t, sequence.nodes[t]);
  }
  std::vector<Interval> blocked = CheckNodes(nodes);
  const bool all_free = blocked.empty();
  // An obstacle bars like a wall that runs through many layers. Met one crossing at a time it would take as
  // many rounds, so it is followed.
  for (size_t step = 0; step < flood_ && !blocked.empty(); ++step) blocked = CheckNodes(Beside(blocked));
  flood_ = std::min(2 * flood_, count);

  std::vector<char> barred(count, 0);
  graph_.InParallel(
      count, [&](PassCheckers& checkers, size_t t) { barred[t] = !CheckMotion(checkers, t, sequence); });
  barred_.clear();
  for (size_t t = 0; t < count; ++t) {
    if (barred[t]) barred_.push_back(t);
  }
  return all_free && barred_.empty();
}

void CollisionPruner::BarBeside(const Sequence& sequence) {
  constexpr int kSteps = 16;
  constexpr size_t kMost = 64;  // motions to go on from, a step
  std::vector<Motion> from;
  for (const size_t t : barred_) from.push_back({t, sequence.nodes[t], sequence.nodes[graph_.Next(t)]});
  std::set<Motion> seen(from.begin(), from.end());
  for (int step = 0; step < kSteps && !from.empty(); ++step) {
    std::vector<Motion> next;
    for (const Motion& motion : Beside(from))
      if ((sequence.closed || motion.t + 1 < graph_.size()) && seen.insert(motion).second)
        next.push_back(motion);
    from = BarredOf(next);
    if (from.size() > kMost) from.resize(kMost);
  }
}

/// Those of the motions, which are in order, that interfere; they are barred. Their nodes are checked as
/// well.
std::vector<CollisionPruner::Motion> CollisionPruner::BarredOf(const std::vector<Motion>& motions) {
  std::vector<std::pair<size_t, size_t>> nodes;
  std::vector<size_t> begin;  // of the motions that leave one layer
  for (size_t k = 0; k < motions.size(); ++k) {
    const auto& [t, from, to] = motions[k];
    nodes.emplace_back(t, from);
    nodes.emplace_back(graph_.Next(t), to);
    if (k == 0 || t != motions[k - 1].t) begin.push_back(k);
  }
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  CheckNodes(nodes);
  std::vector<char> barred(motions.size(), 0);
  graph_.InParallel(begin.size(), [&](PassCheckers& checkers, size_t i) {
    const size_t end = i + 1 < begin.size() ? begin[i + 1] : motions.size();
    for (size_t k = begin[i]; k < end; ++k) {
      const auto& [t, from, to] = motions[k];
      constexpr auto kFree = CandidateGraph::Verdict::kFree;
      if (graph_.VerdictOf(t, from) != kFree || graph_.VerdictOf(graph_.Next(t), to) != kFree) continue;
      if (const std::optional<Transition> motion = graph_.TransitionBetween(t, from, to))
        barred[k] = !graph_.IsFree(checkers, t, *motion);
    }
  });
  std::vector<Motion> of;
  for (size_t k = 0; k < motions.size(); ++k)
    if (barred[k]) of.push_back(motions[k]);
  return of;
}

/// Motions that leave the same layer and begin or end a node further, and those from the layers before and
/// after with about the same first freedoms; in order.
std::vector<CollisionPruner::Motion> CollisionPruner::Beside(const std::vector<Motion>& motions) const {
  std::vector<Motion> beside;
  const size_t count = graph_.size();
  for (const Motion& motion : motions) {
    const size_t to = graph_.Next(motion.t);
    const Layer &layer = graph_.layer(motion.t), &next = graph_.layer(to);
    const int lane = layer.LaneOf(motion.from);
    const auto around = [&](const Layer& of, size_t node, const auto& take) {
      if (node > of.lane_begin[lane]) take(node - 1);
      if (node + 1 < of.lane_begin[lane + 1]) take(node + 1);
    };
    around(layer, motion.from, [&](size_t node) { beside.push_back({motion.t, node, motion.to}); });
    around(next, motion.to, [&](size_t node) { beside.push_back({motion.t, motion.from, node}); });
    for (const size_t t : {(motion.t + count - 1) % count, to}) {
      const size_t a = Nearest(graph_.layer(t), lane, layer.first[motion.from]),
                   b = Nearest(graph_.layer(graph_.Next(t)), lane, next.first[motion.to]);
      if (a != kNoNode && b != kNoNode) beside.push_back({t, a, b});
    }
  }
  std::ranges::sort(beside);
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  return beside;
}

/// Checks single nodes, (layer, node); no layer twice. What was pruned, in the order of `nodes`.
std::vector<CollisionPruner::Interval> CollisionPruner::CheckNodes(
    const std::vector<std::pair<size_t, size_t>>& nodes) {
  // Layers are independent of one another; the nodes of one layer come one after the other.
  std::vector<size_t> begin;
  for (size_t k = 0; k < nodes.size(); ++k) {
    if (k == 0 || nodes[k].first != nodes[k - 1].first) begin.push_back(k);
  }
  std::vector<std::optional<Interval>> found(nodes.size());
  graph_.InParallel(begin.size(), [&](PassCheckers& checkers, size_t i) {
    const size_t end = i + 1 < begin.size() ? begin[i + 1] : nodes.size();
    for (size_t k = begin[i]; k < end; ++k) found[k] = CheckNode(checkers, nodes[k].first, nodes[k].second);
  });
  std::vector<Interval> blocked;
  for (const std::optional<Interval>& interval : found) {
    if (interval) blocked.push_back(*interval);
  }
  return blocked;
}

/// The nodes beside the middles of `blocked` in the layers before and after.
std::vector<std::pair<size_t, size_t>> CollisionPruner::Beside(const std::vector<Interval>& blocked) const {
  std::vector<std::pair<size_t, size_t>> nodes;
  const size_t count = graph_.size();
  for (const Interval& interval : blocked) {
    const Layer& layer = graph_.layer(interval.layer);
    const size_t middle = (interval.first + interval.last) / 2;
    const int lane = layer.LaneOf(middle);
    for (const size_t beside : {(interval.layer + count - 1) % count, graph_.Next(interval.layer)}) {
      const size_t nearest = Nearest(graph_.layer(beside), lane, layer.first[middle]);
      if (nearest != kNoNode) nodes.emplace_back(beside, nearest);
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// What was pruned now: the node with its neighbours; nothing where it is free or was blocked before.
std::optional<CollisionPruner::Interval> CollisionPruner::CheckNode(PassCheckers& checkers, size_t layer,
                                                                    size_t node) {
  const auto prunes = [&](size_t k) { return graph_.Prunes(checkers, layer, k); };
  if (!prunes(node)) return std::nullopt;
  // Interference fills intervals: look for its ends now instead of meeting every node of it in a round of its
  // own.
  const Layer& of = graph_.layer(layer);
  const int lane = of.LaneOf(node);
  const size_t begin = of.lane_begin[lane], end = of.lane_begin[lane + 1];
  Interval interval{layer, node, node};
  while (interval.first > begin && prunes(interval.first - 1)) --interval.first;
  while (interval.last + 1 < end && prunes(interval.last + 1)) ++interval.last;
  return interval;
}

bool CollisionPruner::CheckMotion(PassCheckers& checkers, size_t from, const Sequence& sequence) {
  const std::optional<Transition> motion = graph_.TransitionOf(sequence, from);
  if (!motion) return true;
  constexpr auto kFree = CandidateGraph::Verdict::kFree;
  if (graph_.VerdictOf(from, motion->from) != kFree) return true;
  if (graph_.VerdictOf(graph_.Next(from), motion->to) != kFree) return true;
  return graph_.IsFree(checkers, from, *motion);
}

void CollisionPruner::PruneInRound(const Sequence& sequence, int round) {
  // How often the search runs again over what the checks pruned, before steps beside motions that
  // interfere get shorter, before such motions take their nodes with them, and before they take their points
  // with them; after that each round removes a point.
  constexpr int kRoundsOfMotions = 2, kRoundsOfSteps = 6, kRoundsOfNodes = 60;
  constexpr double kShorter = 0.7;
  if (round < kRoundsOfMotions) return;
  std::erase_if(barred_, [&](size_t t) {
    const Transition motion = *graph_.TransitionOf(sequence, t);
    return Tighten(t, motion, kShorter, StepBeside(t, motion.from));
  });
  if (round < kRoundsOfSteps) return;
  PruneBarred(sequence, round < kRoundsOfNodes ? Extent::kNodes : Extent::kLayers);
}

/// Prunes the nodes at both ends of the motions that the last check found, or all nodes of the layers that
/// they leave.
void CollisionPruner::PruneBarred(const Sequence& sequence, Extent extent) {
  for (const size_t t : barred_) {
    const size_t to = graph_.Next(t);
    if (extent == Extent::kNodes) {
      graph_.TakeOut(t, sequence.nodes[t]);
      graph_.TakeOut(to, sequence.nodes[to]);
      graph_.CopyProblem(t, to);
    } else {
      for (size_t k = 0; k < graph_.layer(t).size(); ++k) graph_.TakeOut(t, k);
    }
  }
}

}  // namespace millpose
