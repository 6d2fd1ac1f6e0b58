// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/workpiece.hpp"

#include <Eigen/Geometry>

#include "base/error.hpp"
#include "base/process.hpp"
#include "geometry/import/step_reader.hpp"
#include "job/assemble.hpp"
#include "job/bent_part.hpp"
#include "job/raw_stock.hpp"
#include "machine/robot/kinematics.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/stock/standing_stock.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

// Points that the path may have: as asked for, and no more than the machine's memory holds.
PointBudget MakeBudget(const JobInputs& inputs, const Mesh& mesh) {
  constexpr double kBytesPerPoint = 5e3;  // docs/cluster.md measured 4.4 kB
  PointBudget budget;
  budget.most = inputs.max_points;
  const double memory = MachineMemory();
  if (memory / kBytesPerPoint < budget.most) {
    budget.most = memory / kBytesPerPoint;
    budget.set_by = fmt::format("{:.0f} MB of memory", memory / 1e6);
  }
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh.triangles().vertices) box.extend(p);
  const double size = box.isEmpty() ? 0 : box.sizes().maxCoeff();
  const double reach = Reach(MakeArm(inputs.cell.arm), inputs.cell.tool.tip);
  if (const auto doubt = UnitWarning(size, reach); doubt && size > reach) budget.unit_doubt = *doubt;
  return budget;
}

}  // namespace

double Reach(const Arm& arm, const Eigen::Vector3d& p_FT) { return ArmLength(arm) + p_FT.norm(); }

double Reach(const Cell& cell) { return Reach(cell.arm, cell.X_FT.translation()); }

std::string SurfaceStage(const JobInputs& inputs) {
  const WorkpieceSettings& workpiece = inputs.job.workpiece;
  return SurfaceStage(inputs.workpiece_bytes, workpiece.step_seconds, workpiece.step_memory);
}

std::string SurfaceStage(std::string_view mesh, int seconds, int memory_MB) {
  const std::optional<CadFormat> format = CadFormatOf(mesh);
  if (!format) return "surface";
  return fmt::format("surface ({}: at most {} s, {} MB)", NameOf(*format), seconds, memory_MB);
}

namespace {

/// The part as its file has it.
ImportResult ImportPart(const JobInputs& inputs) {
  const WorkpieceSettings& workpiece = inputs.job.workpiece;
  ImportOptions options;
  options.unit = workpiece.unit;
  options.weld_tolerance = workpiece.weld_tolerance;
  options.flip = workpiece.flip;
  return ImportMesh(ReadMesh(inputs.workpiece_bytes, workpiece.mesh_file, MakeStepOptions(workpiece)),
                    options, workpiece.mesh_file);
}

}  // namespace

Part ReadPart(const JobInputs& inputs, const Cell& cell) {
  const std::string& name = inputs.job.workpiece.mesh_file;
  if (name.empty()) {
    Part none{{Mesh(Triangles{}), {}}, CellWarnings(inputs.cell)};
    none.warnings.emplace_back(
        "no part is given: the tool axes serve as normals, and interference with the part is not checked");
    return none;
  }
  Part part{ImportPart(inputs), CellWarnings(inputs.cell)};
  if (BendingOf(inputs.job)) part.import.mesh = Mesh(BentPart(inputs.job, part.import.mesh.triangles()));
  for (const std::string& finding : Findings(part.import.report))
    part.warnings.push_back(fmt::format("{}: {}", name, finding));
  const Eigen::Vector3d size = part.import.report.upper - part.import.report.lower;
  if (const auto warning = UnitWarning(size.maxCoeff(), Reach(cell)))
    part.warnings.push_back(name + ": " + *warning);
  return part;
}

namespace {

// The file's speed holds in place of the job's; what the cutter takes off is computed at the job's.
void CompareSpeeds(const JobSettings& job, const std::string& file, JobToolpath& made) {
  constexpr double kSameSpeed = 0.05 / 60;  // rev/s
  if (!made.spindle_speed || std::abs(*made.spindle_speed - job.spindle_speed) <= kSameSpeed) return;
  const std::string differ =
      fmt::format("the file turns the spindle at {:.6g}/min, process.spindle_rpm says {:.6g}",
                  60 * *made.spindle_speed, 60 * job.spindle_speed);
  if (job.cutting)
    throw InputError({file}, differ +
                                 ": process.cutting needs them to be the same (or toolpath.cam.spindle: "
                                 "cell, which takes the job's)");
  made.warnings.push_back(
      fmt::format("{}: {}: the file's holds (toolpath.cam.spindle: cell takes the job's)", file, differ));
}

}  // namespace

namespace {

/// What stands of the raw part when the job begins. Throws InputError for a part that was registered as bent.
StandingColumns StockOf(const JobInputs& inputs, int threads, const std::stop_token& stop) {
  if (BendingOf(inputs.job))
    throw InputError({}, fmt::format("toolpath.strategy: given {}; the part was registered as bent, and its "
                                     "stock is known as it is bent only; allowed: other strategies, or a "
                                     "registration without bending",
                                     inputs.job.toolpath.strategy->Name()));
  StandingStock stock(RawStock(inputs), inputs.job.workpiece.stock_resolution);
  for (const CutsOfTool& cuts : inputs.cut_before) stock.Remove(cuts.cutter, cuts.motions, threads, stop);
  StandingColumns columns{stock.spacing()};
  stock.ForEachSpan([&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    columns.columns.push_back({from, to});
  });
  return columns;
}

}  // namespace

