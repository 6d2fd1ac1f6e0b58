// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "job/assemble.hpp"
#include "machine/robot/make_pose.hpp"
#include "planning/pose/expression.hpp"
#include "planning/pose/freedom_entry.hpp"
#include "program/external_axes.hpp"
#include "program/program_name.hpp"
#include "toolpath/pass_ends.hpp"

namespace millpose {

AdmissibleBounds MakeBounds(const JobSettings& job, const Arm& arm) {
  AdmissibleBounds bounds;
  bounds.lower = arm.lower;
  bounds.upper = arm.upper;
  if (job.task_limits) {
    bounds.lower = bounds.lower.cwiseMax((*job.task_limits)[0]);
    bounds.upper = bounds.upper.cwiseMin((*job.task_limits)[1]);
  }
  bounds.lower.array() += job.limit_margin;
  bounds.upper.array() -= job.limit_margin;
  for (int i = 0; i < 6; ++i)
    if (bounds.lower[i] >= bounds.upper[i])
      throw InputError({job.file},
                       fmt::format("limits: axis {} has no range left: {:.3f}..{:.3f} deg after the margin",
                                   i + 1, RadToDeg(bounds.lower[i]), RadToDeg(bounds.upper[i])));
  bounds.coupled = arm.coupled_limits;
  for (CoupledLimit& limit : bounds.coupled) limit.at_most -= job.limit_margin;
  bounds.dexterity_min = job.dexterity_min;
  bounds.wrist_min = job.wrist_min;
  bounds.elbow_min = job.elbow_min;
  bounds.shoulder_min_mm = job.shoulder_min;
  return bounds;
}

PoseProblem MakePoseProblem(const JobSettings& job, const CellSettings& cell_settings, const Cell& cell) {
  PoseProblem problem;
  problem.arm = cell.arm;
  problem.X_WB = cell.X_WB;
  problem.X_FT = cell.X_FT;
  problem.origin = cell_settings.stiffness_at;
  problem.characteristic_length = cell_settings.characteristic_length;
  problem.bounds = MakeBounds(job, cell.arm);
  problem.freedoms = FreedomsOf(job.toolpath);
  problem.compliances = MakeCompliances(cell_settings);
  ObjectiveParameters parameters = job.objective_parameters;
  for (const ParameterRule& rule : ObjectiveNamed(job.objective).parameters) {
    if (rule.name == "force_uncertainty_percent") parameters[rule.name] = job.force_uncertainty_percent;
    if (rule.name == "force_direction_deg") parameters[rule.name] = job.force_direction_deg;
  }
  problem.objective = MakeObjective(job.objective, parameters);
  if (problem.objective->NeedsForce() && !job.cutting)
    throw InputError({job.file},
                     fmt::format("objective {}: no force; give the job process.cutting", job.objective));
  if (problem.objective->JudgesFace() && !MakeGearModel(cell_settings).lost.Any())
    throw InputError(
        {job.file},
        fmt::format("objective {}: cell {} states no lost motion (arm.lost_motion_arcmin); "
                    "without it {} is the same",
                    job.objective, cell_settings.name, TheObjective(&ObjectiveEntry::with_force).name));
  return problem;
}

CutterShape MakeCutterShape(const ToolSettings& tool) {
  return {tool.cutter_diameter / 2, CornerRadius(tool), tool.cutting_length};
}

ToolpathOptions MakeToolpathOptions(const JobSettings& job, const ToolSettings& tool) {
  ToolpathOptions options = job.toolpath;
  options.cutter = MakeCutterShape(tool);
  options.centre_cutting = tool.centre_cutting;
  options.max_ramp = tool.max_ramp;
  options.feed_rate = job.feed;
  options.plunge_feed = job.plunge_feed.value_or(0);
  options.retract_feed = job.retract_feed;
  return options;
}

PathOptions MakePathOptions(const JobSettings& job) {
  PathOptions options = job.path;
  options.worst_first = job.worst_first.value_or(ObjectiveNamed(job.objective).worst_first);
  options.swept_resolution = job.swept_resolution;
  options.ends = job.toolpath.ends;
  options.lead_spacing = job.toolpath.spacing;
  options.seed = job.seed;
  if (job.formulation != Formulation::kPaper) return options;
  options.paper = job.paper;
  const auto weight = [&](const char* name, double fallback) {
    const auto given = job.objective_parameters.find(name);
    return given == job.objective_parameters.end() ? fallback : given->second;
  };
  options.paper->w1 = weight("w1", options.paper->w1);
  options.paper->w2 = weight("w2", options.paper->w2);
  return options;
}

int FinishedFrom(const JobSettings& job, size_t passes) {
  const size_t layers = LayerOffsets(job.toolpath.layers).size();
  return static_cast<int>(passes - passes / layers);
}

FixedRotationOptions MakeFixedOptions(const JobSettings& job, const CellSettings& cell, size_t passes,
                                      int threads, std::stop_token stop) {
  const PathOptions path = MakePathOptions(job);
  return {.rotation_step = path.rotation_step,
          .steps = path.steps,
          .swept_resolution = path.swept_resolution,
          .worst_first = path.worst_first,
          .gears = MakeGearModel(cell),
          .finished_from = FinishedFrom(job, passes),
          .threads = threads,
          .stop = std::move(stop),
          .leave = MakeLinkMoveOptions(job).leave};
}

LinkMoveOptions MakeLinkMoveOptions(const JobSettings& job) {
  LinkMoveOptions options = job.gaps;
  options.leave.swept_resolution = job.swept_resolution;
  options.seed = job.seed;
  return options;
}

VerifyOptions MakeVerifyOptions(const JobSettings& job, const Arm& arm) {
  VerifyOptions options;
  options.position_tolerance = job.program_options.path_tolerance;
  options.angle_tolerance = job.program_options.path_angle;
  options.lower = arm.lower;
  options.upper = arm.upper;
  options.coupled = arm.coupled_limits;
  options.swept_resolution = job.swept_resolution;
  options.clearance_reserve = job.swept_resolution;
  options.feed_least = std::max(options.feed_least, job.min_feed_share);
  options.interference = job.program_options.dry_run_offset > 0;  // the lifted motions were never checked
  return options;
}

std::string NoProgramsFor(const ArmSettings& arm, const std::string& controller) {
  if (arm.family != ArmFamily::kParallelAxes || !MakePost(controller)->NeedsSphericalWrist()) return "";
  std::vector<std::string> allowed;
  for (const PostEntry& entry : Posts().entries())
    if (!entry.make()->NeedsSphericalWrist()) allowed.push_back(entry.name);
  return fmt::format(
      "{} cannot program {}: its status and turn tell the configurations of a spherical wrist apart, and "
      "axes "
      "2, 3 and 4 of this arm are parallel; allowed: {}",
      controller, arm.name, fmt::join(allowed, ", "));
}

PostSettings MakeTextSettings(const JobSettings& job, const CellSettings& cell,
                              const std::string& controller) {
  const SourceLocation place{job.file.empty() ? cell.file : job.file, job.programs_line};
  if (const std::string refusal = NoProgramsFor(cell.arm, controller); !refusal.empty())
    throw InputError(place, "programs: " + refusal);
  const auto found = cell.controllers.find(controller);
  if (found == cell.controllers.end()) {
    throw InputError(place,
                     fmt::format("programs: {} needs a section controllers.{} in cell {}: how its tool is "
                                 "measured must be stated, never assumed",
                                 controller, controller, cell.name));
  }
  const ControllerOptions& options = found->second;
  PostSettings post;
  static_cast<PostOptions&>(post) = options.shared;
  post.axes = post.Axes();
  post.X_FT = MakeToolPose(cell.tool);
  post.X_WB = MakePose(cell.base_in_world);
  post.mechanism = Mechanism(std::vector<ExternalAxis>(cell.external_axes.begin(), cell.external_axes.end()));
  post.tool_name = cell.tool.name;
  post.tool_number = cell.tool.number;
  post.several_tools = cell.tools.size() > 1;
  post.change_at = cell.change_at;
  if (post.ChangesTool()) post.tool_check = options.post->ToolCheck(post);
  // Only where the controller can tell which tool it holds: else somebody must look anyhow.
  if (job.tool_held && !post.tool_check.empty()) {
    post.tool_held = true;
    post.change_at.reset();
    post.texts["tool_change"] = options.post->HeldTool();
  }
  post.load = cell.tool.load;
  post.tolerance = WrittenTolerance({job.program_options.path_tolerance, job.program_options.path_angle});
  post.blend = options.post->Blend(post.tolerance, job.toolpath.chord_tolerance);
  post.orientation_blend = post.tolerance.angle;
  return post;
}

PostSettings MakePostSettings(const JobSettings& job, const CellSettings& cell,
                              const std::string& controller) {
  PostSettings post = MakeTextSettings(job, cell, controller);
  const std::vector<ExternalAxis>& axes = post.mechanism.axes();
  if (!axes.empty() && !cell.controllers.at(controller).post->HasExternalAxes())
    throw InputError(SourceLocation{cell.file, cell.controllers_line},
                     fmt::format("controllers.{0}: {0} moves no axes beside the arm's six, the cell has {1}; "
                                 "expected: a cell without external_axes, or another controller",
                                 controller, axes.front().name));
  if (const std::string refusal = WhyNotWithAxes(post, controller); !refusal.empty())
    throw InputError(SourceLocation{cell.file, post.controller_axes_line}, refusal);
  if (!IsToolName(post.tool_name))
    throw InputError(
        cell.tool.name_place,
        fmt::format("tool.name: given '{}'; allowed where programs are written: 1 to 32 plain ASCII "
                    "characters, none of \" ( ) {{ }} ;, blanks only one at a time between others",
                    post.tool_name));
  if (const std::string refusal = cell.controllers.at(controller).post->WhyNotIn(post); !refusal.empty()) {
    const bool of_tool = !cell.tools.empty() && refusal.find("tool.load") != std::string::npos;
    const std::string whose =
        of_tool ? fmt::format(" (here `load` of {} among the cell's `tools`)", cell.tool.name) : "";
    throw InputError(SourceLocation{cell.file, cell.controllers_line}, refusal + whose);
  }
  return post;
}

}  // namespace millpose
