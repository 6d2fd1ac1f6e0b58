// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/piece_planner.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "path/end_guard.hpp"
#include "path/free_smoothing.hpp"
#include "path/ladder_bound.hpp"
#include "path/layer_verdicts.hpp"
#include "path/ring_stripe.hpp"
#include "path/worst_then_sum.hpp"
#include "robot/angles.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kRounding = 1e-12;  // rad: of angles that full revolutions were added to
constexpr int kRefineRounds = 5;

PieceChecker MakeChecker(const PassContext& context, const Carrier& carrier) {
  return {context.world,         carrier,         context.options.swept_resolution,
          context.options.leave, context.threads, context.stop};
}

class PiecePlanner {
 public:
  PiecePlanner(const PassContext& context, bool all_revolutions)
      : context_(context),
        carrier_{context.problem.arm, context.problem.X_WB, context.problem.X_FT},
        law_(carrier_, context.scorers, context.options.max_deviation),
        checker_(MakeChecker(context, carrier_)),
        all_revolutions_(all_revolutions),
        count_(context.scorers.size()),
        rule_(MakeRule(context, all_revolutions)) {
    plan_.nodes.resize(count_);
    plan_.piece.assign(count_, -1);
    plan_.interference.resize(count_);
    plan_.access.resize(count_);
  }

  std::optional<PassPlan> Plan() {
    layers_ = MakeLayers(context_, all_revolutions_);
    TakeSequence(SearchFree());
    double coarse = 0.0, refined = 0.0;
    for (const Piece& piece : plan_.pieces) {
      coarse += Cost(piece);
      RefineFree(piece);
      refined += Cost(piece);
    }
    plan_.grid_gap = refined > 0.0 ? (coarse - refined) / refined : 0.0;
    for (const Piece& piece : plan_.pieces) {
      const bool fits = Unwind(piece);
      assert((fits || !all_revolutions_) && "nodes of single turns lie within the bounds");
      if (!fits && !all_revolutions_) return std::nullopt;
    }
    plan_.poses_checked += checker_.poses_checked();
    return std::move(plan_);
  }

 private:
  /// The ladder search, repeated until what it finds is free of interference.
  Sequence SearchFree() {
    const bool rotates_first = context_.problem.freedoms[0]->IsToolRotation();
    CollisionPruner pruner(context_.world, carrier_, context_.scorers, layers_,
                           context_.options.swept_resolution, rotates_first, MakeLimits(context_),
                           context_.threads, context_.stop);
    std::optional<EndGuard> guard;
    if (context_.options.leave)
      guard.emplace(context_.world, carrier_, *context_.options.leave, layers_, context_.break_before, pruner,
                    context_.threads, context_.stop);
    SweepMemory memory, join_memory;
    LadderProblem problem = MakeProblem(context_, layers_, pruner, all_revolutions_);
    problem.memory = &memory;
    // While there is interference to find, any good closed sequence finds it. A free one is kept when the
    // best of all is hardly cheaper.
    constexpr int kQuickSweeps = 3;
    constexpr double kHardlyCheaper = 1e-3;
    const bool worst_first = context_.options.worst_first;
    WorstThenSum open_worst, closed_worst;
    const auto joins = [&](const Sequence& as) {
      LadderProblem joined = problem;
      joined.memory = &join_memory;
      if (as.closed) return SearchClosed(joined, kQuickSweeps).has_value();
      return Breaks(SearchOpen(joined)) <= Breaks(as);
    };
    const auto search_closed = [&](int sweeps) {
      return pruner.Straight(
          [&] { return worst_first ? closed_worst.Closed(problem, sweeps) : SearchClosed(problem, sweeps); },
          joins);
    };
    const auto search_open = [&] {
      return *pruner.Straight(
          [&] { return std::optional(worst_first ? open_worst.Open(problem) : SearchOpen(problem)); }, joins);
    };
    constexpr int kAllSweeps = std::numeric_limits<int>::max();
    Sequence sequence;
    double unbarred = std::numeric_limits<double>::infinity();  // a closed ring's cost without interference
    for (int round = 0;; ++round) {
      std::optional<Sequence> closed;
      if (context_.closed) closed = search_closed(kQuickSweeps);
      if (context_.closed && !closed) closed = search_closed(kAllSweeps);
      if (closed && round == 0) unbarred = closed->cost;
      sequence = closed ? std::move(*closed) : search_open();
      bool free = pruner.Check(sequence);
      if (free && sequence.closed) {
        std::optional<Sequence> best = search_closed(kAllSweeps);
        if (best && best->cost < (1 - kHardlyCheaper) * sequence.cost) {
          sequence = std::move(*best);
          free = pruner.Check(sequence);
        }
      }
      if (free && (!guard || guard->Check(sequence))) break;
      pruner.PruneInRound(sequence, round);
    }
    if (guard) {
      plan_.poses_checked += guard->counts().poses;
      for (size_t t = 0; t < count_; ++t) plan_.access[t] = guard->Detail(t);
    }
    if (sequence.closed) plan_.stripe = ExplainStripe({context_, problem, pruner, sequence, unbarred});
    plan_.poses_checked += pruner.counts().poses;
    plan_.pairs_checked = pruner.counts().pairs;
    plan_.pairs_saved = pruner.counts().pairs_saved;
    plan_.nodes_pruned = pruner.nodes_pruned();
    plan_.candidates_checked = pruner.nodes_checked();
    for (const Layer& layer : layers_) plan_.candidates += static_cast<long long>(layer.size());
    for (size_t t = 0; t < count_; ++t) {
      if (sequence.nodes[t] == kNoNode) plan_.interference[t] = pruner.Detail(t);
    }
    LookBack(problem, sequence, pruner);
    max_step_.assign(pruner.max_step().begin(), pruner.max_step().end());
    return sequence;
  }

