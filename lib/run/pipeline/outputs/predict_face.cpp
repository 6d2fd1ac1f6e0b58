// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/outputs/predict_face.hpp"

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "job/assemble.hpp"
#include "job/bent_part.hpp"
#include "planning/face/fixed_plan.hpp"
#include "run/pipeline/outputs/write_results.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr double kFinest = 0.5;                 // mm, of the spacing that is chosen
constexpr double kRays = 2e5, kMostRays = 4e6;  // for the expected face: chosen, and allowed
constexpr double kFewRays = 1500;               // for each of the drawn ones

double SpacingFor(const Region& region, double rays) {
  return std::sqrt(std::max(CountRays(region, 1.0), 1e-9) / rays);
}

/// What the cell says of its gears, or `options` in its place.
GearModel GearsOf(const JobInputs& inputs, const FaceOptions& options) {
  GearModel gears = MakeGearModel(inputs.cell);
  if (options.lost_motion) {
    gears.lost.width.head<6>().setConstant(*options.lost_motion);
    std::fill_n(gears.known.begin(), 6, true);
  }
  return gears;
}

/// The torques of the arm's weight at its gears, where the cell says what holds them.
std::function<Joints(const Joints&)> WeightIn(const Arm& arm, const GearModel& gears) {
  if (!gears.weights) return {};
  return [&arm, weights = *gears.weights](const Joints& q) {
    return GravityTorques(arm, q, weights.masses, weights.counterbalance, weights.gravity);
  };
}

StatedErrors StatedIn(const JobInputs& inputs, const PlanResult& plan, const GearModel& gears) {
  StatedErrors stated;
  const auto loaded = [](const PlannedPoint& point) {
    return !point.point.engagement.force.isZero(0.0) ||
           (point.compensation && !point.compensation->force.isZero(0.0));
  };
  stated.force = std::ranges::any_of(
      plan.passes, [&](const PassResult& pass) { return std::ranges::any_of(pass.points, loaded); });
  if (stated.force) {
    stated.force_share = 0.01 * inputs.job.force_uncertainty_percent;
    stated.force_angle = DegToRad(inputs.job.force_direction_deg);
  }
  if (std::ranges::find(gears.known, true) != gears.known.end()) stated.lost = gears.lost;
  stated.tip = inputs.cell.tool.tip_uncertainty.value_or(0);
  stated.lean = inputs.cell.tool.axis_uncertainty.value_or(0);
  stated.gears = gears.error;
  stated.geometry = inputs.cell.arm.deviations.has_value();
  if (const std::optional<RegisteredSettings>& part = inputs.job.workpiece.registered) {
    stated.part = RootOfCovariance(part->WholeCovariance());
    stated.part_centre = part->centre;
    if (part->bending) stated.part_bending = part->bending->shape;
  }
  return stated;
}

/// Height of what the last layer takes off, mm over the part's surface; infinite where nobody says it.
double StockOver(const JobSettings& job) {
  const Layers& layers = job.toolpath.layers;
  const std::vector<double> offsets = LayerOffsets(layers);
  if (offsets.size() > 1) return offsets[offsets.size() - 2];
  if (layers.total > 0) return layers.allowance + layers.total;
  if (job.cutting && job.cutting->depth) return layers.allowance + *job.cutting->depth;
  return kInfinity;
}

FaceRays RaysFor(const JobInputs& inputs, const Region& region, double spacing) {
  if (CountRays(region, spacing) > kMostRays)
    throw InputError({inputs.job_file.string()},
                     fmt::format("a spacing of {:.6g} mm makes more than {:g} places on the region; allowed: "
                                 "{:.3g} mm or more",
                                 spacing, kMostRays, SpacingFor(region, kMostRays)));
  FaceRays rays = MakeFaceRays(region, spacing);
  if (rays.rays.empty())
    throw InputError({inputs.job_file.string()},
                     fmt::format("the region holds no place at a spacing of {:.6g} mm", spacing));
  if (const PartBending* bending = BendingOf(inputs.job)) {
    rays.plane = false;
    for (SurfaceRay& ray : rays.rays) {
      ray.normal = bending->BentNormal(ray.origin, ray.normal);
      ray.origin = bending->Bent(ray.origin);
    }
  }
  return rays;
}

}  // namespace

void RequireFace(const JobInputs& inputs) {
  const Strategy& strategy = *inputs.job.toolpath.strategy;
  if (!strategy.HasMillingForce())
    throw InputError({inputs.job_file.string()},
                     fmt::format("strategy {} mills no face to look at; allowed: those that mill a region of "
                                 "the part",
                                 strategy.Name()));
  if (inputs.job.workpiece.mesh_file.empty())
    throw InputError({inputs.job_file.string()},
                     "the job names no part, so that there is no face to look at");
}

FaceReport PredictFace(const JobInputs& inputs, const PlanResult& plan, const Mesh& mesh,
                       const Stations& stations, const FaceOptions& options, const Execution& execution) {
  RequireFace(inputs);
  const Region region(UnbentPart(inputs.job, mesh), MakeToolpathOptions(inputs.job, inputs.cell.tool).region);
  const double spacing = options.spacing > 0 ? options.spacing : std::max(kFinest, SpacingFor(region, kRays));
  FaceReport report;
  report.job = plan.job;
  report.rays = RaysFor(inputs, region, spacing);
  const GearModel gears = GearsOf(inputs, options);
  report.stated = StatedIn(inputs, plan, gears);
  const FaceRays few = RaysFor(inputs, region, std::max(spacing, SpacingFor(region, kFewRays)));
  const CutterShape cutter = MakeCutterShape(inputs.cell.tool);
  const std::vector<SeriesCompliance> compliances = MakeCompliances(inputs.cell);
  const int finished_from = FinishedFrom(inputs.job, plan.passes.size());
  std::optional<ArmDeviations> deviations;
  if (inputs.cell.arm.deviations) deviations = MakeDeviations(*inputs.cell.arm.deviations);
  // A program at a fixed rotation would take out what the plan's do.
  const bool taken_out = inputs.job.compensation.deviations;
  const auto study = [&](const PlanResult& of, bool errs) {
    const ErringPath path(of, compliances, finished_from, WeightIn(of.arm, gears),
                          deviations && errs ? &*deviations : nullptr);
    return StudyFace(path, cutter, report.rays, few, report.stated,
                     {options.draws, inputs.job.seed, StockOver(inputs.job)}, execution);
  };
  report.plan = study(plan, true);
  if (report.plan.flawless.figures.rays == 0)
    throw InputError({inputs.job_file.string()}, "the tool comes near no place of the region");
  report.fixed_in_the_way = options.fixed_in_the_way;
  if (!options.rotation) return report;
  const std::optional<PlanResult> fixed =
      AtFixedRotation(plan, stations, *options.rotation, &report.fixed_in_the_way);
  if (!fixed) return report;
  report.rotation = options.rotation;
  report.fixed = study(*fixed, !taken_out);
  return report;
}

}  // namespace millpose
