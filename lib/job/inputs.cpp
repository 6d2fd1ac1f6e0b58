// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/inputs.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"
#include "job/arrival.hpp"
#include "job/assemble.hpp"
#include "job/cell_texts.hpp"
#include "job/compensate_job.hpp"
#include "job/config/config.hpp"
#include "job/controller_zero.hpp"
#include "job/exclude_pairs.hpp"
#include "job/external_positions.hpp"
#include "job/lean_freedoms.hpp"
#include "job/locate.hpp"
#include "job/origin.hpp"
#include "job/resolve_tools.hpp"
#include "job/resolve_urdf.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

// Runs `step`; what is wrong with its input joins `problems` so that the user sees everything at once.
template <class Step>
void Collect(std::vector<Problem>& problems, Step step) {
  try {
    step();
  } catch (const InputError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
}

// A link without a body would never be seen to touch. Link 6 carries the tool's stack.
void CheckLinks(const CellSettings& cell, std::vector<Problem>& problems) {
  for (int link = 0; link < 6; ++link) {
    const bool named = std::ranges::find(cell.unchecked_links, link) != cell.unchecked_links.end();
    const MountSettings on_it{Mount::kLink, link};
    const bool has_body = std::ranges::find(cell.bodies, on_it, &BodySettings::mount) != cell.bodies.end();
    const std::string mount = WordOf(kLinkWords, link);
    if (named && has_body)
      problems.push_back(
          {{cell.file, cell.bodies_line},
           fmt::format("interference.unchecked_links: {0} has a body; allowed: links without", mount)});
    if (!named && !has_body)
      problems.push_back(
          {{cell.file, cell.bodies_line},
           fmt::format(
               "bodies: {0} has no body, so its interference would never be found; add one with mount: "
               "{0}, or name it in interference.unchecked_links",
               mount)});
  }
}

// Limits that couple axes bind something, leave something, and do not ask which revolution an axis is in.
void CheckCoupledLimits(const CellSettings& cell, std::vector<Problem>& problems) {
  const ArmSettings& arm = cell.arm;
  for (size_t i = 0; i < arm.coupled_limits.size(); ++i) {
    const CoupledLimit& limit = arm.coupled_limits[i];
    const auto add = [&](const std::string& what) {
      problems.push_back(
          {{cell.file, arm.coupled_line}, fmt::format("arm.coupled_limits_deg[{}]: {}", i, what)});
    };
    double least = 0, most = 0;  // of the sum within the axes' own limits
    for (int j = 0; j < 6; ++j) {
      const double factor = limit.factors[j], a = factor * arm.lower[j], b = factor * arm.upper[j];
      least += std::min(a, b);
      most += std::max(a, b);
      if (factor != 0 && arm.upper[j] - arm.lower[j] >= 2 * kPi)
        add(fmt::format("axis {} has limits of a revolution and more; allowed: axes with less", j + 1));
    }
    if (most <= limit.at_most)
      add(fmt::format("has no effect: within limits_deg the sum is at most {:.6g}°", RadToDeg(most)));
    if (least > limit.at_most)
      add(fmt::format("leaves nothing: within limits_deg the sum is at least {:.6g}°", RadToDeg(least)));
    if (const double beyond = limit.Beyond(cell.home); beyond > kRevolutionRounding && most > limit.at_most)
      add(fmt::format("home_deg is beyond it: {}", CoupledText(limit, cell.home)));
  }
}

// What a controller cannot run needs no settings either.
std::vector<Problem> CheckControllers(const CellSettings& cell) {
  std::vector<Problem> problems;
  for (const auto& [controller, settings] : cell.controllers)
    if (const std::string refusal = NoProgramsFor(cell.arm, controller); !refusal.empty())
      problems.push_back({{cell.file, cell.controllers_line}, "controllers: " + refusal});
  return problems;
}

// The largest depth of cut that a job asks for must be one that the cutter has edges for, its ramps such as
// the cutter can go down.
void CheckCutter(const JobInputs& inputs, std::vector<Problem>& problems) {
  const JobSettings& job = inputs.job;
  const double length = inputs.cell.tool.cutting_length;
  const auto check = [&](const char* key, double depth) {
    if (depth > length)
      problems.push_back(
          {{job.file},
           fmt::format("{}: given {:.6g}; allowed: at most tool.cutter.cutting_length_mm of cell {}, "
                       "{:.6g}, above which the cutter does not cut",
                       key, depth, inputs.cell.name, length)});
  };
  const PassEnds& ends = job.toolpath.ends;
  const double steepest = inputs.cell.tool.max_ramp;
  if (ends.lead == LeadShape::kAlong && ends.ramp_angle > steepest + 1e-12)
    problems.push_back({{job.file},
                        fmt::format("toolpath.ends.ramp_deg: given {:.6g}; allowed: at most "
                                    "tool.cutter.max_ramp_deg of cell {}, {:.6g}",
                                    RadToDeg(ends.ramp_angle), inputs.cell.name, RadToDeg(steepest))});
  if (job.cutting) check("process.cutting.depth_mm", job.cutting->depth.value_or(0));
  check("toolpath.depth.per_layer_mm", std::min(job.toolpath.layers.total, job.toolpath.layers.per_layer));
}

// A body's name tells it from all others, in findings and where plans are kept.
void CheckFixtures(const JobInputs& inputs, std::vector<Problem>& problems) {
  std::vector<std::string> names{"workpiece", "stock"};
  for (const BodySettings& body : inputs.cell.bodies) names.push_back(body.name);
  for (const ToolPartSettings& part : inputs.cell.tool.stack) names.push_back(part.name);
  const std::vector<FixtureSettings>& fixtures = inputs.job.workpiece.fixtures;
  for (size_t i = 0; i < fixtures.size(); ++i) {
    if (std::ranges::find(names, fixtures[i].name) != names.end())
      problems.push_back(
          {{inputs.job.file},
           fmt::format("workpiece.fixtures[{}].name: given {}; allowed: a name that no other body of the "
                       "job and of cell {} has",
                       i, fixtures[i].name, inputs.cell.name)});
    names.push_back(fixtures[i].name);
  }
}

/// A job without programs is planned in a cell whose controllers do not know its external axes.
void CheckProgrammedAxes(const JobInputs& inputs) {
  if (inputs.cell.external_axes.empty()) return;
  for (const std::string& controller : inputs.job.programs)
    if (inputs.cell.controllers.contains(controller)) MakePostSettings(inputs.job, inputs.cell, controller);
}

}  // namespace