  /// What the reports tell of the layers once the plan stands (price.hpp).
  void LookBack(const LadderProblem& problem, const Sequence& sequence, CollisionPruner& pruner) {
    pruner.Reopen(sequence);
    const long long before = pruner.counts().poses;
    plan_.free = FindFreeOptima(context_.optima, layers_, sequence, pruner);
    plan_.poses_checked += pruner.counts().poses - before;
    plan_.bound = BoundLadder(problem, sequence, context_.options.worst_first);
    if (!context_.problem.freedoms[0]->IsToolRotation()) return;
    for (size_t t = 0; t < count_; ++t)
      plan_.verdicts.push_back(PackVerdicts(LayerVerdicts(layers_[t], t, pruner)));
  }

  /// Cuts the sequence into pieces. A piece of one point is no cut; only a pass of one point keeps it.
  void TakeSequence(const Sequence& sequence) {
    for (size_t first = 0; first < count_;) {
      if (sequence.nodes[first] == kNoNode) {
        ++first;
        continue;
      }
      size_t last = first;
      while (last + 1 < count_ && sequence.nodes[last + 1] != kNoNode && !sequence.break_before[last + 1])
        ++last;
      if (last > first || count_ == 1) {
        Piece piece;
        piece.piece = static_cast<int>(plan_.pieces.size());
        piece.first = static_cast<int>(first);
        piece.last = static_cast<int>(last);
        piece.closed = sequence.closed;
        for (size_t t = first; t <= last; ++t) {
          plan_.piece[t] = piece.piece;
          plan_.nodes[t] = NodeOf(layers_[t], sequence.nodes[t]);
        }
        plan_.pieces.push_back(piece);
      }
      first = last + 1;
    }
  }

  static PathNode NodeOf(const Layer& layer, size_t node) {
    return {layer.freedoms[node],  layer.BranchOf(node),      layer.joints.At(node),
            layer.objective[node], bool(layer.genetic[node]), false};
  }

  std::span<PathNode> NodesOf(const Piece& piece) {
    return std::span(plan_.nodes).subspan(piece.first, piece.last - piece.first + 1);
  }

  std::span<const Joints> StepsOf(const Piece& piece) const {
    return std::span(max_step_).subspan(piece.first, piece.last - piece.first + 1);
  }

  double Cost(const Piece& piece) { return PathCost(NodesOf(piece), rule_, StepsOf(piece), piece.closed); }

