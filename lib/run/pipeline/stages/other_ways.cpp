// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/other_ways.hpp"

#include "base/counted.hpp"
#include "job/assemble.hpp"
#include "planning/pass/nominal_plan.hpp"
#include "run/pipeline/stages/promising_reversals.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

class BestWays {
 public:
  BestWays(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
           const Execution& execution)
      : prepared_(prepared),
        laid_(prepared.toolpath),
        free_(FreeDirections(inputs.job) && prepared.problem.objective->DependsOnFeed()),
        options_(MakePathOptions(inputs.job)),
        checkpoints_(checkpoints),
        execution_(execution) {
    prepared_.turned.assign(laid_.passes.size(), 0);
  }

  PlannedPasses Plan(const std::vector<char>& wanted) {
    if (free_) Turn(wanted);
    execution_.progress.Begin("passes", PointsOf(wanted));
    PlannedPasses planned = PlanOf(prepared_.toolpath, wanted);
    execution_.progress.End(
        fmt::format("{}, {} from checkpoints", CountedPasses(planned.passes.size()), planned.resumed));
    if (free_) TurnBack(planned.passes);
    return planned;
  }

 private:
  size_t PointsOf(const std::vector<char>& wanted) const {
    size_t count = 0;
    for (size_t i = 0; i < wanted.size(); ++i)
      if (wanted[i] != 0) count += laid_.passes[i].points.size();
    return count;
  }
  PlannedPasses PlanOf(const Toolpath& toolpath, const std::vector<char>& wanted) const {
    return PlanPasses(prepared_.stations,
                      {toolpath, prepared_.external, [&](size_t i) { return wanted[i] != 0; }}, options_,
                      checkpoints_, execution_);
  }
  PassValue ValueAtNominal(const PassResult& pass) const {
    return ValueOf(AtNominalLean(prepared_.problem, pass));
  }

  /// Turns what promises to be better so.
  void Turn(const std::vector<char>& wanted) {
    execution_.progress.Begin("directions", 0);
    ways_ = FindPromisingReversals(prepared_, wanted, options_.worst_first, checkpoints_, execution_);
    prepared_.turned = ways_.promising;
    for (size_t i = 0; i < wanted.size(); ++i) {
      if (prepared_.turned[i] == 0) continue;
      Pass& pass = prepared_.toolpath.passes[i];
      pass = ways_.turned.passes[i];
      Transform(prepared_.stations.At(prepared_.external[i].from).world.cell().X_WP, pass);
      pass.rotation_reference = laid_.passes[i].rotation_reference;
    }
    execution_.progress.End(fmt::format("more is promised by {} from the other end",
                                        CountedPasses(std::ranges::count(ways_.promising, 1))));
  }

  /// Plans as they are laid those turned passes that could be better so, and keeps the better plan.
  void TurnBack(std::vector<PassResult>& passes) {
    if (std::ranges::count(prepared_.turned, 1) == 0) return;
    std::vector<char> open(passes.size(), 0);
    for (size_t i = 0; i < passes.size(); ++i)
      open[i] = prepared_.turned[i] != 0 &&
                !IsBetterThanAny(ValueAtNominal(passes[i]), ways_.laid[i], options_.worst_first);
    execution_.progress.Begin("other ways", PointsOf(open));
    PlannedPasses others = PlanOf(laid_, open);
    size_t turned = 0;
    for (size_t i = 0; i < passes.size(); ++i) {
      if (prepared_.turned[i] == 0) continue;
      if (open[i] == 0 || IsBetter(ValueAtNominal(passes[i]), ValueAtNominal(others.passes[i]),
                                   options_.worst_first, kGainOfTurning)) {
        prepared_.made.toolpath.passes[i] = std::move(ways_.turned.passes[i]);
        ++turned;
      } else {
        passes[i] = std::move(others.passes[i]);
        prepared_.toolpath.passes[i] = laid_.passes[i];
        prepared_.turned[i] = 0;
      }
    }
    execution_.progress.End(fmt::format("{} run the other way round", CountedPasses(turned)));
  }

  PreparedJob& prepared_;
  const Toolpath laid_;  ///< in W
  bool free_;
  const PathOptions options_;
  const CheckpointStore& checkpoints_;
  const Execution& execution_;
  PromisingReversals ways_;
};

}  // namespace

bool FreeDirections(const JobSettings& job) {
  const ToolpathSettings& toolpath = job.toolpath;
  const bool upright = toolpath.lead == 0 && toolpath.tilt == 0;
  return !toolpath.strategy->IsPrescribed() && upright && toolpath.direction == Direction::kZigzag;
}

bool DependsOnFeed(const JobSettings& job, const Objective& objective) {
  return job.cutting || objective.DependsOnFeed();
}

PlannedPasses PlanBestWays(const JobInputs& inputs, PreparedJob& prepared, const CheckpointStore& checkpoints,
                           const std::function<bool(size_t)>& wanted, const Execution& execution) {
  std::vector<char> of(prepared.toolpath.passes.size());
  for (size_t i = 0; i < of.size(); ++i) of[i] = wanted(i) ? 1 : 0;
  return BestWays(inputs, prepared, checkpoints, execution).Plan(of);
}

}  // namespace millpose
