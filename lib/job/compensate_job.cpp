// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/compensate_job.hpp"

#include "base/error.hpp"
#include "base/trig.hpp"
#include "job/assemble.hpp"
#include "job/commanded_free.hpp"
#include "job/job_engagement.hpp"
#include "job/measured_forces.hpp"
#include "job/measured_map.hpp"
#include "planning/compensation/gain.hpp"
#include "planning/face/arm_geometry.hpp"
#include "planning/result/skipped.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Forces are worked out for the feeds that passes were laid with: Kienzle's law takes them to those that the
/// joints can hold.
void ScaleToFeeds(const JobInputs& inputs, const std::vector<std::vector<double>>& planned_feeds,
                  const PlanResult& plan, PointForces& forces) {
  const double exponent = 1 - ChipExponent(inputs.job);
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t i = 0; i < plan.passes[p].points.size(); ++i) {
      const double feed = plan.passes[p].points[i].point.feed_rate;
      if (feed < planned_feeds[p][i]) forces[p][i] *= Pow(feed / planned_feeds[p][i], exponent);
    }
}

void CheckWeight(const JobSettings& job, const CellSettings& cell, std::vector<Problem>& problems) {
  if (!job.compensation.weight) return;
  if (cell.arm.absolute_accuracy)
    problems.push_back({{job.file},
                        fmt::format("compensation.weight: given true, but the controller of cell {} does it "
                                    "already (arm.absolute_accuracy: true)",
                                    cell.name)});
  if (!cell.gravity)
    problems.push_back(
        {{job.file},
         fmt::format("compensation.weight: given true; cell {} has no stiffness.gravity, which says what "
                     "weighs how much and in which pose the workpiece's frame was measured",
                     cell.name)});
}

}  // namespace

namespace {

// Weight is known in the base's frame, whose tilt must then be that of the cell.
void CheckTilt(const JobSettings& job, const CellSettings& cell, std::vector<Problem>& problems) {
  constexpr double kUpright = 1e-9;
  if (!job.compensation.weight) return;
  for (const ExternalAxis& axis : cell.external_axes)
    if (axis.kind == AxisKind::kRotary && axis.carries == Carries::kRobot &&
        axis.direction.head<2>().norm() > kUpright)
      problems.push_back(
          {{job.file},
           fmt::format("compensation.weight: given true; external axis {} of cell {} tilts the "
                       "robot, so that its weight bends it another way at every station",
                       axis.name, cell.name)});
}

}  // namespace

std::vector<Problem> CheckCompensation(const JobSettings& job, const CellSettings& cell) {
  std::vector<Problem> problems;
  CheckWeight(job, cell, problems);
  CheckTilt(job, cell, problems);
  if (job.compensation.deviations && !cell.arm.deviations)
    problems.push_back(
        {{job.file},
         fmt::format("compensation.deviations: given true; cell {} has no arm.deviations, which "
                     "say how the arm differs from its sheet",
                     cell.name)});
  const auto plain = [](char c) { return c >= ' ' && c <= '~'; };
  if (job.compensation.deviations && !std::ranges::all_of(cell.arm.serial, plain))
    problems.push_back(
        {{cell.file},
         fmt::format("arm.serial: given {}; allowed with compensation.deviations of a job: plain "
                     "ASCII characters, since programs say by it which arm they are for",
                     cell.arm.serial)});
  const bool on = job.compensation.deflection != TakeOut::kOff || job.compensation.weight;
  if (on && cell.stiffness_at != StiffnessOrigin::kToolTip)
    problems.push_back({{job.file},
                        fmt::format("compensation: needs stiffness at the tool tip; cell {} gives "
                                    "stiffness.at: flange",
                                    cell.name)});
  return problems;
}

CompensationOptions MakeCompensationOptions(const JobSettings& job, const CellSettings& cell) {
  const CompensationSettings& from = job.compensation;
  CompensationOptions options;
  options.deflection = from.deflection;
  options.share = from.shrink;
  options.force = {0.01 * job.force_uncertainty_percent, DegToRad(job.force_direction_deg)};
  options.stiffness.joints.setConstant(kStiffnessUncertainty);
  if (!cell.arm.stiffness_uncertainty.isZero(0.0)) options.stiffness.joints = cell.arm.stiffness_uncertainty;
  if (from.stiffness_uncertainty) options.stiffness.joints.setConstant(*from.stiffness_uncertainty);
  options.stiffness.beside = from.stiffness_uncertainty.value_or(kStiffnessUncertainty);
  options.most = from.most;
  options.which = from.layers;
  options.layers = LayerOffsets(job.toolpath.layers).size();
  options.cutter_radius = cell.tool.cutter_diameter / 2;
  options.beside = MakeCompliances(cell);
  options.deviations = CommandedDeviations(job, cell);
  if (from.weight) {
    const Arm arm = MakeArm(cell.arm);
    const Vector3d tip = cell.tool.tip;
    options.weight = [model = *MakeGravity(cell), arm, tip](const Joints& q) {
      return GravityDeflection(arm, q, model.reference, tip, model.masses, model.counterbalance,
                               model.gravity);
    };
  }
  return options;
}

