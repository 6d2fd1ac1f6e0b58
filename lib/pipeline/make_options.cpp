// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/krl_frames.hpp"

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
  problem.origin =
      cell_settings.stiffness_at == "flange" ? StiffnessOrigin::kFlange : StiffnessOrigin::kToolTip;
  problem.characteristic_length = cell_settings.characteristic_length;
  problem.bounds = MakeBounds(job, cell.arm);
  problem.freedoms.push_back(MakeFreedom("rotation"));
  problem.compliances = MakeCompliances(cell_settings);
  const bool own_force = job.objective == "process_force" && !job.objective_parameters.empty();
  if (!job.cutting && !own_force && (job.objective == "surface_error" || job.objective == "process_force"))
    throw InputError(
        {job.file},
        fmt::format(
            "objective {}: no force; give the job process.cutting{}", job.objective,
            job.objective == "process_force" ? ", or the objective feed_N, across_N or axial_N" : ""));
  problem.objective = MakeObjective(job.objective, job.objective_parameters);
  return problem;
}

namespace {

RegionOptions MakeConditions(const ConditionSettings& settings) {
  RegionOptions options;
  if (settings.box) options.box = {settings.box->lower, settings.box->upper};
  if (settings.half_space)
    options.half_space = HalfSpace{settings.half_space->point, settings.half_space->normal};
  if (settings.polygon)
    options.polygon = ProjectedPolygon{settings.polygon->points, settings.polygon->direction};
  options.facing = settings.facing;
  options.facing_within = settings.facing_within;
  if (settings.connected)
    options.connected = ConnectedFaces{settings.connected->seed, settings.connected->crease};
  options.source_faces = settings.step_faces;
  options.rim_distance = settings.rim_distance;
  return options;
}

RegionOptions MakeRegion(const RegionSettings& settings) {
  RegionOptions options = MakeConditions(settings);
  for (const ConditionSettings& condition : settings.all) options.all.push_back(MakeConditions(condition));
  for (const ConditionSettings& condition : settings.any) options.any.push_back(MakeConditions(condition));
  for (const ConditionSettings& condition : settings.none) options.none.push_back(MakeConditions(condition));
  return options;
}

PassEnds MakePassEnds(const PassEndSettings& settings) {
  const std::map<std::string, LeadShape> shapes{{"none", LeadShape::kNone},
                                                {"normal", LeadShape::kNormal},
                                                {"ramp", LeadShape::kRamp},
                                                {"arc", LeadShape::kArc}};
  return {settings.overrun, shapes.at(settings.lead), settings.lead_length, settings.ramp_angle};
}

Direction MakeDirection(const std::string& name) {
  if (name == "one_way") return Direction::kOneWay;
  if (name == "climb") return Direction::kClimb;
  return name == "conventional" ? Direction::kConventional : Direction::kZigzag;
}

}  // namespace

CutterShape MakeCutterShape(const ToolSettings& tool) {
  return {tool.cutter_diameter / 2, CornerRadius(tool), tool.cutting_length};
}

GougeOptions MakeGougeOptions(const JobSettings& job) {
  const std::string& action = job.toolpath.gouges.action;
  return {action == "lift"     ? GougeAction::kLift
          : action == "report" ? GougeAction::kReport
                               : GougeAction::kSkip,
          job.toolpath.gouges.tolerance};
}

ToolpathOptions MakeToolpathOptions(const JobSettings& job, const ToolSettings& tool) {
  const ToolpathSettings& settings = job.toolpath;
  ToolpathOptions options;
  options.strategy = settings.strategy;
  options.region = MakeRegion(settings.region);
  options.plane_normal = settings.plane_normal;
  options.axis_point = settings.axis_point;
  options.axis_direction = settings.axis_direction;
  options.ring_surface = settings.ring_surface == "faces"   ? RingSurface::kFaces
                         : settings.ring_surface == "walls" ? RingSurface::kWalls
                                                            : RingSurface::kAuto;
  options.spiral =
      settings.strategy == "pad" ? settings.pad_pattern == "spiral" : settings.ring_path == "spiral";
  options.seam_step = settings.seam_step;
  options.pad_direction = settings.pad_direction;
  options.pad_offset = settings.pad_offset;
  options.curve_points = settings.curve_points;
  options.curve_direction = settings.curve_direction;
  if (settings.stepover > 0) options.stepover = settings.stepover;
  options.stepover_on_surface = settings.stepover_on == "surface";
  options.scallop = settings.scallop;
  options.direction = MakeDirection(settings.direction);
  options.order_by_travel = settings.order == "travel";
  options.chord_tolerance = settings.chord_tolerance;
  options.spacing = settings.spacing;
  options.crease = settings.crease;
  options.lead = settings.lead;
  options.tilt = settings.tilt;
  options.normal_smoothing = settings.normal_smoothing;
  options.cutter = MakeCutterShape(tool);
  options.layers = {settings.depth.total, settings.depth.per_layer, settings.depth.allowance,
                    settings.depth.finishing};
  options.ends = MakePassEnds(settings.ends);
  options.feed_rate = job.feed;
  return options;
}

