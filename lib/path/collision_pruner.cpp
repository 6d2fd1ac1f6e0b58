// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/collision_pruner.hpp"

#include <limits>

#include "base/cpu_time.hpp"
#include "base/parallel.hpp"
#include "base/trig.hpp"
#include "motion/line.hpp"

namespace millpose {
namespace {

/// The node of a branch whose first freedom is nearest to `value`; kNoNode where the branch has none.
size_t Nearest(const Layer& layer, int branch, double value) {
  const auto first = layer.first.begin() + static_cast<std::ptrdiff_t>(layer.branch_begin[branch]);
  const auto last = layer.first.begin() + static_cast<std::ptrdiff_t>(layer.branch_begin[branch + 1]);
  if (first == last) return kNoNode;
  auto nearest = std::lower_bound(first, last, value);
  if (nearest == last || (nearest != first && value - nearest[-1] < *nearest - value)) --nearest;
  return static_cast<size_t>(nearest - layer.first.begin());
}

}  // namespace

CheckCounts CheckInParallel(const World& world, size_t count, int threads, std::stop_token stop,
                            const std::function<void(Checker&, size_t)>& work) {
  // Chunks of fixed size, a checker each: what a checker remembers cannot depend on the number of threads.
  constexpr size_t kChunk = 16;
  const size_t chunks = (count + kChunk - 1) / kChunk;
  std::vector<CheckCounts> counts(chunks);
  ParallelFor(chunks, threads, stop, [&](size_t chunk) {
    const CpuTimer timer(CpuPart::kInterference);
    Checker checker(world);
    for (size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) work(checker, i);
    counts[chunk] = checker.counts();
  });
  CheckCounts sum;
  for (const CheckCounts& chunk : counts) sum += chunk;
  return sum;
}

std::string Describe(const Interference& interference) {
  return fmt::format("{} and {} {} at ({:.1f}, {:.1f}, {:.1f}) mm", interference.first, interference.second,
                     interference.distance > 0 ? fmt::format("come within {:.2f} mm", interference.distance)
                                               : std::string("touch"),
                     interference.place().x(), interference.place().y(), interference.place().z());
}

CollisionPruner::CollisionPruner(const World& world, const Carrier& carrier,
                                 std::span<const PointScorer> scorers, std::vector<Layer>& layers,
                                 double swept_resolution, bool rotates_first, StepLimits limits, int threads,
                                 std::stop_token stop)
    : world_(world),
      carrier_(carrier),
      layers_(layers),
      rotates_first_(rotates_first),
      swept_resolution_(swept_resolution),
      limits_(std::move(limits)),
      law_(carrier, scorers, limits_.max_deviation),
      excused_(layers.size(), 0),
      barred_alone_(layers.size(), 0),
      threads_(threads),
      stop_(std::move(stop)),
      verdict_(layers.size()),
      pair_(layers.size()),
      memory_(layers.size()),
      blocked_(layers.size()),
      free_(layers.size()),
      versions_(layers.size(), 0),
      last_problem_(layers.size()) {
  for (size_t t = 0; t < layers.size(); ++t) {
    verdict_[t].assign(layers[t].size(), Verdict::kUnknown);
    pair_[t].assign(layers[t].size(), -1);
  }
}

long long CollisionPruner::nodes_checked() const {
  long long checked = 0;
  for (const std::vector<Verdict>& layer : verdict_) {
    checked += std::count_if(layer.begin(), layer.end(), [](Verdict v) { return v != Verdict::kUnknown; });
  }
  return checked;
}

std::string CollisionPruner::Detail(size_t layer) const {
  if (!last_problem_[layer]) return {};
  Checker checker(world_);
  return Describe(checker, *last_problem_[layer]);
}

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
  for (size_t t = 0; t < layers_.size(); ++t) {
    const std::optional<Motion> motion = MotionFrom(t, sequence);
    if (!motion) continue;
    const double deviation = law_.Bend(motion->q, motion->step);
    if (deviation <= limits_.max_deviation) continue;
    const Joints unchanged = UnchangedStep(t, motion->from), beside = StepBeside(t, motion->from);
    const auto most = [&](const Joints& step) {
      return std::max(limits_.max_deviation, kSearchedBend * law_.Bend(motion->q, step));
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
  if (!Tighten(bent.t, bent.motion, bent.share, bent.least))
    blocked_[bent.t].insert({bent.motion.from, bent.motion.to});
  ++versions_[bent.t];
}

/// Bars those motions without which there still is a sequence as good as the given one; the layers of the
/// others are excused from now on. True when some were barred.
bool CollisionPruner::BarWhatMayGo(std::span<const Bent> bents, const Sequence& sequence,
                                   const Joins& joins) {
  if (bents.empty()) return false;
  std::vector<Joints> before;
  for (const Bent& bent : bents) {
    before.push_back(limits_.max_step[bent.t]);
    Bar(bent);
  }
  if (joins(sequence)) return true;
  for (size_t k = 0; k < bents.size(); ++k) {
    const Bent& bent = bents[k];
    limits_.max_step[bent.t] = before[k];
    blocked_[bent.t].erase({bent.motion.from, bent.motion.to});  // was not: a search has chosen it
    ++versions_[bent.t];
  }
  if (bents.size() == 1) return BarAlone(bents[0], sequence, joins);
  const size_t half = bents.size() / 2;
  const bool first = BarWhatMayGo(bents.first(half), sequence, joins);
  return BarWhatMayGo(bents.subspan(half), sequence, joins) || first;
}

/// The motion of a sequence from layer t to the next; empty where the tool is lifted or nothing is cut.
std::optional<CollisionPruner::Motion> CollisionPruner::MotionFrom(size_t t, const Sequence& sequence) const {
  const size_t to = (t + 1) % layers_.size(), a = sequence.nodes[t], b = sequence.nodes[to];
  if (a == kNoNode || b == kNoNode) return std::nullopt;
  if (to == 0 ? !sequence.closed : bool(sequence.break_before[to])) return std::nullopt;
  const Joints q = layers_[t].joints.At(a);
  return Motion{a, b, q, (layers_[to].joints.At(b) - q).unaryExpr(&WrapToPi)};
}

/// Bars one motion and no other of its layer, as often as that is worth it; else the layer is excused.
bool CollisionPruner::BarAlone(const Bent& bent, const Sequence& sequence, const Joins& joins) {
  constexpr int kMostAlone = 16;
  const std::pair motion(bent.motion.from, bent.motion.to);
  blocked_[bent.t].insert(motion);
  ++versions_[bent.t];
  if (++barred_alone_[bent.t] <= kMostAlone && joins(sequence)) return true;
  blocked_[bent.t].erase(motion);
  ++versions_[bent.t];
  excused_[bent.t] = 1;
  return false;
}

/// Bounds the steps from layer t to `share` of a motion's, or to a little more than `least`. True when that
/// bars the motion.
bool CollisionPruner::Tighten(size_t t, const Motion& motion, double share, const Joints& least) {
  // A joint's share in a bend grows with its lever and with the square of its step.
  const Arm& arm = carrier_.arm;
  const double hand = std::abs(arm.d5) + std::abs(arm.d6) + carrier_.X_FT.translation().norm();
  const double whole = arm.a1 + arm.a2 + Hypot(arm.d4, arm.dz) + hand;
  Joints scale = Joints::Ones();
  scale.tail<3>().setConstant(std::sqrt(hand / whole));
  const double bound = share * motion.step.cwiseAbs().cwiseProduct(scale).maxCoeff();
  Joints& limit = limits_.max_step[t];
  limit = limit.cwiseMin((bound * scale.cwiseInverse()).cwiseMax(kSearchedBend * least.cwiseAbs()));
  ++versions_[t];
  return (motion.step.cwiseAbs().array() > limit.array()).any();
}

/// The step from a node to where the freedoms are the same at the next point, whether or not a node is there.
Joints CollisionPruner::UnchangedStep(size_t from, size_t node) const {
  const Layer& layer = layers_[from];
  return law_.UnchangedStep(from, layer.freedoms[node], layer.BranchOf(node), layer.joints.At(node));
}

/// The step from a node to the nearest of its branch in the next layer.
Joints CollisionPruner::StepBeside(size_t from, size_t node) const {
  const Layer &layer = layers_[from], &next = layers_[(from + 1) % layers_.size()];
  const size_t beside = Nearest(next, layer.BranchOf(node), layer.first[node]);
  if (beside == kNoNode) return Joints::Zero();
  return (next.joints.At(beside) - layer.joints.At(node)).unaryExpr(&WrapToPi);
}

bool CollisionPruner::Check(const Sequence& sequence) {
  const size_t count = layers_.size();
  std::vector<std::pair<size_t, size_t>> nodes;
  for (size_t t = 0; t < count; ++t) {
    if (sequence.nodes[t] != kNoNode) nodes.emplace_back(t, sequence.nodes[t]);
  }
  std::vector<Interval> blocked = CheckNodes(nodes);
  bool all_free = blocked.empty();
  // An obstacle bars like a wall that runs through many layers. Met one crossing at a time it would take as
  // many rounds, so it is followed.
  for (size_t step = 0; step < flood_ && !blocked.empty(); ++step) blocked = CheckNodes(Beside(blocked));
  flood_ = std::min(2 * flood_, count);

  std::vector<char> barred(count, 0);
  counts_ += CheckInParallel(world_, count, threads_, stop_, [&](Checker& checker, size_t t) {
    const size_t to = (t + 1) % count;
    if (to == 0 ? !sequence.closed : bool(sequence.break_before[to])) return;
    barred[t] = !CheckMotion(checker, t, to, sequence);
  });
  barred_.clear();
  for (size_t t = 0; t < count; ++t) {
    if (barred[t]) barred_.push_back(t);
  }
  return all_free && barred_.empty();
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
  counts_ += CheckInParallel(world_, begin.size(), threads_, stop_, [&](Checker& checker, size_t i) {
    const size_t end = i + 1 < begin.size() ? begin[i + 1] : nodes.size();
    for (size_t k = begin[i]; k < end; ++k) found[k] = CheckNode(checker, nodes[k].first, nodes[k].second);
  });
  std::vector<Interval> blocked;
  for (const std::optional<Interval>& interval : found) {
    if (!interval) continue;
    blocked.push_back(*interval);
    nodes_pruned_ += static_cast<int>(interval->last - interval->first + 1);
  }
  return blocked;
}

/// The nodes beside the middles of `blocked` in the layers before and after.
std::vector<std::pair<size_t, size_t>> CollisionPruner::Beside(const std::vector<Interval>& blocked) const {
  std::vector<std::pair<size_t, size_t>> nodes;
  const size_t count = layers_.size();
  for (const Interval& interval : blocked) {
    const Layer& layer = layers_[interval.layer];
    const size_t middle = (interval.first + interval.last) / 2;
    const int branch = layer.BranchOf(middle);
    for (const size_t beside : {(interval.layer + count - 1) % count, (interval.layer + 1) % count}) {
      const Layer& other = layers_[beside];
      const size_t nearest = Nearest(other, branch, layer.first[middle]);
      if (nearest != kNoNode) nodes.emplace_back(beside, nearest);
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::optional<Sighting> CollisionPruner::Meets(Checker& checker, size_t layer, const FreedomValues& freedoms,
                                               const Joints& q) {
  return rotates_first_ ? checker.Blocked(q, Phase::kCutting, freedoms, memory_[layer])
                        : checker.Blocked(q, Phase::kCutting);
}

/// Looks at a node of which nothing is known; true when it was pruned now.
bool CollisionPruner::Blocks(Checker& checker, size_t layer, size_t node) {
  Verdict& verdict = verdict_[layer][node];
  if (verdict != Verdict::kUnknown) return false;
  Layer& of = layers_[layer];
  const auto hit = Meets(checker, layer, of.freedoms[node], of.joints.At(node));
  verdict = hit ? Verdict::kBlocked : Verdict::kFree;
  if (!hit) return false;
  last_problem_[layer] = CutProblem{hit};
  pair_[layer][node] = hit->pair;
  ++versions_[layer];
  of.objective[node] = std::numeric_limits<double>::infinity();
  return true;
}

bool CollisionPruner::IsFree(Checker& checker, size_t layer, size_t node) {
  Blocks(checker, layer, node);
  return verdict_[layer][node] == Verdict::kFree;
}

void CollisionPruner::EachLayer(const std::function<void(Checker&, size_t)>& work) {
  counts_ += CheckInParallel(world_, layers_.size(), threads_, stop_, work);
}

/// What was pruned now: the node with its neighbours; nothing where it is free or was blocked before.
std::optional<CollisionPruner::Interval> CollisionPruner::CheckNode(Checker& checker, size_t layer,
                                                                    size_t node) {
  const auto blocks = [&](size_t k) { return Blocks(checker, layer, k); };
  if (!blocks(node)) return std::nullopt;
  // Interference fills intervals: look for its ends now instead of meeting every node of it in a round of its
  // own.
  const int branch = layers_[layer].BranchOf(node);
  const size_t begin = layers_[layer].branch_begin[branch], end = layers_[layer].branch_begin[branch + 1];
  Interval interval{layer, node, node};
  while (interval.first > begin && blocks(interval.first - 1)) --interval.first;
  while (interval.last + 1 < end && blocks(interval.last + 1)) ++interval.last;
  return interval;
}

bool CollisionPruner::CheckMotion(Checker& checker, size_t from, size_t to, const Sequence& sequence) {
  const size_t a = sequence.nodes[from], b = sequence.nodes[to];
  if (a == kNoNode || b == kNoNode) return true;
  if (verdict_[from][a] != Verdict::kFree || verdict_[to][b] != Verdict::kFree) return true;
  if (free_[from].contains({a, b})) return true;
  const Joints q0 = layers_[from].joints.At(a);
  const Joints q1 = q0 + (layers_[to].joints.At(b) - q0).unaryExpr(&WrapToPi);
  const std::optional<CutProblem> problem = CheckCut(checker, carrier_, q0, q1, swept_resolution_);
  (problem ? blocked_ : free_)[from].insert({a, b});
  if (!problem) return true;
  last_problem_[from] = problem;
  ++versions_[from];
  return false;
}

void CollisionPruner::PruneInRound(const Sequence& sequence, int round) {
  // How often the search runs again over what the checks pruned, before steps beside motions that
  // interfere get shorter, before such motions take their nodes with them, and before they take their points
  // with them; after that each round removes a point.
  constexpr int kRoundsOfMotions = 2, kRoundsOfSteps = 6, kRoundsOfNodes = 60;
  constexpr double kShorter = 0.7;
  if (round < kRoundsOfMotions) return;
  std::erase_if(barred_, [&](size_t t) {
    const Motion motion = *MotionFrom(t, sequence);
    return Tighten(t, motion, kShorter, StepBeside(t, motion.from));
  });
  if (round < kRoundsOfSteps) return;
  PruneBarred(sequence, round < kRoundsOfNodes ? Extent::kNodes : Extent::kLayers);
}

void CollisionPruner::TakeOut(size_t layer, size_t node) {
  Verdict& verdict = verdict_[layer][node];
  if (verdict == Verdict::kBlocked) return;
  double& objective = layers_[layer].objective[node];
  taken_.push_back({layer, node, objective, verdict});
  verdict = Verdict::kBlocked;
  objective = std::numeric_limits<double>::infinity();
  ++versions_[layer];
  ++nodes_pruned_;
}

void CollisionPruner::PruneBarred(const Sequence& sequence, Extent extent) {
  for (const size_t t : barred_) {
    const size_t to = (t + 1) % layers_.size();
    if (extent == Extent::kNodes) {
      TakeOut(t, sequence.nodes[t]);
      TakeOut(to, sequence.nodes[to]);
      last_problem_[to] = last_problem_[t];
    } else {
      for (size_t k = 0; k < layers_[t].size(); ++k) TakeOut(t, k);
    }
  }
}

void CollisionPruner::Reopen(const Sequence& sequence) {
  for (const Taken& taken : taken_) {
    if (sequence.nodes[taken.layer] == kNoNode) continue;
    layers_[taken.layer].objective[taken.node] = taken.objective;
    verdict_[taken.layer][taken.node] = taken.verdict;
  }
  taken_.clear();
}

}  // namespace millpose
