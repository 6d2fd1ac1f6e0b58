// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/split_planner.hpp"

#include <atomic>

#include "base/cpu_time.hpp"
#include "base/parallel.hpp"
#include "planning/pass/lean_courses.hpp"
#include "planning/pass/lifts.hpp"
#include "planning/pass/ring_opening.hpp"

namespace millpose {
namespace {

constexpr uint64_t kLeadStreams = uint64_t{1} << 40;  // beyond those of any job's own points
constexpr double kFiner = 20;                         // of the table where the ladder's own finds nothing
constexpr int kSplitRounds = 40;                      // then what still fails stays without overlap

/// Full revolutions hardly ever matter, so first every node stands for all of its own; where the joints then
/// wind out of their limits, each turn becomes a node.
PassPlan PlanTurned(const PassContext& context) {
  std::optional<PassPlan> plan = PlanSegments(context, false);
  if (!plan) plan = PlanSegments(context, true);
  return std::move(*plan);
}

class SplitPlanner {
 public:
  SplitPlanner(const Pass& pass, std::shared_ptr<const SplitPoints> own, size_t first_point)
      : pass_(pass),
        own_(std::move(own)),
        first_point_(first_point),
        opened_(IsOpenedRing(pass)),
        ends_(opened_ ? RingEnds(own_->context->options.ends) : own_->context->options.ends) {
    const PathOptions& options = own_->context->options;
    choices_ = OverlapChoices(options.overlap);
    ring_choices_ = RingChoices(opened_ ? std::max(options.overlap, options.ends.overrun) : options.overlap);
  }

  SplitPass Plan() {
    SplitPass planned{own_, {}, {}, {}, 0};
    if (opened_) {
      splits_.push_back({{pass_.points.size() - 1, ring_choices_[0]}, 0, Tried::Why::kRing});
      planned.points = Points();
    }
    planned.plan = PlanTurned(*planned.points->context);
    PlanSplits(planned);
    TryLifts(planned);
    // Once: what is tried and given up stays rough.
    LookBack(*planned.points->context, planned.plan);
    SmoothSegments(*planned.points->context, planned.plan);
    const std::vector<SplitPoint>& points = planned.points->points;
    for (const Tried& tried : splits_) {
      if (tried.split.overlap.by != OverlapChoice::By::kNone) continue;
      for (size_t i = 0; i < points.size(); ++i) {
        if (points[i].source == tried.split.after && points[i].added_by < 0)
          planned.uncut.push_back(static_cast<int>(i));
      }
    }
    NoteLifts(planned);
    return planned;
  }

 private:
  struct Tried {
    enum class Why : uint8_t { kNeeded, kRing, kLift };
    Split split;
    size_t choice = 0;
    Why why = Why::kNeeded;
  };

  /// Plans again with the splits known, and with what that shows, until nothing changes.
  void PlanSplits(SplitPass& planned) {
    for (int round = 0; Revise(planned, round); ++round) PlanAgain(planned);
  }

  void PlanAgain(SplitPass& planned) const {
    const long long poses = planned.plan.poses_checked;
    planned.points = Points();
    planned.plan = PlanTurned(*planned.points->context);
    planned.plan.poses_checked += poses;
  }

  /// Lifts that pay become splits. They are given up again where the plan with them does not show the gain.
  void TryLifts(SplitPass& planned) {
    const PathOptions& options = own_->context->options;
    const LiftPrice price = options.Price();
    // Where external axes move, what a lift gains is not looked at.
    if (price.most == 0 || (pass_.closed && !opened_) || own_->context->along) return;
    const FoundLifts found = FindLifts(*planned.points->context, planned.points->points, price);
    planned.plan.poses_checked += found.poses_checked;
    if (found.before.empty()) return;
    SplitPass lifted = planned;
    const std::vector<Tried> before = splits_;
    for (const size_t t : found.before)
      splits_.push_back({{planned.points->points[t - 1].source, ring_choices_[0]}, 0, Tried::Why::kLift});
    SortSplits();
    PlanAgain(lifted);
    PlanSplits(lifted);
    const SequenceValue without = OwnValue(planned), with = OwnValue(lifted);
    const auto lifts = static_cast<size_t>(std::ranges::count(splits_, Tried::Why::kLift, &Tried::why));
    std::vector<SequenceValue> values(lifts, without);
    values.push_back(with);
    planned.plan.poses_checked = lifted.plan.poses_checked;
    const bool holds = lifts > 0 && splits_.size() == before.size() + lifts &&
                       CountSkipped(lifted) <= CountSkipped(planned) && WorthLifting(values, price) == lifts;
    if (!holds) {
      splits_ = before;
      return;
    }
    planned = std::move(lifted);
    const bool by_worst = price.worst_first && with.worst < without.worst * (1 - price.gain);
    planned.lift_gain = by_worst ? 1 - with.worst / without.worst : 1 - with.cost / without.cost;
  }

