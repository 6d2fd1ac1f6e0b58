// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/program_motions.hpp"

#include "base/units.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/base_window.hpp"
#include "pipeline/cell_texts.hpp"
#include "pipeline/krl_frames.hpp"
#include "program/bound_turns.hpp"
#include "program/controller_axes.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

// rad: twice what verification asks for; joints nearer to 0 are no matter for turn bits.
constexpr double kTurnLeast = 2 * kUncertainTurn;

/// Which of the controller's own frames the program uses, where it uses one.
std::string Numbered(const char* list, int number) {
  return number > 0 ? fmt::format("{}[{}] must hold: ", list, number) : std::string();
}

/// What KRL's head says of the frames that it assumes, and of the load.
void AddKrlHeader(const CellSettings& cell, const ControllerSettings& controller, MotionOptions* options) {
  const Pose robroot = MakePose(controller.robroot.value_or(PoseSettings{}));
  if (controller.ersysroot) {
    const RailSettings& rail = *controller.ersysroot;
    options->header.emplace_back("ersysroot", "assumed $ERSYSROOT: " + PoseText(MakePose(rail.pose)));
    options->header.emplace_back(
        "rail", fmt::format("E{} along {} of it, the robot on the carriage:", rail.axis, rail.direction));
    options->header.emplace_back("carriage", PoseText(robroot));
  } else {
    options->header.emplace_back("robroot", "assumed $ROBROOT: " + PoseText(robroot));
  }
  if (!cell.tool.load) return;
  const ToolLoadSettings& load = *cell.tool.load;
  const auto three = [](const Eigen::Vector3d& v, int decimals) {
    return fmt::format("{} {} {}", Fixed(v.x(), decimals), Fixed(v.y(), decimals), Fixed(v.z(), decimals));
  };
  options->header.emplace_back("load", fmt::format("M {} kg, CM {} mm, J {} kg m2", Fixed(load.mass, 3),
                                                   three(load.centre, 1), three(load.inertia, 3)));
}

MotionOptions MakeMotionOptions(const PlanResult& plan, const JobInputs& inputs,
                                const std::string& controller_name, const std::optional<BaseWindow>& window) {
  const bool own_world = MakePost(controller_name)->HasOwnWorld();
  const JobSettings& job = inputs.job;
  const auto found = inputs.cell.controllers.find(controller_name);
  const ControllerSettings controller =
      found == inputs.cell.controllers.end() ? ControllerSettings{} : found->second;
  MotionOptions options;
  Pose X_FC = plan.X_FT;
  X_FC.linear() = X_FC.linear() * ToolAxis(controller.tool_axis);
  options.header = {
      {"version", std::string("millpose ") + MILLPOSE_VERSION},
      {"tool", Numbered("TOOL_DATA", controller.tool_number) + inputs.cell.tool.name + " in the flange"},
      {"tool_pose", PoseText(X_FC)},
      {"base", Numbered("BASE_DATA", controller.base_number) +
                   (own_world ? "workpiece in $WORLD" : "workpiece in the robot base")},
      {"base_pose", PoseText((own_world ? RobotBaseInWorld(controller) : Pose::Identity()) *
                             plan.X_WB.inverse() * plan.X_WP)},
      {"units", "mm, degrees"}};
  for (const std::string& warning : CellWarnings(inputs.cell))
    options.header.emplace_back("unchecked", warning);
  if (window) options.header.emplace_back("base_window", BaseWindowText(*window));
  if (own_world) AddKrlHeader(inputs.cell, controller, &options);
  const double lift = job.program_options.dry_run_offset;
  if (lift > 0)
    options.header.emplace_back("dry_run",
                                fmt::format("cuts are lifted by {} mm along the tool axis", Fixed(lift, 3)));
  if (!job.program_options.date.empty()) options.header.emplace_back("date", job.program_options.date);
  for (const std::string& call : AssumedCalls(inputs.cell, controller_name))
    options.header.emplace_back("call", call);
  options.approach_feed = job.approach_feed;
  options.approach_slow = job.approach_slow;
  options.plunge_feed = job.plunge_feed.value_or(0);
  options.retract_feed = job.retract_feed;
  for (const PathOutputSettings& output : controller.outputs)
    options.outputs.push_back({output.number, output.on, output.delay, output.at == "cut_begin"});
  return options;
}

