// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/lifts.hpp"

#include <functional>

#include "base/trig.hpp"
#include "base/units.hpp"
#include "planning/ladder/worst_then_sum.hpp"
#include "planning/pass/collision_pruner.hpp"
#include "planning/pass/ring_opening.hpp"

namespace millpose {
namespace {

/// The graph of a pass, and searches until what they find in it is free.
class FreeSearch {
 public:
  using Search = std::function<std::optional<Sequence>(const LadderProblem&)>;

  explicit FreeSearch(const PassContext& context)
      : context_(context),
        graph_(MakeGraph(context, false)),
        law_(graph_->checks(), context.scorers, context.options.max_deviation),
        pruner_(*graph_, law_) {}

  LadderProblem Problem() const { return MakeProblem(context_, *graph_, false); }

  /// What `search` finds when all that interferes on its answers is pruned; empty when it finds nothing.
  std::optional<Sequence> Free(const Search& search) {
    const LadderProblem problem = Problem();
    for (;; ++round_) {
      std::optional<Sequence> sequence = pruner_.Straight([&] { return search(problem); });
      if (!sequence || IsFree(*sequence)) return sequence;
    }
  }

  /// Prunes what interferes.
  bool IsFree(const Sequence& sequence) {
    bool free = pruner_.Check(sequence);
    if (!free) pruner_.PruneInRound(sequence, round_);
    for (const Sequence& tail : sequence.tails) {
      const bool tail_free = pruner_.Check(tail);
      if (!tail_free) pruner_.PruneInRound(tail, round_);
      free = free && tail_free;
    }
    return free;
  }

  SequenceValue Value(const Sequence& sequence) const { return {WorstOf(layers(), sequence), sequence.cost}; }
  std::span<const Layer> layers() const { return graph_->layers(); }
  long long poses_checked() const { return graph_->counts().poses; }

