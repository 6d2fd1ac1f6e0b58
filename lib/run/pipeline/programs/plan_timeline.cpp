// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/plan_timeline.hpp"

#include "program/make_timeline.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {

Timeline PlanTimeline(const PlanResult& plan, const JobInputs& inputs) {
  const JobSettings& job = inputs.job;
  MotionOptions options;
  options.approach_feed = job.approach_feed;
  options.approach_slow = job.approach_slow;
  options.plunge_feed = job.plunge_feed.value_or(0);
  options.retract_feed = job.retract_feed;
  options.dwell = job.toolpath.strategy->Dwell();
  TimeOptions times;
  if (!job.programs.empty()) times = inputs.cell.controllers.at(job.programs.front()).post->Times();
  return MakeTimeline(plan, options, times);
}

}  // namespace millpose