/// Stops in long pieces, where another file goes on; the plan's motions stop there too.
void HandOver(const PostSettings& settings, ProgramMotions& motions, const std::vector<size_t>& origin) {
  const size_t fitting = settings.max_bytes / (kBytesPerMotion + 16 * settings.external.size());
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
    const Joints angles = ToController(settings.axes, *entry.q) * kDegPerRad;
    for (int j = 0; j < 6; ++j) {
      if (std::abs(std::remainder(angles[j], 360)) >= kTurnLeast * kDegPerRad) continue;
      motions.warnings.push_back(fmt::format(
          "pass {}: A{} stands at {:.4f} deg where the approach begins; its turn bit could be read "
          "either way, so the entry is written as joint angles",
          entry.pass, j + 1, angles[j]));
    }
  }
}

EconomyOptions MakeEconomyOptions(const ProgramOptionSettings& options) {
  const PathTolerance most = WrittenTolerance({options.path_tolerance, options.path_angle});
  return {options.chord_tolerance.value_or(options.path_tolerance / 2),
          options.angle_tolerance.value_or(most.angle),
          options.spacing,
          {}};
}

}  // namespace

std::string PoseText(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation(), abc = AnglesZyx(pose.linear()) * kDegPerRad;
  return fmt::format("X {} Y {} Z {}, A {} B {} C {} (Z Y' X'')", Fixed(p.x(), 3), Fixed(p.y(), 3),
                     Fixed(p.z(), 3), Fixed(abc[0], 4), Fixed(abc[1], 4), Fixed(abc[2], 4));
}

std::optional<Pose> ReadPoseText(const std::string& text) {
  LineScanner scan(text, "", 0);
  std::array<double, 6> values{};
  try {
    for (size_t i = 0; i < 6; ++i) {
      if (i == 3) scan.Expect(",");
      scan.Expect(std::string(1, "XYZABC"[i]));
      values[i] = scan.ExpectNumber();
    }
    scan.Expect("(Z Y' X'')");
    scan.ExpectEnd();
  } catch (const InputError&) {
    return std::nullopt;
  }
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(values[0], values[1], values[2]);
  pose.linear() = FromAnglesZyx(Eigen::Vector3d(values[3], values[4], values[5]) * kRadPerDeg);
  return pose;
}

ProgramMotions MakeProgramMotions(const PlanResult& plan, const JobInputs& inputs,
                                  const std::string& controller, const std::optional<BaseWindow>& window,
                                  const std::vector<CallWay>& calls) {
  const JobSettings& job = inputs.job;
  ProgramMotions motions;
  const double lift = job.program_options.dry_run_offset;
  MotionOptions options = MakeMotionOptions(plan, inputs, controller, window);
  options.calls = calls;
  motions.planned = MakeMotionProgram(lift > 0 ? Lifted(plan, lift) : plan, options);
  const PostSettings post = MakePostSettings(job, inputs.cell, controller);
  const std::unique_ptr<Post> kind = MakePost(controller);
  EconomyOptions economy = MakeEconomyOptions(job.program_options);
  economy.lines = kind->Lines(post);
  if (const double reserve = kind->AngleReserve(); reserve > 0)
    economy.angle_tolerance = std::min(economy.angle_tolerance, job.program_options.path_angle - reserve);
  if (kind->HasOwnWorld()) motions.planned.frames_checked = true;
  EconomyResult thinned = Economise(motions.planned, economy);
  motions.written = std::move(thinned.program);
  motions.saved = thinned.saved;
  motions.near = thinned.near;
  if (!economy.lines.empty())
    motions.inserted =
        BoundTurns(motions.written, thinned.origin, plan.arm, {economy.lines, post.tolerance.angle});
  for (const std::string& call : AssumedCalls(inputs.cell, controller))
    motions.warnings.push_back("assumed: " + call);
  if (!kind->ReadsFromDisk()) {
    StateEntries(post, motions);
    HandOver(post, motions, thinned.origin);
  }
  kind->Round(motions.written, plan.arm, post);
  motions.time = MeasureTime(motions.written, plan.arm, kind->Times(post));
  return motions;
}

}  // namespace millpose