  /// Refines a piece. Where the finer path interferes, its points go back to the coarse one, which is free,
  /// with ever more of their neighbours, and the rest is refined again.
  void RefineFree(const Piece& piece) {
    RefineOptions options;
    options.rule = rule_;
    options.max_step = StepsOf(piece);
    options.first_step = context_.options.rotation_step;
    options.last_step = DegToRad(0.002);
    options.closed = piece.closed;
    options.all_revolutions = all_revolutions_;
    options.worst_first = context_.options.worst_first;
    options.stop = context_.stop;
    const std::span<PathNode> path = NodesOf(piece);
    const std::vector<PathNode> coarse(path.begin(), path.end());
    const EndShares ends = checker_.ToLeave(coarse, piece.closed);
    std::vector<bool> frozen(path.size(), false);
    for (int round = 0; round < kRefineRounds; ++round) {
      for (size_t i = 0; i < path.size(); ++i) {
        path[i] = coarse[i];
        path[i].frozen = frozen[i];
      }
      RefinePath(std::span(context_.scorers).subspan(piece.first, path.size()),
                 std::span(context_.genetic).subspan(piece.first, path.size()), options, path);
      if (FreezeWhatFails(piece, coarse, ends, round, frozen)) return;
    }
    std::copy(coarse.begin(), coarse.end(), path.begin());
  }

  /// Checks the nodes of a refined piece and the motions between them, which may bend no further than they
  /// may or did; marks the points that must go back, with 4^round − 1 neighbours to either side. True when
  /// there are none.
  bool FreezeWhatFails(const Piece& piece, const std::vector<PathNode>& coarse, const EndShares& ends,
                       int round, std::vector<bool>& frozen) {
    const std::span<const PathNode> path = NodesOf(piece);
    PieceHits hits = checker_.Check(path, piece.closed, ends, frozen);
    for (size_t i = 0; i < path.size(); ++i) {
      const size_t next = (i + 1) % path.size();
      if ((next == 0 && !piece.closed) || (frozen[i] && frozen[next])) continue;
      const double deviation = Bend(path[i].q, path[next].q);
      if (deviation <= context_.options.max_deviation) continue;
      const double was = Bend(coarse[i].q, coarse[next].q);
      const auto most = [&](const PathNode& node) {
        return law_.Most(kSearchedBend, piece.first + i, node.freedoms, node.branch, node.q);
      };
      hits.motion[i] |= deviation > was || (deviation > most(path[i]) && was <= most(coarse[i]));
    }
    const std::vector<bool> wide = Widened(hits.Points(), (size_t{1} << (2 * round)) - 1, piece.closed);
    for (size_t i = 0; i < wide.size(); ++i) frozen[i] = frozen[i] || wide[i];
    return !hits.any();
  }

  double Bend(const Joints& from, const Joints& to) const {
    return HalfwayDeviation(carrier_, from, millpose::NearestEquivalent(from, to)).position;
  }

  /// Makes the joints of a piece continuous and moves each by as few full revolutions as bring all of the
  /// piece within the bounds. False when no number of turns does.
  bool Unwind(const Piece& piece) {
    const std::span<PathNode> path = NodesOf(piece);
    for (size_t i = 1; i < path.size(); ++i) path[i].q = NearestEquivalent(path[i - 1].q, path[i].q);
    const auto [least, most] = Extent(piece);
    const AdmissibleBounds& bounds = context_.problem.bounds;
    for (int j = 0; j < 6; ++j) {
      bool fits = false;
      for (const int turns : {0, -1, 1, -2, 2}) {
        const double shift = turns * kTurn;
        if (least[j] + shift < bounds.lower[j] - kRounding || most[j] + shift > bounds.upper[j] + kRounding) {
          continue;
        }
        for (PathNode& node : path) node.q[j] += shift;
        fits = true;
        break;
      }
      if (!fits) return false;
    }
    return true;
  }

  /// Least and largest angles along a piece whose joints are continuous.
  std::pair<Joints, Joints> Extent(const Piece& piece) {
    const std::span<const PathNode> path = NodesOf(piece);
    Joints least = path[0].q, most = path[0].q;
    for (const PathNode& node : path) {
      least = least.cwiseMin(node.q);
      most = most.cwiseMax(node.q);
    }
    if (piece.closed) {  // back to the first point, by whatever turns the way round has made
      const Joints end = NearestEquivalent(path.back().q, path[0].q);
      least = least.cwiseMin(end);
      most = most.cwiseMax(end);
    }
    return {least, most};
  }