PathOptions MakePathOptions(const JobSettings& job) {
  PathOptions options;
  options.rotation_step = job.rotation_step;
  options.exhaustive_step = job.exhaustive_step;
  options.max_joint_step = job.max_joint_step;
  options.motion_weight = job.motion_weight;
  options.worst_first = job.criterion ? *job.criterion == "worst_then_sum" : job.objective == "surface_error";
  options.smoothing_loss = job.smoothing_loss;
  options.max_deviation = job.max_deviation;
  options.swept_resolution = job.swept_resolution;
  options.overlap = job.overlap;
  options.ends = MakePassEnds(job.toolpath.ends);
  options.lead_spacing = job.toolpath.spacing;
  options.genetic.population = job.genetic.population;
  options.genetic.generations = job.genetic.generations;
  options.genetic.crossover_rate = job.genetic.crossover_rate;
  options.genetic.mutation_rate = job.genetic.mutation_rate;
  options.genetic.elite = job.genetic.elite;
  options.genetic.max_evaluations = job.genetic.max_evaluations;
  if (job.formulation == "paper") {
    const auto weight = [&](const char* name) {
      const auto given = job.objective_parameters.find(name);
      return given == job.objective_parameters.end() ? 0.5 : given->second;
    };
    PaperFormulationOptions& paper = options.paper.emplace();
    paper.population = job.paper.population;
    paper.generations = job.paper.generations;
    paper.elite = job.paper.elite;
    paper.crossover_rate = job.paper.crossover_rate;
    paper.c_max = job.paper.c_max;
    paper.penalty = job.paper.penalty;
    paper.w1 = weight("w1");
    paper.w2 = weight("w2");
  }
  options.seed = job.seed;
  return options;
}

FixedRotationOptions MakeFixedOptions(const JobSettings& job, int threads, std::stop_token stop) {
  const PathOptions path = MakePathOptions(job);
  return {path.rotation_step, path.max_joint_step, path.swept_resolution, path.worst_first, threads,
          std::move(stop)};
}

GapOptions MakeGapOptions(const JobSettings& job) {
  GapOptions options;
  options.retract = job.retract;
  options.max_iterations = job.gap_iterations;
  options.swept_resolution = job.swept_resolution;
  options.limit_margin = job.gap_limit_margin;
  options.speed_share = job.gap_speed_share;
  options.seed = job.seed;
  return options;
}

VerifyOptions MakeVerifyOptions(const JobSettings& job, const Arm& arm) {
  VerifyOptions options;
  options.position_tolerance = job.program_options.path_tolerance;
  options.angle_tolerance = job.program_options.path_angle;
  options.lower = arm.lower;
  options.upper = arm.upper;
  options.swept_resolution = job.swept_resolution;
  options.clearance_reserve = job.swept_resolution;
  options.interference = job.program_options.dry_run_offset > 0;  // the lifted motions were never checked
  return options;
}