std::optional<ArmDeviations> CommandedDeviations(const JobSettings& job, const CellSettings& cell) {
  if (!job.compensation.deviations) return std::nullopt;
  return MakeDeviations(*cell.arm.deviations);
}

Stations StationsAsItIs(const JobInputs& inputs, const Stations& stations) {
  const std::optional<ArmDeviations> deviations = CommandedDeviations(inputs.job, inputs.cell);
  if (!deviations) return stations;
  return {World(AsItIs(stations.world().cell(), *deviations)), stations.problem()};
}

size_t CommandForTheArm(const JobInputs& inputs, PlanResult& plan) {
  CompensationOptions options;
  options.deviations = CommandedDeviations(inputs.job, inputs.cell);
  if (!options.deviations) return 0;
  const CompensationCounts counts = Compensate(options, ForcesOf(plan), plan);
  if (counts.largest_arm_shift > inputs.job.compensation.most_deviation)
    throw InputError(
        {inputs.job.file},
        fmt::format("compensation.deviations: the deviations of cell {} move the tip by up to {:.3f} "
                    "mm; allowed: {:.6g} mm (compensation.max_deviation_mm)",
                    inputs.cell.name, counts.largest_arm_shift, inputs.job.compensation.most_deviation));
  if (counts.largest_gear_shift > inputs.job.compensation.most_gear)
    throw InputError(
        {inputs.job.file},
        fmt::format(
            "compensation.deviations: gears and couplings of cell {} move the tip by up to {:.3f} mm; "
            "allowed: {:.6g} mm (compensation.max_gear_mm)",
            inputs.cell.name, counts.largest_gear_shift, inputs.job.compensation.most_gear));
  std::vector<BlockedPiece> unreached;
  for (const auto& [p, i] : counts.out_of_reach)
    unreached.push_back({p, static_cast<size_t>(plan.passes[p].points[i].piece),
                         fmt::format("with its deviations the arm does not reach point {} of the pass within "
                                     "its limits",
                                     i)});
  return LeaveOutPieces(unreached, Infeasibility::kLimit, plan);
}

size_t LeaveOutBlocked(const JobInputs& inputs, const Stations& as_it_is, const Execution& execution,
                       PlanResult& plan) {
  if (!inputs.job.compensation.deviations) return 0;
  std::vector<BlockedPiece> blocked = BlockedWhereCommanded(as_it_is, inputs.job.swept_resolution,
                                                            inputs.job.swept_resolution, execution, plan);
  for (BlockedPiece& piece : blocked) piece.why = "where the arm as it is is commanded, " + piece.why;
  return LeaveOutPieces(blocked, Infeasibility::kInterference, plan);
}

std::vector<std::vector<double>> FeedsOf(const PlanResult& plan) {
  std::vector<std::vector<double>> feeds;
  for (const PassResult& pass : plan.passes) {
    std::vector<double>& own = feeds.emplace_back();
    for (const PlannedPoint& point : pass.points) own.push_back(point.point.feed_rate);
  }
  return feeds;
}

CompensationNotes CompensateJob(const JobInputs& inputs, const Stations& stations,
                                const std::vector<std::vector<double>>& planned_feeds,
                                const Execution& execution, PlanResult& plan) {
  CompensationOptions options = MakeCompensationOptions(inputs.job, inputs.cell);
  const bool mapped = !inputs.job.compensation.map_file.empty();
  if (mapped) options.map = ReadMap(inputs, plan);
  if (!IsOn(options)) return {};
  PointForces forces = ForcesOf(plan);
  if (!inputs.job.force_file.empty())
    forces = ReadMeasuredForces(inputs, plan);
  else if (inputs.job.cutting)
    ScaleToFeeds(inputs, planned_feeds, plan, forces);
  const CompensationCounts counts = Compensate(options, forces, plan);
  if (mapped) CheckOthers(inputs, plan);
  CompensationNotes notes;
  execution.progress.Begin("compensation", 0);
  notes.findings = KeepCommandedFree(stations, options, inputs.job.swept_resolution, execution, plan);
  notes.remains = MedianRemains(options, plan);
  if (options.deviations)
    TellWhatIsLeft(*options.deviations, MakePatterns(*inputs.cell.arm.deviations),
                   FinishedFrom(inputs.job, plan.passes.size()), plan);
  execution.progress.End(fmt::format("{} points shifted", counts.shifted));
  if (counts.cut > 0)
    notes.warnings.push_back(fmt::format(
        "compensation: {} shifts are cut to {:.6g} mm (compensation.max_mm), the largest would be "
        "{:.4f} mm; compensation.csv names the points",
        counts.cut, options.most, counts.largest_cut));
  if (counts.unreached > 0)
    notes.findings.push_back(
        fmt::format("compensation: {} points are not shifted, the arm does not reach the shifted poses",
                    counts.unreached));
  return notes;
}

}  // namespace millpose
