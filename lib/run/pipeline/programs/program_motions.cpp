// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/program_motions.hpp"

#include "base/units.hpp"
#include "job/assemble.hpp"
#include "job/cell_texts.hpp"
#include "job/measured_arm.hpp"
#include "planning/compensation/compensate.hpp"
#include "program/bound_turns.hpp"
#include "program/controller_axes.hpp"
#include "program/pose_text.hpp"
#include "program/stated_speeds.hpp"
#include "run/pipeline/programs/base_window.hpp"
#include "run/pipeline/programs/plan_timeline.hpp"

namespace millpose {
namespace {

// rad: twice what verification asks for; joints nearer to 0 are no matter for turn bits.
constexpr double kTurnLeast = 2 * kUncertainTurn;

MotionOptions MakeMotionOptions(const PlanResult& plan, const JobInputs& inputs,
                                const std::string& controller_name, const std::optional<BaseWindow>& window) {
  const JobSettings& job = inputs.job;
  const PostSettings settings = MakePostSettings(job, inputs.cell, controller_name);
  const Post& post = *inputs.cell.controllers.at(controller_name).post;
  const FrameTexts frames = post.Frames(settings);
  MotionOptions options = RunOptions(job);
  Pose X_FC = plan.X_FT;
  X_FC.linear() = X_FC.linear() * settings.R_TC();
  options.header = {{"version", std::string("millpose ") + MILLPOSE_VERSION},
                    {"tool", frames.tool},
                    {"tool_pose", PoseText(X_FC)},
                    {"base", frames.base},
                    {"base_pose", PoseText(post.BaseInWorld(settings) * plan.X_WB.inverse() * plan.X_WP)},
                    {"units", "mm, degrees"}};
  if (!job.operation.empty())
    options.header.insert(options.header.begin(),
                          {"operation", fmt::format("{} of {}", job.operation, job.operation_of)});
  if (settings.tool_held)
    options.header.emplace_back(kToolHeldKey,
                                "the operation before leaves it in the spindle; compared, not changed");
  for (const std::string& warning : CellWarnings(inputs.cell))
    options.header.emplace_back("unchecked", warning);
  if (window) options.header.emplace_back("base_window", BaseWindowText(*window));
  std::ranges::copy(frames.more, std::back_inserter(options.header));
  const double lift = job.program_options.dry_run_offset;
  if (lift > 0)
    options.header.emplace_back("dry_run",
                                fmt::format("cuts are lifted by {} mm along the tool axis", Fixed(lift, 3)));
  if (inputs.cell.air_feed && job.workpiece.HasStock())
    options.header.emplace_back("air_feed",
                                "cuts run faster where those before have milled the raw part off: all of "
                                "them in their order, none left out");
  if (!job.program_options.date.empty()) options.header.emplace_back("date", job.program_options.date);
  for (const std::string& call : AssumedCalls(inputs.cell, controller_name))
    options.header.emplace_back("call", call);
  for (const std::string& assumption : post.Assumptions(settings))
    options.header.emplace_back("assumed", assumption);
  if (lift == 0 && IsCompensated(plan)) {
    options.header.emplace_back("COMPENSATED", "NOT TO BE RUN TWICE ON ONE PART");
    options.notice = kCompensatedNotice;
  }
  if (lift == 0 && job.compensation.deviations) {
    options.header.emplace_back("corrected_for_arm", MeasuredName(inputs.cell.arm));
    if (const std::string joints = MeasuredJoints(*inputs.cell.arm.deviations); !joints.empty())
      options.header.emplace_back("corrected_for_gears", joints);
  }
  options.outputs = settings.outputs;
  return options;
}

/// Stops in long pieces, where another file goes on; the plan's motions stop there too.
void HandOver(const PostSettings& settings, size_t bytes_per_motion, ProgramMotions& motions,
              const std::vector<size_t>& origin) {
  const size_t fitting = settings.max_bytes() / (bytes_per_motion + 16 * settings.controller_axes.size());
  const int most = std::min(settings.max_motions, std::max(1, static_cast<int>(fitting)));
  for (const size_t place : AddHandovers(motions.written, most)) {
    motions.planned.motions[origin[place - 1]].exact = true;
    const Motion& motion = motions.written.motions[place - 1];
    motions.warnings.push_back(
        fmt::format("pass {} is longer than one file may be: the tool stops at its point {} while the next "
                    "file takes over; max_motions and max_kbytes of the cell say how long a file may be",
                    motion.pass, motion.point));
  }
}

/// Where T or TU could be read either way the entry is stated by its joints; somebody should know.
void StateEntries(const PostSettings& settings, ProgramMotions& motions) {
  for (const size_t i : StateEntriesByJoints(motions.written, settings.axes, kTurnLeast)) {
    const Motion& entry = motions.written.motions[i];
    const Joints angles = settings.axes.FromArm(*entry.q) * kDegPerRad;
    for (int j = 0; j < 6; ++j) {
      if (std::abs(std::remainder(angles[j], 360)) >= kTurnLeast * kDegPerRad) continue;
      motions.warnings.push_back(
          fmt::format("pass {}: A{} is at {:.4f} deg where the approach begins; its turn bit could be read "
                      "either way, so the entry is written as joint angles",
                      entry.pass, j + 1, angles[j]));
    }
  }
}

/// mm: what is taken out may be less than the usual chord, and no point may go that carries a part of it.
double CompensatedChord(const PlanResult& plan) {
  constexpr double kShare = 0.05, kLeast = 1e-5, kMost = 1e-3;
  const CompensationFigures figures = *FiguresOfCompensation(plan);
  const double taken_out = figures.shifts ? figures.largest_shift : figures.largest_arm_shift;
  return std::clamp(kShare * taken_out, kLeast, kMost);
}

EconomyOptions MakeEconomyOptions(const ProgramOptionSettings& options) {
  const PathTolerance most = WrittenTolerance({options.path_tolerance, options.path_angle});
  return {options.chord_tolerance.value_or(options.path_tolerance / 2),
          options.angle_tolerance.value_or(most.angle),
          options.spacing,
          {}};
}

}  // namespace

MotionProgram MakeRunProgram(const PlanResult& plan, const JobSettings& job, const MotionOptions& options) {
  const double lift = job.program_options.dry_run_offset;
  if (lift > 0) return MakeMotionProgram(Lifted(plan, lift), options);
  // A large plan is not copied for nothing.
  return HasCommanded(plan) ? MakeMotionProgram(Commanded(plan), options) : MakeMotionProgram(plan, options);
}

ProgramMotions MakeProgramMotions(const PlanResult& plan, const JobInputs& inputs,
                                  const std::string& controller, const std::optional<BaseWindow>& window,
                                  const std::vector<CallTransition>& calls) {
  const JobSettings& job = inputs.job;
  ProgramMotions motions;
  const double lift = job.program_options.dry_run_offset;
  MotionOptions options = MakeMotionOptions(plan, inputs, controller, window);
  options.calls = calls;
  motions.planned = MakeRunProgram(plan, job, options);
  const PostSettings settings = MakePostSettings(job, inputs.cell, controller);
  const Post& post = *inputs.cell.controllers.at(controller).post;
  EconomyOptions economy = MakeEconomyOptions(job.program_options);
  economy.lines = post.Lines(settings);
  motions.commanded = lift == 0 && (IsCompensated(plan) || job.compensation.deviations);
  if (motions.commanded && !job.program_options.chord_tolerance)
    economy.position_tolerance = std::min(economy.position_tolerance, CompensatedChord(plan));
  if (const double reserve = post.AngleReserve(); reserve > 0)
    economy.angle_tolerance = std::min(economy.angle_tolerance, job.program_options.path_angle - reserve);
  if (post.HasOwnWorld()) motions.planned.frames_checked = true;
  motions.chord = economy.position_tolerance;
  EconomyResult thinned = Economise(motions.planned, economy);
  motions.written = std::move(thinned.program);
  motions.saved = thinned.saved;
  motions.near = thinned.near;
  if (!economy.lines.empty())
    motions.inserted =
        BoundTurns(motions.written, thinned.origin, plan.arm, {economy.lines, settings.tolerance.angle});
  for (const std::string& call : AssumedCalls(inputs.cell, controller))
    motions.warnings.push_back("assumed: " + call);
  for (const std::string& assumption : post.Assumptions(settings))
    motions.warnings.push_back("assumed: " + assumption);
  if (!post.ReadsFromDisk()) {
    if (!post.EntersByJoints()) StateEntries(settings, motions);
    HandOver(settings, post.BytesPerMotion(), motions, thinned.origin);
  }
  post.Round(motions.written, plan.arm, settings);
  StateSpeeds(motions.written);
  motions.time = MeasureTime(motions.written, plan.arm, post.Times());
  return motions;
}

}  // namespace millpose