  /// Worst value and sum over the pass's own points.
  static SequenceValue OwnValue(const SplitPass& planned) {
    SequenceValue value;
    for (size_t i = 0; i < planned.points->points.size(); ++i) {
      if (planned.plan.piece[i] < 0 || planned.points->points[i].added_by >= 0) continue;
      value.worst = std::max(value.worst, planned.plan.nodes[i].objective);
      value.cost += planned.plan.nodes[i].objective;
    }
    return value;
  }

  static size_t CountSkipped(const SplitPass& planned) {
    size_t skipped = 0;
    for (size_t i = 0; i < planned.points->points.size(); ++i)
      skipped += planned.plan.piece[i] < 0 && planned.points->points[i].added_by < 0;
    return skipped;
  }

  /// The pieces that begin where a split was made because it pays.
  void NoteLifts(SplitPass& planned) const {
    const std::vector<SplitPoint>& points = planned.points->points;
    for (const Tried& tried : splits_) {
      if (tried.why != Tried::Why::kLift) continue;
      for (size_t i = 0; i < points.size(); ++i)
        if (points[i].source == tried.split.after && points[i].added_by < 0 && planned.plan.piece[i] >= 0)
          planned.lifts.push_back(planned.plan.piece[i] + 1);
    }
  }

  const std::vector<OverlapChoice>& ChoicesOf(const Tried& tried) const {
    return tried.why == Tried::Why::kNeeded ? choices_ : ring_choices_;
  }

  void SortSplits() {
    std::ranges::sort(splits_, {}, [](const Tried& tried) { return tried.split.after; });
  }

  /// What a plan says about the splits, and where new ones are.
  struct Findings {
    std::vector<bool> failed, cut;  ///< of each split
    std::vector<size_t> found;      ///< points after which the pass is split where no split is known
  };

  /// Notes new splits, and the next choice for those that failed. True when there is something to plan again.
  bool Revise(const SplitPass& planned, int round) {
    const std::vector<SplitPoint>& points = planned.points->points;
    const std::vector<int>& piece = planned.plan.piece;
    Findings findings{std::vector<bool>(splits_.size()), std::vector<bool>(splits_.size()), {}};
    auto& [failed, cut, found] = findings;
    for (size_t i = 0; i < points.size(); ++i) {
      if (points[i].added_by >= 0 && piece[i] < 0) failed[points[i].added_by] = true;
      if (i + 1 < points.size()) {
        Look(planned, i, findings);
      } else if (pass_.closed && splits_.empty() && piece[i] >= 0 && piece[0] >= 0) {
        if (planned.plan.pieces.empty() || !planned.plan.pieces.front().closed) found.push_back(i);
      }
    }
    bool changed = !found.empty();
    for (size_t k = 0; k < splits_.size(); ++k) {
      Tried& tried = splits_[k];
      if (tried.split.overlap.by == OverlapChoice::By::kNone || (cut[k] && !failed[k])) continue;
      const std::vector<OverlapChoice>& choices = ChoicesOf(tried);
      tried.choice = round < kSplitRounds ? tried.choice + 1 : choices.size() - 1;
      tried.split.overlap = choices[tried.choice];
      changed = true;
    }
    // A lift that leaves a step uncut pays nothing.
    std::erase_if(splits_, [](const Tried& tried) {
      return tried.why == Tried::Why::kLift && tried.split.overlap.by == OverlapChoice::By::kNone;
    });
    for (const size_t after : found) {
      const size_t choice = Joinable(after) ? 0 : choices_.size() - 1;
      splits_.push_back({{after, choices_[choice]}, choice});
    }
    SortSplits();
    return changed;
  }

  /// Whether any poses of a point and its next are a step apart: across a crease there are none, and every
  /// overlap would be tried in vain.
  bool Joinable(size_t after) const {
    const PassContext& context = *own_->context;
    const auto layer = [&](size_t t) {
      const CandidateTable& table = *context.tables[t];
      const std::array nominal{NominalSetting(context.problem, table)};
      return MakeLayer(context.scorers[t], SeedsOf(table, nominal), false);
    };
    const auto point = [&](size_t t) {
      return context.along ? OnPart((*context.along)[t], context.points[t]) : context.points[t];
    };
    const size_t next = (after + 1) % context.scorers.size();
    const Layer from = layer(after), to = layer(next);
    const StepRule rule{StepBound(context.options.steps, context.problem.arm, point(after), point(next)), 0,
                        true};
    const std::vector<double> none(from.size(), 0.0);
    const CostRow row(none);
    for (size_t node = 0; node < to.size(); ++node) {
      const auto branch = static_cast<size_t>(to.LaneOf(node));
      BestPredecessor by;
      RelaxFrom(rule, from.joints, row, from.lane_begin[branch], from.lane_begin[branch + 1],
                to.joints.At(node), std::numeric_limits<double>::infinity(), by);
      if (std::isfinite(by.cost)) return true;
    }
    return false;
  }