std::vector<std::string> CellWarnings(const CellSettings& cell) {
  std::vector<std::string> warnings = cell.warnings;
  std::vector<std::string> unchecked;
  for (const int link : cell.unchecked_links) unchecked.push_back(WordOf(kLinkWords, link));
  if (!unchecked.empty())
    warnings.push_back(fmt::format("{}: interference of {} is not checked (interference.unchecked_links)",
                                   cell.name, fmt::join(unchecked, ", ")));
  return warnings;
}

CellSettings LoadCell(const std::filesystem::path& cell_file, std::map<std::string, std::string>* body_bytes,
                      const FileRoot& root, const std::optional<PoseSettings>& base) {
  std::string text = root.Read(cell_file);
  CellSettings cell = ParseCell(text, cell_file.string());
  cell.text = std::move(text);
  if (base) cell.base_in_world = *base;
  cell.stated_base = cell.base_in_world;
  const bool from_urdf = !cell.arm.urdf.file.empty();
  ResolveTools(cell_file.parent_path(), root, &cell);
  ResolveUrdf(cell_file.parent_path(), root, &cell);
  std::vector<Problem> problems = CheckControllers(cell);
  if (problems.empty()) problems = SettleControllerZeros(from_urdf, &cell);
  if (problems.empty()) problems = CheckCellTexts(cell);
  CheckLinks(cell, problems);
  CheckCoupledLimits(cell, problems);
  for (const BodySettings& body : cell.bodies) {
    if (body.shape.kind != ShapeKind::kMesh || body_bytes->contains(body.shape.mesh_file)) continue;
    Collect(problems, [&] {
      (*body_bytes)[body.shape.mesh_file] = root.Read(cell_file.parent_path() / body.shape.mesh_file);
    });
  }
  if (from_urdf && problems.empty()) problems = CheckLinkMeshes(cell, *body_bytes);
  if (!problems.empty()) throw InputError(std::move(problems));
  ExcludeTouchingNeighbours(*body_bytes, from_urdf, &cell);
  return cell;
}

