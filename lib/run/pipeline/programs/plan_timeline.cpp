// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/plan_timeline.hpp"

#include "program/make_timeline.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {

MotionOptions RunOptions(const JobSettings& job) {
  MotionOptions options;
  options.approach_feed = job.approach_feed;
  options.approach_slow = job.approach_slow;
  options.plunge_feed = job.plunge_feed.value_or(0);
  options.retract_feed = job.retract_feed;
  options.dwell = job.toolpath.strategy->Dwell();
  return options;
}

TimeOptions RunClock(const JobInputs& inputs) {
  if (inputs.job.programs.empty()) return {};
  return inputs.cell.controllers.at(inputs.job.programs.front()).post->Times();
}

Timeline PlanTimeline(const PlanResult& plan, const JobInputs& inputs) {
  return MakeTimeline(plan, RunOptions(inputs.job), RunClock(inputs));
}

}  // namespace millpose