  /// What a point and its next say about the splits: whether they cut the step of one, or are apart where no
  /// split is known.
  void Look(const SplitPass& planned, size_t i, Findings& findings) const {
    auto& [failed, cut, found] = findings;
    const SplitPoint &a = planned.points->points[i], &b = planned.points->points[i + 1];
    const int piece_a = planned.plan.piece[i], piece_b = planned.plan.piece[i + 1];
    if (piece_a < 0 || piece_b < 0) return;
    if (piece_a == piece_b) {
      for (size_t k = 0; k < splits_.size(); ++k) {
        const size_t after = splits_[k].split.after;
        cut[k] = cut[k] || (a.source == after && b.source == (after + 1) % pass_.points.size());
      }
    } else if (!b.break_before) {
      if (a.added_by >= 0) failed[a.added_by] = true;
      if (b.added_by >= 0) failed[b.added_by] = true;
      if (a.added_by < 0 && b.added_by < 0) found.push_back(a.source);
    }
  }

  std::shared_ptr<const SplitPoints> Points() const {
    const PassContext& from = *own_->context;
    std::vector<Split> splits;
    for (const Tried& tried : splits_) splits.push_back(tried.split);
    auto made = std::make_shared<SplitPoints>();
    made->points = WithOverlaps(pass_, splits, ends_, from.options.lead_spacing);
    if (opened_ && splits.back().overlap.by != OverlapChoice::By::kNone)
      AddRingLeads(ends_, from.options.lead_spacing, static_cast<int>(splits.size()) - 1, made->points);
    for (const SplitPoint& point : made->points) made->milling.push_back(point.point);
    made->context = std::make_unique<PassContext>(PassContext{
        from.problem, from.world, from.options, made->milling, false, from.threads, from.stop, from.memory});
    PassContext& context = *made->context;
    context.motion_weight = from.motion_weight;
    if (from.along) {
      std::vector<size_t> sources;
      for (const SplitPoint& point : made->points) sources.push_back(point.source);
      context.along = std::make_shared<const std::vector<PlaceAlong>>(Selected(*from.along, sources));
    }
    std::vector<size_t> leads;
    for (size_t i = 0; i < made->points.size(); ++i) {
      const SplitPoint& point = made->points[i];
      const bool own = point.point.position == pass_.points[point.source].position;
      if (!own) leads.push_back(i);
      context.scorers.push_back(
          own ? from.scorers[point.source]
              : PointScorer(context.ProblemAt(i), point.point, pass_.rotation_reference));
      context.genetic.push_back(own ? from.genetic[point.source] : PointOptimum{});
      context.tables.push_back(own ? from.tables[point.source] : nullptr);
      // Of a point that is cut twice only one may have the pass's own.
      context.verdicts.push_back(point.added_by < 0 ? from.verdicts[point.source]
                                                    : std::make_shared<PointVerdicts>());
      context.optima.push_back(own ? from.optima[point.source] : PointOptimum{});
      context.break_before.push_back(point.break_before);
      if (from.options.paper) context.paper.push_back(own ? from.paper[point.source] : PaperResult{});
    }
    FindOptima(leads, kLeadStreams + (first_point_ << 10), context);
    return made;
  }

  const Pass& pass_;
  std::shared_ptr<const SplitPoints> own_;
  size_t first_point_;
  bool opened_;    ///< a ring left open
  PassEnds ends_;  ///< of the parts
  std::vector<OverlapChoice> choices_, ring_choices_;
  std::vector<Tried> splits_;
};

}  // namespace

SplitPass PlanSplit(const Pass& pass, std::shared_ptr<const SplitPoints> own, size_t first_point) {
  return SplitPlanner(pass, std::move(own), first_point).Plan();
}

void FindOptima(std::span<const size_t> points, uint64_t stream, PassContext& context) {
  const PathOptions& options = context.options;
  if (options.paper) context.paper.resize(context.scorers.size());
  std::atomic<size_t> entries = 0;
  ParallelFor(points.size(), context.threads, context.stop, [&](size_t i) {
    const CpuTimer timer(CpuPart::kOptima);
    const size_t t = points[i];
    if (context.points[t].gouge > 0) return;  // not to be milled
    const PointScorer& scorer = context.scorers[t];
    const PoseProblem& problem = scorer.problem();
    const RandomStream own(options.seed, stream + i);
    context.tables[t] =
        std::make_shared<const CandidateTable>(CandidateTable::OfStep(scorer, RotationStep(context)));
    entries += context.tables[t]->entries().size();
    CheckMemory(context, static_cast<double>(entries) * sizeof(CandidateTable::Entry));
    context.optima[t] = problem.freedoms.size() == 1 ? RefineTable(scorer, *context.tables[t])
                                                     : DescendTable(scorer, *context.tables[t]);
    // Intervals narrower than the grid.
    if (!context.optima[t].found)
      context.optima[t] = ExhaustiveSearch(scorer, options.rotation_step / kFiner);
    if (!options.paper) {
      context.genetic[t] = GeneticSearch(scorer, problem, options.genetic, own);
      DescendInLeans(context, t);
      return;
    }
    context.paper[t] = PaperSearch(problem, MakePaperTarget(problem, context.points[t]), *options.paper, own);
    context.genetic[t] = OnExactPose(scorer, context.paper[t]);
  });
}

}  // namespace millpose
