// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/outputs/report_parts.hpp"

#include "job/assemble.hpp"
#include "job/raw_stock.hpp"
#include "planning/result/station.hpp"
#include "report/samples/axis_map.hpp"
#include "report/samples/plan_removal.hpp"
#include "report/samples/sample_curves.hpp"
#include "store/cached_stage.hpp"
#include "store/plan_key.hpp"

namespace millpose {
namespace {

constexpr size_t kMostCurves = 1000;  // points whose choice of pose report.html shows

/// The choice of poses at some points.
struct Choices {
  std::vector<PackedCurve> curves;
  AxisMap map;
};

}  // namespace

std::optional<Removal> RemovalOf(const JobInputs& inputs, const PlannedJob& job, const Timeline& timeline,
                                 const Execution& execution) {
  if (!inputs.job.workpiece.HasStock() || timeline.empty()) return std::nullopt;
  return PlanRemoval(job.plan, timeline,
                     {RawStock(inputs), job.prepared.surface.mesh.triangles(), inputs.cut_before,
                      inputs.job.workpiece.stock_resolution},
                     MakeCutterShape(inputs.cell.tool), execution);
}

ReportParts MakeReportParts(const JobInputs& inputs, const PlannedJob& job, const Timeline& timeline,
                            bool full_map, const CheckpointStore& checkpoints, const Execution& execution) {
  const PlanResult& plan = job.plan;
  const PreparedJob& prepared = job.prepared;
  const GeneticOptions genetic = MakePathOptions(inputs.job).genetic;
  const std::string plan_key = KeyOf(plan, execution.Threads());
  const std::string cell = HashOfValues(prepared.cell);
  const Stations stations = prepared.stations.AtOwnAxis();
  Choices choices = Cached<Choices>(
      checkpoints, "choices", StageKey(plan_key, prepared.problem, genetic, full_map ? cell : ""), [&] {
        const std::vector<PointCurves> curves = SampleCurves(plan, stations, genetic, kMostCurves, execution);
        return Choices{Packed(curves), MakeAxisMap(plan, stations, curves, full_map, execution)};
      });
  return {std::move(choices.curves), std::move(choices.map), RemovalOf(inputs, job, timeline, execution)};
}

}  // namespace millpose
