// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/narrow_inputs.hpp"

#include "store/cached_pass.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

/// How well a tool is known is a matter of reports.
void Forget(ToolSettings& tool) { tool.tip_uncertainty = tool.axis_uncertainty = std::nullopt; }

}  // namespace

JobInputs InputsOfToolpath(const JobInputs& inputs) {
  JobInputs narrow;
  JobSettings& job = narrow.job;
  job.file = inputs.job.file;
  job.workpiece = inputs.job.workpiece;
  job.workpiece.fixtures.clear();
  job.toolpath = inputs.job.toolpath;
  job.feed = inputs.job.feed;
  job.plunge_feed = inputs.job.plunge_feed;
  job.retract_feed = inputs.job.retract_feed;
  job.spindle_speed = inputs.job.spindle_speed;
  job.cutting = inputs.job.cutting;
  if (job.cutting) job.cutting->kc11_source.clear();
  job.stock = inputs.job.stock;
  job.force_factors = inputs.job.force_factors;
  narrow.cell.file = inputs.cell.file;
  narrow.cell.name = inputs.cell.name;
  narrow.cell.arm = inputs.cell.arm;
  narrow.cell.tool = inputs.cell.tool;
  Forget(narrow.cell.tool);
  narrow.workpiece_bytes = inputs.workpiece_bytes;
  narrow.stock_bytes = inputs.stock_bytes;
  narrow.path_bytes = inputs.path_bytes;
  if (inputs.job.stock == Standing::kMesh || job.toolpath.strategy->NeedsStock())
    narrow.cut_before = inputs.cut_before;
  narrow.max_points = inputs.max_points;
  narrow.hash = HashOf(narrow);
  return narrow;
}

JobInputs InputsOfProgram(const JobInputs& inputs, const std::string& controller) {
  const JobSettings defaults;
  JobInputs narrow = inputs;
  narrow.job.programs = {controller};
  narrow.job.min_feed_share = defaults.min_feed_share;
  narrow.job.exhaustive_step = defaults.exhaustive_step;
  std::erase_if(narrow.cell.controllers, [&](const auto& entry) { return entry.first != controller; });
  Forget(narrow.cell.tool);
  for (ToolSettings& tool : narrow.cell.tools) Forget(tool);
  narrow.hash = HashOf(narrow);
  return narrow;
}

JobInputs WithoutPlaces(JobInputs inputs) {
  for (BodySettings& body : inputs.cell.bodies) {
    if (!IsObstacle(body.body_class, body.mount.mount)) continue;
    body.shape = {};
    body.pose = {};
  }
  for (FixtureSettings& fixture : inputs.job.workpiece.fixtures) {
    fixture.shape = {};
    fixture.pose = {};
  }
  inputs.hash = HashOf(inputs);
  return inputs;
}

}  // namespace millpose
