// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/segment_planner.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "planning/ladder/table_layer.hpp"
#include "planning/pass/lean_courses.hpp"
#include "planning/pass/ring_stripe.hpp"
#include "planning/pass/segment_search.hpp"
#include "planning/pass/unwind.hpp"

namespace millpose {
namespace {

constexpr int kRefineRounds = 5;

class SegmentPlanner {
 public:
  SegmentPlanner(const PassContext& context, bool all_revolutions)
      : context_(context),
        checks_(MakeChecks(context)),
        law_(checks_, context.scorers, context.options.max_deviation),
        all_revolutions_(all_revolutions),
        count_(context.scorers.size()),
        rule_(MakeRule(context, all_revolutions)),
        max_lean_(LeanBounds(context.problem, context.options.max_lean_change, context.points)) {
    plan_.nodes.resize(count_);
    plan_.piece.assign(count_, -1);
    plan_.interference.resize(count_);
    plan_.access.resize(count_);
  }

  std::optional<PassPlan> Plan() {
    graph_ = MakeGraph(context_, all_revolutions_);
    const Sequence sequence = SearchFree();
    TakeSequence(sequence);
    plan_.searched = {graph_, sequence, all_revolutions_, best_};
    double coarse = 0.0, refined = 0.0;
    for (const Segment& piece : plan_.pieces) {
      coarse += Cost(piece);
      RefineFree(piece);
      refined += Cost(piece);
    }
    plan_.grid_gap = refined > 0.0 ? (coarse - refined) / refined : 0.0;
    for (const Segment& piece : plan_.pieces) {
      const bool fits = Unwind(NodesOf(piece), piece.closed, context_.problem.bounds);
      assert((fits || !all_revolutions_) && "nodes of single turns lie within the bounds");
      if (!fits && !all_revolutions_) return std::nullopt;
    }
    return std::move(plan_);
  }

 private:
  Sequence SearchFree() {
    SegmentSearch search(context_, *graph_, law_, all_revolutions_);
    Sequence sequence = search.Run();
    best_ = search.IsBest(sequence);
    for (size_t t = 0; t < count_; ++t) plan_.access[t] = search.DetailAt(t);
    if (sequence.closed)
      plan_.stripe = ExplainStripe({context_, search.problem(), *graph_, sequence, search.unbarred()});
    plan_.poses_checked += graph_->counts().poses;
    plan_.pairs_checked = graph_->counts().pairs;
    plan_.pairs_saved = graph_->counts().pairs_saved;
    plan_.nodes_pruned = graph_->nodes_pruned();
    plan_.candidates_checked = graph_->nodes_checked();
    plan_.candidates = graph_->nodes();
    for (size_t t = 0; t < count_; ++t) {
      if (sequence.nodes[t] == kNoNode) plan_.interference[t] = graph_->Detail(t);
    }
    return sequence;
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
        Segment piece;
        piece.piece = static_cast<int>(plan_.pieces.size());
        piece.first = static_cast<int>(first);
        piece.last = static_cast<int>(last);
        piece.closed = sequence.closed;
        for (size_t t = first; t <= last; ++t) {
          plan_.piece[t] = piece.piece;
          plan_.nodes[t] = NodeOf(graph_->layer(t), sequence.nodes[t]);
        }
        plan_.pieces.push_back(piece);
      }
      first = last + 1;
    }
  }

  static PathNode NodeOf(const Layer& layer, size_t node) {
    return {FreedomsOf(layer, node), layer.BranchOf(node),      layer.joints.At(node),
            layer.objective[node],   bool(layer.genetic[node]), false};
  }

  std::span<PathNode> NodesOf(const Segment& piece) {
    return std::span(plan_.nodes).subspan(piece.first, piece.last - piece.first + 1);
  }

  std::span<const Joints> StepsOf(const Segment& piece) const {
    return graph_->max_step().subspan(piece.first, piece.last - piece.first + 1);
  }