JobToolpath MakeJobToolpath(const JobInputs& inputs, const Mesh& mesh, std::stop_token stop, int parts,
                            int threads) {
  ToolpathOptions options = MakeToolpathOptions(inputs.job, inputs.cell.tool);
  options.parts = parts;
  options.budget = MakeBudget(inputs, mesh);
  options.budget.most *= parts;  // few of these points are planned
  // Regions, planes and files are stated of the unbent part.
  const PartBending* bending = BendingOf(inputs.job);
  const Mesh unbent = bending && mesh.face_count() > 0 ? ImportPart(inputs).mesh : mesh;
  StandingColumns stock;
  if (options.strategy->NeedsStock()) stock = StockOf(inputs, threads, stop);
  LaidPath laid =
      options.strategy->Make({unbent, options, inputs.path_bytes, &stock, threads}, std::move(stop));
  if (bending) CarryToBent(*bending, laid.toolpath);
  JobToolpath made;
  made.toolpath = std::move(laid.toolpath);
  made.warnings = std::move(laid.warnings);
  made.findings = std::move(laid.findings);
  made.notes = std::move(laid.notes);
  made.holes_left_out = std::move(laid.holes_left_out);
  made.source = std::move(laid.source);
  made.spindle_speed = laid.spindle_speed;
  CompareSpeeds(inputs.job, options.strategy->File(), made);
  return made;
}

namespace {

/// What gouges at the nominal lean may be clear at another: the pose search asks for each (LeanGouges).
void LeaveToLeans(Toolpath& toolpath) {
  for (Pass& pass : toolpath.passes)
    for (MillingPoint& point : pass.points) point.gouge = 0;
}

}  // namespace

void CheckJobGouges(const JobInputs& inputs, const Mesh& mesh, const Execution& execution,
                    JobToolpath& made) {
  const GougeOptions& options = inputs.job.toolpath.gouges;
  made.gouges = CheckGouges(mesh, MakeCutterShape(inputs.cell.tool), options, execution, made.toolpath);
  const GougeReport& found = made.gouges;
  if (found.points == 0) return;
  const Eigen::Vector3d& place = found.deepest.place;
  std::string sentence = fmt::format(
      "toolpath: the cutter would go up to {:.3f} mm into the part at {} points (deepest at {:.3f}, {:.3f}, "
      "{:.3f} mm in the workpiece frame; allowed: {} mm)",
      found.deepest.depth, found.points, place.x(), place.y(), place.z(), options.tolerance);
  if (found.leads_left_out > 0)
    made.warnings.push_back(
        fmt::format("toolpath: {} leads are left out, because the cutter would go into the "
                    "part on them",
                    found.leads_left_out));
  if (options.action == GougeAction::kReport) {
    made.findings.push_back(sentence + "; they stay in the path (gouges: {action: report})");
  } else if (options.action == GougeAction::kLift) {
    made.warnings.push_back(sentence +
                            fmt::format("; the tool is lifted there by up to {:.3f} mm", found.largest_lift));
  } else {
    // What gouges may be a lead or a place between points: then nothing that was asked for is missing.
    size_t skipped = 0;
    for (const Pass& pass : made.toolpath.passes)
      for (const MillingPoint& point : pass.points) skipped += point.gouge > 0;
    if (skipped > 0 && inputs.job.toolpath.Leans()) {
      LeaveToLeans(made.toolpath);
      sentence += fmt::format("; {} points are planned at another lean or skipped", skipped);
    } else if (skipped > 0) {
      sentence += fmt::format("; {} points are skipped", skipped);
    }
    made.warnings.push_back(sentence);
  }
}

namespace {

/// A pass in P as it is in W while the part moves along it.
Pass Moving(const Stations& stations, const ExternalCourse& course, Pass pass) {
  const Cell& cell = stations.world().cell();
  const Mechanism mechanism(cell.external_axes);
  const std::vector<ExternalPosition> positions = PositionsAlong(course, pass);
  for (size_t t = 0; t < pass.points.size(); ++t) {
    Pass one;
    one.points.push_back(std::move(pass.points[t]));
    Transform(mechanism.Moved(Carries::kWorkpiece, positions[t]) * cell.X_WP, one);
    pass.points[t] = std::move(one.points.front());
  }
  return pass;
}

}  // namespace

Toolpath PlacedToolpath(const JobInputs& inputs, const Toolpath& toolpath, const Pose& X_WP) {
  Toolpath placed = Transformed(toolpath, X_WP);
  for (Pass& pass : placed.passes) pass.rotation_reference = inputs.job.toolpath.world_reference.normalized();
  return placed;
}

Toolpath AtStations(const JobInputs& inputs, const Toolpath& toolpath, const Stations& stations,
                    const std::vector<ExternalCourse>& external) {
  Toolpath placed = toolpath;
  for (size_t i = 0; i < placed.passes.size(); ++i) {
    if (external[i].Moves())
      placed.passes[i] = Moving(stations, external[i], EndingWhereItBegan(std::move(placed.passes[i])));
    else
      Transform(stations.At(external[i].from).world.cell().X_WP, placed.passes[i]);
    placed.passes[i].rotation_reference = inputs.job.toolpath.world_reference.normalized();
  }
  return placed;
}

size_t CountPoints(const Toolpath& toolpath) {
  size_t count = 0;
  for (const Pass& pass : toolpath.passes) count += pass.points.size();
  return count;
}

}  // namespace millpose
