// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/path_job.hpp"

#include "job/assemble.hpp"
#include "run/pipeline/operations/run_job.hpp"

namespace millpose {
namespace {

constexpr size_t kPlacesOfFirst = 16;  // of the first operation that the others are tried at

Mesh NoPart() { return Mesh(Triangles()); }

}  // namespace

std::vector<PathOperation> LayPathOperations(const std::filesystem::path& job, const std::stop_token& stop) {
  std::vector<PathOperation> operations;
  for (JobInputs& inputs : LoadOperations(job, {}, {})) {
    CheckPrograms(inputs);
    Toolpath toolpath = MakeJobToolpath(inputs, NoPart(), stop).toolpath;
    operations.push_back({std::move(inputs), std::move(toolpath)});
  }
  return operations;
}

FacingGroup GroupOfPath(const std::vector<PathOperation>& operations) {
  Eigen::AlignedBox3d box;
  Eigen::Vector3d axes = Eigen::Vector3d::Zero();
  for (const PathOperation& operation : operations)
    for (const Pass& pass : operation.toolpath.passes)
      for (const MillingPoint& point : pass.points) {
        if (point.kind != PointKind::kCut) continue;
        box.extend(point.position);
        axes += point.tool_axis;
      }
  FacingGroup group;
  if (box.isEmpty()) return group;
  if (axes.norm() > 1e-6) group.direction = axes.normalized();
  group.seed = box.center();
  group.lower = box.min();
  group.upper = box.max();
  return group;
}

std::vector<Placement> PlacesOfPath(const std::vector<PathOperation>& operations, size_t most,
                                    const std::stop_token& stop) {
  const FacingGroup group = GroupOfPath(operations);
  ImportReport bounds;
  bounds.lower = group.lower;
  bounds.upper = group.upper;
  const JobInputs& first = operations.front().inputs;
  const Cell cell = MakeCell(first.cell, first.body_bytes);
  std::vector<Placement> places = LikelyPlacements(group, bounds, cell, first.cell.home);
  for (size_t i = 0; i < operations.size(); ++i)
    places = ReachedPlacements(operations[i].inputs, NoPart(), operations[i].toolpath, places,
                               i + 1 == operations.size() ? most : kPlacesOfFirst, stop);
  return places;
}

TriedJob TryOperations(const std::vector<PathOperation>& operations, size_t most_points,
                       const CheckpointStore& checkpoints, const Execution& execution) {
  TriedJob sum;
  for (const PathOperation& operation : operations) {
    const JobInputs& inputs = operation.inputs;
    const TriedJob tried = TryJob(inputs, most_points, checkpoints, execution);
    sum.passes += tried.passes;
    sum.of_passes += tried.of_passes;
    sum.points += tried.points;
    sum.of_points += tried.of_points;
    sum.problem = tried.problem.empty() || inputs.job.operation.empty()
                      ? tried.problem
                      : inputs.job.operation + ": " + tried.problem;
    if (!sum.problem.empty()) return sum;
  }
  return sum;
}

}  // namespace millpose