 private:
  const PassContext& context_;
  std::shared_ptr<CandidateGraph> graph_;
  BendLaw law_;
  CollisionPruner pruner_;
  int round_ = 0;
};

/// Before which points the tool may be lifted.
std::vector<char> PossibleLifts(const PassContext& context, std::span<const SplitPoint> points) {
  const size_t count = points.size();
  std::vector<char> joined(count + 1, 0), may(count, 0);  // joined[t]: t−1 and t, both of the pass itself
  for (size_t t = 1; t < count; ++t)
    joined[t] = !points[t].break_before && points[t].added_by < 0 && points[t - 1].added_by < 0 &&
                !(context.points[t].gouge > 0) && !(context.points[t - 1].gouge > 0);
  for (size_t t = 2; t + 1 < count; ++t) may[t] = joined[t - 1] && joined[t] && joined[t + 1];
  return may;
}

/// How far leads reach along the pass, mm.
double Reach(const PassEnds& ends) {
  if (ends.lead == LeadShape::kArc) return ends.lead_length;
  return ends.lead == LeadShape::kRamp ? ends.lead_length * SinCos(ends.ramp_angle).cos : 0;
}

/// How many points an end runs on over for `length` mm; at least one.
size_t PointsOver(std::span<const MillingPoint> points, double length) {
  const size_t count = points.size();
  const double way = points[count - 1].arc_length - points[0].arc_length;
  const double spacing = way / static_cast<double>(count - 1);
  const double wanted = spacing > 0 ? std::ceil(length / spacing - 1e-9) : 1.0;
  return static_cast<size_t>(std::clamp(wanted, 1.0, std::max(1.0, static_cast<double>(count) / 4)));
}

size_t AfterAGap(std::span<const Layer> layers) {
  for (size_t t = 0; t < layers.size(); ++t)
    if (layers[t].usable() && !layers[(t + layers.size() - 1) % layers.size()].usable()) return t;
  return 0;
}

}  // namespace

bool IsPlainPlace(const MillingPoint& a, const MillingPoint& b) {
  const double edge = SinCos(DegToRad(10)).cos;
  const auto in_air = [](const MillingPoint& p) {
    return p.engagement.side == CutSide::kAir && p.engagement.depth > 0;
  };
  return a.region != b.region || a.normal.dot(b.normal) < edge || in_air(a) || in_air(b);
}

FoundLifts FindLifts(const PassContext& context, std::span<const SplitPoint> points, const LiftPrice& price) {
  const std::vector<char> may = PossibleLifts(context, points);
  std::vector<char> plain = may;
  for (size_t t = 1; t < plain.size(); ++t)
    plain[t] = plain[t] && IsPlainPlace(context.points[t - 1], context.points[t]);
  const auto none = [](const std::vector<char>& places) { return std::ranges::count(places, 1) == 0; };
  FoundLifts found;
  if (none(may)) return found;
  FreeSearch free(context);
  const size_t over = PointsOver(context.points, context.options.overlap + Reach(context.options.ends));
  LiftedSearch everywhere(price, over);
  const Sequence best =
      *free.Free([&](const LadderProblem& problem) { return everywhere.Open(problem, may); });
  const auto lifts_of = [&](const Sequence& sequence) {
    std::vector<size_t> lifts = LiftsOf(sequence);
    std::erase_if(lifts, [&](size_t t) { return !may[t] || points[t].break_before; });
    return lifts;
  };
  found.before = lifts_of(best);
  if (!found.before.empty() && !none(plain)) {
    LiftedSearch at_plain(price, over), without({0, 0, price.worst_first});
    const Sequence shown_least =
        *free.Free([&](const LadderProblem& problem) { return at_plain.Open(problem, plain); });
    const auto value = [&](const Sequence& sequence) {
      const SequenceValue of = free.Value(sequence);
      return price.worst_first ? of.worst : of.cost;
    };
    const double unlifted = value(without.Open(free.Problem()));
    const std::vector<size_t> lifts = lifts_of(shown_least);
    if (!lifts.empty() && unlifted - value(shown_least) >= 0.9 * (unlifted - value(best)))
      found.before = lifts;
  }
  found.poses_checked = free.poses_checked();
  return found;
}

FoundLifts FindRingStart(const PassContext& context, const LiftPrice& price) {
  // While there is interference to find, any good sequence finds it. A free one is kept when the best of all
  // is hardly cheaper.
  constexpr int kQuickSweeps = 4;
  constexpr double kHardlyCheaper = 1e-3;
  FreeSearch free(context);
  // Both ends must be free where they and their leads lie over each other. The first lead reaches back.
  const PassEnds ends = RingEnds(context.options.ends);
  const double length = std::max(context.options.overlap, ends.overrun);
  LiftedSearch search(price, PointsOver(context.points, length + 2 * Reach(ends)));
  const size_t back = Reach(ends) > 0 ? PointsOver(context.points, Reach(ends)) : 0;
  const auto quick = [&](const LadderProblem& problem) {
    std::optional<Sequence> found = search.Round(problem, kQuickSweeps);
    return found ? found : search.Round(problem);
  };
  std::optional<Sequence> best = free.Free(quick);
  if (best) {
    std::optional<Sequence> all = search.Round(free.Problem());
    const auto notably_better = [&](const SequenceValue& a, const SequenceValue& b) {
      if (price.worst_first && a.worst < (1 - kHardlyCheaper) * b.worst) return true;
      return a.cost < (1 - kHardlyCheaper) * b.cost && (!price.worst_first || a.worst <= b.worst);
    };
    if (all && notably_better(free.Value(*all), free.Value(*best)))
      best = free.Free([&](const LadderProblem& problem) { return search.Round(problem); });
  }
  FoundLifts found;
  const std::vector<size_t> lifts = best ? LiftsOf(*best) : std::vector<size_t>();
  found.before = {lifts.empty() ? AfterAGap(free.layers()) : (lifts.front() + back) % context.points.size()};
  found.poses_checked = free.poses_checked();
  return found;
}

}  // namespace millpose
