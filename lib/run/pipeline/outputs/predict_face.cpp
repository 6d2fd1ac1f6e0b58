// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/outputs/predict_face.hpp"

#include "base/error.hpp"
#include "job/assemble.hpp"
#include "planning/face/fixed_plan.hpp"
#include "run/pipeline/outputs/write_results.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr double kFinest = 0.5;                 // mm, of the spacing that is chosen
constexpr double kRays = 2e5, kMostRays = 4e6;  // for the expected face: chosen, and allowed
constexpr double kFewRays = 4000;               // for each of the drawn ones

double SpacingFor(const Region& region, double rays) {
  return std::sqrt(std::max(CountRays(region, 1.0), 1e-9) / rays);
}

StatedErrors StatedIn(const JobInputs& inputs, const PlanResult& plan, const FaceOptions& options) {
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
  if (options.lost_motion) {
    stated.lost = LostMotion();
    stated.lost->width.head<6>().setConstant(*options.lost_motion);
  }
  stated.tip = inputs.cell.tool.tip_uncertainty.value_or(0);
  stated.lean = inputs.cell.tool.axis_uncertainty.value_or(0);
  return stated;
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
  const Region region(mesh, MakeToolpathOptions(inputs.job, inputs.cell.tool).region);
  const double spacing = options.spacing > 0 ? options.spacing : std::max(kFinest, SpacingFor(region, kRays));
  FaceReport report;
  report.job = plan.job;
  report.rays = RaysFor(inputs, region, spacing);
  report.stated = StatedIn(inputs, plan, options);
  const FaceRays few = RaysFor(inputs, region, std::max(spacing, SpacingFor(region, kFewRays)));
  const CutterShape cutter = MakeCutterShape(inputs.cell.tool);
  const std::vector<SeriesCompliance> compliances = MakeCompliances(inputs.cell);
  const int finished_from = FinishedFrom(inputs.job, plan.passes.size());
  const auto study = [&](const PlanResult& of) {
    return StudyFace(ErringPath(of, compliances, finished_from), cutter, report.rays, few, report.stated,
                     {options.draws, inputs.job.seed}, execution);
  };
  report.plan = study(plan);
  if (report.plan.flawless.figures.rays == 0)
    throw InputError({inputs.job_file.string()}, "the tool comes near no place of the region");
  report.fixed_in_the_way = options.fixed_in_the_way;
  if (!options.rotation) return report;
  const std::optional<PlanResult> fixed =
      AtFixedRotation(plan, stations, *options.rotation, &report.fixed_in_the_way);
  if (!fixed) return report;
  report.rotation = options.rotation;
  report.fixed = study(*fixed);
  return report;
}

}  // namespace millpose