namespace {

constexpr double kLargestRounding = 0.01;  // mm, of a control's tolerance

/// s: KRC4's 12 ms; 4 ms as SINUMERIK 840D sl is often set up (MD10071); LinuxCNC's servo period of 1 ms.
double UsualCycle(const std::string& controller) {
  return controller == "krl" ? 0.012 : controller == "sinumerik" ? 0.004 : 0.001;
}

PathDynamics DynamicsOf(const ControllerSettings& settings, const std::string& controller) {
  PathDynamics dynamics;
  dynamics.cycle = settings.interpolation_cycle.value_or(UsualCycle(controller));
  dynamics.block_time = settings.block_time.value_or(dynamics.cycle);
  if (settings.path_acceleration) dynamics.acceleration = *settings.path_acceleration;
  dynamics.turn_acceleration = settings.orientation_acceleration;
  return dynamics;
}

// What only KRL's programs know.
void AddKrl(const CellSettings& cell, const ControllerSettings& settings, PostSettings* post) {
  CheckGravity(cell, settings);
  post->X_KB = RobotBaseInWorld(settings);
  if (settings.ersysroot) post->ersysroot = MakePose(settings.ersysroot->pose);
  post->base_number = settings.base_number;
  post->tool_number = settings.tool_number;
  post->external = settings.external_axes;
  post->ptp_share = settings.ptp_speed_percent / 100.0;
  post->advance = settings.advance;
  post->orientation_speed = settings.orientation_speed;
  post->orientation_acceleration = settings.orientation_acceleration;
  post->path_acceleration = settings.path_acceleration;
  post->tool_direction = Eigen::Vector3d::Unit(settings.tool_direction[0] - 'x');
  post->memory = static_cast<size_t>(settings.memory_kbytes) * 1000;
  if (!settings.write_load) return;
  const std::optional<ToolLoadSettings>& load = cell.tool.load;
  if (!load)
    throw InputError(Place{cell.file},
                     "controllers.krl.write_load: tool.load is missing; expected: mass, centre "
                     "and inertia of what hangs on the flange");
  post->load = ToolLoad{load->mass, load->centre, load->inertia};
}

}  // namespace

std::string NoProgramsFor(const ArmSettings& arm, const std::string& controller) {
  if (arm.family != "parallel_axes" || controller == "linuxcnc") return "";
  return fmt::format(
      "{} cannot program {}: its status and turn tell the configurations of a spherical wrist apart, and "
      "axes "
      "2, 3 and 4 of this arm are parallel; allowed: linuxcnc",
      controller, arm.name);
}

PostSettings MakePostSettings(const JobSettings& job, const CellSettings& cell,
                              const std::string& controller) {
  const Place place{job.file.empty() ? cell.file : job.file, job.programs_line};
  if (const std::string refusal = NoProgramsFor(cell.arm, controller); !refusal.empty())
    throw InputError(place, "programs: " + refusal);
  const auto found = cell.controllers.find(controller);
  if (found == cell.controllers.end()) {
    throw InputError(place,
                     fmt::format("programs: {} needs a section controllers.{} in cell {}: how its tool is "
                                 "measured must be stated, never assumed",
                                 controller, controller, cell.name));
  }
  const ControllerSettings& settings = found->second;
  PostSettings post;
  for (int i = 0; i < 6; ++i) post.axes.sign[i] = settings.axis_signs[static_cast<size_t>(i)];
  post.axes.offset = settings.axis_offsets;
  post.R_TC = ToolAxis(settings.tool_axis);
  post.X_FT = MakeToolPose(cell.tool);
  post.tool_name = cell.tool.name;
  post.tolerance = WrittenTolerance({job.program_options.path_tolerance, job.program_options.path_angle});
  post.blend = controller == "sinumerik" ? post.tolerance.position
                                         : std::min(job.toolpath.chord_tolerance, kLargestRounding);
  post.orientation_blend = post.tolerance.angle;
  post.rotation = settings.rotation;
  post.cartesian = settings.coordinates == "cartesian";
  for (size_t i = 0; i < 6; ++i) post.axis_names[i] = settings.axis_names[i];
  post.frame = settings.settable_frame.value_or(post.frame);
  post.ori_ipo_with_g_code = settings.ori_ipo_with_g_code;
  post.ori_def_with_g_code = settings.ori_def_with_g_code;
  post.dynamics = DynamicsOf(settings, controller);
  if (controller == "krl") AddKrl(cell, settings, &post);
  post.max_motions = settings.max_motions;
  post.max_bytes = static_cast<size_t>(settings.max_kbytes) * 1000;
  post.texts = settings.texts;
  for (const CallSettings& call : settings.calls)
    post.calls.push_back(
        {call.name, call.moves, call.from.value_or(Joints::Zero()), call.to.value_or(Joints::Zero())});
  return post;
}

}  // namespace millpose