JobInputs LoadJobInputs(const std::filesystem::path& job_file, const std::vector<Override>& overrides,
                        const std::optional<std::filesystem::path>& origin, const FileRoot& root,
                        std::optional<size_t> operation) {
  JobInputs inputs;
  inputs.job_file = job_file;
  inputs.job_text = root.Read(job_file);
  inputs.operation = operation;
  inputs.job = ParseJob(inputs.job_text, job_file.string(), overrides, operation);
  inputs.folder = origin ? *origin : OriginOf(job_file, inputs.job.cell_file, root);
  const std::filesystem::path& folder = inputs.folder;
  std::vector<Problem> problems;
  Collect(problems, [&] {
    inputs.cell = LoadCell(folder / inputs.job.cell_file, &inputs.body_bytes, root, inputs.job.base_in_world);
  });
  if (problems.empty()) Collect(problems, [&] { SelectTool(inputs.job.tool, &inputs.cell); });
  if (problems.empty() && inputs.job.objective_open && MakeGearModel(inputs.cell).lost.Any())
    inputs.job.objective = TheObjective(&ObjectiveEntry::with_lost_motion).name;
  if (!inputs.job.workpiece.mesh_file.empty())
    Collect(problems, [&] { inputs.workpiece_bytes = root.Read(folder / inputs.job.workpiece.mesh_file); });
  if (!inputs.job.workpiece.stock_file.empty())
    Collect(problems, [&] { inputs.stock_bytes = root.Read(folder / inputs.job.workpiece.stock_file); });
  if (!inputs.job.force_file.empty())
    Collect(problems, [&] { inputs.force_bytes = root.Read(folder / inputs.job.force_file); });
  if (!inputs.job.compensation.map_file.empty())
    Collect(problems, [&] { inputs.map_bytes = root.Read(folder / inputs.job.compensation.map_file); });
  if (const std::string file = inputs.job.toolpath.strategy->File(); !file.empty())
    Collect(problems, [&] { inputs.path_bytes = root.Read(folder / file); });
  if (inputs.job.placement)
    for (const KeepOutSettings& body : inputs.job.placement->keep_out)
      if (body.shape.kind == ShapeKind::kMesh)
        Collect(problems, [&] {
          inputs.keep_out_bytes[body.shape.mesh_file] = root.Read(folder / body.shape.mesh_file);
        });
  for (const FixtureSettings& fixture : inputs.job.workpiece.fixtures)
    if (fixture.shape.kind == ShapeKind::kMesh)
      Collect(problems, [&] {
        inputs.fixture_bytes[fixture.shape.mesh_file] = root.Read(folder / fixture.shape.mesh_file);
      });
  if (problems.empty()) CheckFixtures(inputs, problems);
  if (problems.empty()) CheckCutter(inputs, problems);
  if (problems.empty()) CheckLeanRanges(inputs, problems);
  if (problems.empty()) problems = CheckExternal(inputs.job, inputs.cell);
  if (problems.empty()) Collect(problems, [&] { CheckProgrammedAxes(inputs); });
  if (problems.empty()) problems = CheckAlongCuts(inputs.job, inputs.cell);
  if (problems.empty()) problems = CheckCompensation(inputs.job, inputs.cell);
  if (!problems.empty()) throw Located(InputError(std::move(problems)), inputs);
  inputs.hash = HashOf(inputs);
  return inputs;
}

std::string PlannedJobText(JobSettings job) {
  job.placement.reset();
  return WriteJob(job);
}

std::string HashOf(const JobInputs& inputs) {
  std::string all = PlannedJobText(inputs.job) + '\0' + WriteCell(inputs.cell) + '\0' +
                    Hash(inputs.workpiece_bytes) + '\0' + Hash(inputs.stock_bytes) + '\0' +
                    Hash(inputs.path_bytes);
  if (!inputs.job.force_file.empty()) all += '\0' + Hash(inputs.force_bytes);
  if (!inputs.job.compensation.map_file.empty()) all += '\0' + Hash(inputs.map_bytes);
  for (const auto* bodies : {&inputs.body_bytes, &inputs.fixture_bytes})
    for (const auto& [name, bytes] : *bodies) all += '\0' + name + '\0' + Hash(bytes);
  return Hash(all);
}

}  // namespace millpose