  double Cost(const Segment& piece) { return PathCost(NodesOf(piece), rule_, StepsOf(piece), piece.closed); }

  /// Refines a piece. Where the finer path interferes, its points go back to the coarse one, which is free,
  /// with ever more of their neighbours (4^round − 1 to either side), and the rest is refined again.
  void RefineFree(const Segment& piece) {
    RefineOptions options;
    options.rule = rule_;
    options.max_step = StepsOf(piece);
    options.first_step = RotationStep(context_);
    if (!max_lean_.empty())
      options.max_lean = std::span<const double>(max_lean_).subspan(piece.first, options.max_step.size());
    options.last_step = DegToRad(0.002);
    options.closed = piece.closed;
    options.all_revolutions = all_revolutions_;
    options.worst_first = context_.options.worst_first;
    options.stop = context_.stop;
    const std::span<PathNode> path = NodesOf(piece);
    const std::vector<PathNode> coarse(path.begin(), path.end());
    SegmentChecker checker = MakeChecker(context_, piece);
    const EndShares ends = checker.ToLeave(coarse, piece.closed);
    std::vector<bool> frozen(path.size(), false);
    bool free = false;
    for (int round = 0; round < kRefineRounds && !free; ++round) {
      for (size_t i = 0; i < path.size(); ++i) {
        path[i] = coarse[i];
        path[i].frozen = frozen[i];
      }
      RefinePath(std::span(context_.scorers).subspan(piece.first, path.size()),
                 std::span(context_.genetic).subspan(piece.first, path.size()), options, path);
      SegmentHits hits = checker.Check(path, piece.closed, ends, frozen);
      AddBends(piece, coarse, frozen, hits);
      free = !hits.any();
      const std::vector<bool> wide = Widened(hits.Points(), (size_t{1} << (2 * round)) - 1, piece.closed);
      for (size_t i = 0; i < wide.size(); ++i) frozen[i] = frozen[i] || wide[i];
    }
    if (!free) std::copy(coarse.begin(), coarse.end(), path.begin());
    plan_.poses_checked += checker.poses_checked();
  }

  /// Adds to `hits` the motions of a refined piece that bend further than they may and did.
  void AddBends(const Segment& piece, const std::vector<PathNode>& coarse, const std::vector<bool>& frozen,
                SegmentHits& hits) {
    const std::span<const PathNode> path = NodesOf(piece);
    for (size_t i = 0; i < path.size(); ++i) {
      const size_t next = (i + 1) % path.size();
      if ((next == 0 && !piece.closed) || (frozen[i] && frozen[next])) continue;
      const double deviation = Bend(piece.first + i, path[i].q, path[next].q);
      if (deviation <= context_.options.max_deviation) continue;
      const double was = Bend(piece.first + i, coarse[i].q, coarse[next].q);
      const auto most = [&](const PathNode& node) {
        return law_.Most(kSearchedBend, piece.first + i, node.freedoms, node.branch, node.q);
      };
      hits.motion[i] |= deviation > was || (deviation > most(path[i]) && was <= most(coarse[i]));
    }
  }

  double Bend(size_t t, const Joints& from, const Joints& to) const {
    return HalfwayDeviation(checks_.CarrierFrom(t), from, millpose::NearestEquivalent(from, to)).position;
  }

  const PassContext& context_;
  PassChecks checks_;
  BendLaw law_;
  bool all_revolutions_;
  size_t count_;
  StepRule rule_;
  std::vector<double> max_lean_;  ///< LeanBounds
  std::shared_ptr<CandidateGraph> graph_;
  bool best_ = false;  ///< PassPlan::Searched
  PassPlan plan_;
};

}  // namespace

std::optional<PassPlan> PlanSegments(const PassContext& context, bool all_revolutions) {
  return SegmentPlanner(context, all_revolutions).Plan();
}

}  // namespace millpose