  const PassContext& context_;
  Carrier carrier_;
  BendLaw law_;
  PieceChecker checker_;
  bool all_revolutions_;
  size_t count_;
  StepRule rule_;
  std::vector<Layer> layers_;
  std::vector<Joints> max_step_;  ///< as the search has come to bound the steps
  PassPlan plan_;
};

/// Whether a value is better than all of a table.
bool IsBeyond(double objective, const CandidateTable* table) {
  return !table || std::all_of(table->entries().begin(), table->entries().end(),
                               [&](const auto& entry) { return objective < entry.objective; });
}

}  // namespace

StepRule MakeRule(const PassContext& context, bool all_revolutions) {
  StepRule rule;
  rule.motion_weight = context.motion_weight;
  rule.modulo_revolutions = !all_revolutions;
  return rule;
}

StepLimits MakeLimits(const PassContext& context) {
  return {StepBoundsAlong(context.options.steps, context.problem.arm, context.points),
          context.options.max_deviation};
}

std::vector<Layer> MakeLayers(const PassContext& context, bool all_revolutions) {
  std::vector<Layer> layers(context.scorers.size());
  ParallelFor(layers.size(), context.threads, context.stop, [&](size_t t) {
    const PointScorer& scorer = context.scorers[t];
    std::vector<NodeSeed> seeds;
    if (context.tables[t]) seeds = SeedsOf(*context.tables[t]);
    const auto add = [&](const PointOptimum& optimum, bool genetic) {
      if (!optimum.found) return;
      seeds.push_back(
          {optimum.freedoms, scorer.ScoreOne(optimum.freedoms, optimum.branch), optimum.branch, genetic});
    };
    const PointOptimum& genetic = context.genetic[t];
    add(genetic, genetic.found && IsBeyond(genetic.objective, context.tables[t].get()));
    // Intervals narrower than the grid: better the finer table's answer than a skipped point.
    if (seeds.empty()) add(context.optima[t], false);
    layers[t] = MakeLayer(scorer, std::move(seeds), all_revolutions);
  });
  return layers;
}

LadderProblem MakeProblem(const PassContext& context, std::span<const Layer> layers,
                          const CollisionPruner& pruner, bool all_revolutions) {
  // The band needs the one freedom to be the rotation (BandWidth).
  const auto& freedoms = context.problem.freedoms;
  const bool banded = freedoms.size() == 1 && freedoms[0]->IsToolRotation();
  return {.layers = layers,
          .rule = MakeRule(context, all_revolutions),
          .blocked = pruner.blocked_edges(),
          .banded = banded,
          .walls = banded,
          .stop = context.stop,
          .break_before = context.break_before,
          .versions = pruner.versions(),
          .max_step = pruner.max_step()};
}

double MotionWeight(double share, std::span<const PointOptimum> optima) {
  std::vector<double> values;
  for (const PointOptimum& optimum : optima)
    if (optimum.found && optimum.objective > 0) values.push_back(optimum.objective);
  if (values.empty()) return share;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return share * *middle;
}

std::optional<PassPlan> PlanPieces(const PassContext& context, bool all_revolutions) {
  return PiecePlanner(context, all_revolutions).Plan();
}

void SmoothPieces(const PassContext& context, PassPlan& plan) {
  const Carrier carrier{context.problem.arm, context.problem.X_WB, context.problem.X_FT};
  PieceChecker checker = MakeChecker(context, carrier);
  plan.unsmoothed = plan.nodes;
  for (const Piece& piece : plan.pieces) {
    const auto first = static_cast<size_t>(piece.first), count = static_cast<size_t>(piece.last) - first + 1;
    SmoothOptions options;
    options.loss = context.options.smoothing_loss;
    options.max_step =
        StepBoundsAlong(context.options.steps, context.problem.arm, context.points.subspan(first, count));
    options.max_deviation = context.options.max_deviation;
    options.keep_worst = context.options.worst_first;
    options.closed = piece.closed;
    options.stop = context.stop;
    SmoothFree(std::span(context.scorers).subspan(first, count), context.points.subspan(first, count),
               std::move(options), checker, std::span(plan.nodes).subspan(first, count));
  }
  plan.poses_checked += checker.poses_checked();
}

}  // namespace millpose
