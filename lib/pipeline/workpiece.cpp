// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workpiece.hpp"

#include <Eigen/Geometry>

#include "base/error.hpp"
#include "base/process.hpp"
#include "pipeline/assemble.hpp"
#include "robot/kinematics.hpp"
#include "surface/step_reader.hpp"
#include "toolpath/cam_import.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

// Cutters of the file that are not the cell's.
void TellOtherCutters(const CamPath& path, const ToolSettings& tool, const std::string& file,
                      std::vector<std::string>& warnings) {
  constexpr double kSame = 1e-3;  // mm
  for (const CamCutter& cutter : path.cutters)
    if (std::abs(cutter.diameter - tool.cutter_diameter) > kSame)
      warnings.push_back(fmt::format("{}:{}: the path is for a cutter of {:.6g} mm, the cell's has {:.6g} mm",
                                     file, cutter.line, cutter.diameter, tool.cutter_diameter));
}

std::string NotMachined(const CamHole& hole) {
  return fmt::format("{} in line {} at ({:.3f}, {:.3f}, {:.3f}) mm of the workpiece: {}", hole.cycle,
                     hole.line, hole.position.x(), hole.position.y(), hole.position.z(), hole.why);
}

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

// A CAM path in P, its notes and its distance from the mesh.
JobToolpath ImportCam(const JobInputs& inputs, const Mesh& mesh) {
  const ToolpathSettings& settings = inputs.job.toolpath;
  std::vector<RotaryAxis> axes;
  for (const CamRotaryAxisSettings& axis : settings.cam_rotary_axes)
    axes.push_back({axis.axis[0], axis.direction.normalized(), axis.point, axis.carries == "workpiece"});
  CamReadOptions read;
  read.chord_tolerance = settings.chord_tolerance;
  read.rotary_axes = RotaryAxes(std::move(axes));
  read.circle = settings.cam_circle == "axis"      ? CircleWay::kAxis
                : settings.cam_circle == "tangent" ? CircleWay::kTangent
                                                   : CircleWay::kBoth;
  read.tip_programming = settings.cam_tip_programming;
  for (const auto& [code, meaning] : settings.cam_kinematics_codes)
    read.kinematics_codes[std::stoi(code.substr(1))] = meaning == "tip";
  const CamPath path = ReadCamPath(inputs.cam_bytes, settings.cam_file, read);
  CamImportOptions options;
  options.spacing = settings.spacing;
  options.crease = settings.crease;
  options.contact_distance = settings.cam_contact_distance;
  options.feed_rate = inputs.job.feed;
  if (inputs.cell.tool.cutter_shape == "ball") options.ball_radius = inputs.cell.tool.cutter_diameter / 2;
  options.budget = MakeBudget(inputs, mesh);
  CamImportReport report;
  JobToolpath made;
  made.toolpath = ImportCamPath(path, mesh.face_count() > 0 ? &mesh : nullptr, options, &report);
  TellOtherCutters(path, inputs.cell.tool, settings.cam_file, made.warnings);
  for (const std::string& note : path.notes) made.notes.push_back(settings.cam_file + ": " + note);
  for (const CamHole& hole : path.holes_left_out) made.holes_left_out.push_back(NotMachined(hole));
  if (report.turns_on_the_spot > 0)
    made.warnings.push_back(fmt::format("{}: the tool turns on the spot {} times; passes end there",
                                        settings.cam_file, report.turns_on_the_spot));
  if (report.largest_distance && *report.largest_distance > settings.cam_contact_distance)
    made.warnings.push_back(
        fmt::format("{}: points lie up to {:.3f} mm from the part (median {:.3f} mm); is the "
                    "path given in the workpiece frame?",
                    settings.cam_file, *report.largest_distance, *report.median_distance));
  return made;
}

}  // namespace

double Reach(const Arm& arm, const Eigen::Vector3d& p_FT) { return ArmLength(arm) + p_FT.norm(); }

double Reach(const Cell& cell) { return Reach(cell.arm, cell.X_FT.translation()); }

std::string SurfaceStage(const JobInputs& inputs) {
  const WorkpieceSettings& workpiece = inputs.job.workpiece;
  return SurfaceStage(inputs.workpiece_bytes, workpiece.step_seconds, workpiece.step_memory);
}

std::string SurfaceStage(std::string_view mesh, int seconds, int memory_MB) {
  if (!LooksLikeStep(mesh)) return "surface";
  return fmt::format("surface (STEP: at most {} s, {} MB)", seconds, memory_MB);
}

Part ReadPart(const JobInputs& inputs, const Cell& cell) {
  const std::string& name = inputs.job.workpiece.mesh_file;
  if (name.empty()) {
    Part none{{Mesh(Triangles{}), {}}, CellWarnings(inputs.cell)};
    none.warnings.emplace_back(
        "no part is given: the tool axes serve as normals, and interference with the part is not looked at");
    return none;
  }
  ImportOptions options;
  options.unit = inputs.job.workpiece.unit;
  options.weld_tolerance = inputs.job.workpiece.weld_tolerance;
  options.flip = inputs.job.workpiece.flip;
  Part part{ImportMesh(ReadMesh(inputs.workpiece_bytes, name, MakeStepOptions(inputs.job.workpiece)), options,
                       name),
            CellWarnings(inputs.cell)};
  for (const std::string& finding : Findings(part.import.report))
    part.warnings.push_back(name + ": " + finding);
  const Eigen::Vector3d size = part.import.report.upper - part.import.report.lower;
  if (const auto warning = UnitWarning(size.maxCoeff(), Reach(cell)))
    part.warnings.push_back(name + ": " + *warning);
  return part;
}

JobToolpath MakeJobToolpath(const JobInputs& inputs, const Mesh& mesh, std::stop_token stop) {
  if (inputs.job.toolpath.strategy == "cam") return ImportCam(inputs, mesh);
  JobToolpath made;
  ToolpathOptions options = MakeToolpathOptions(inputs.job, inputs.cell.tool);
  options.budget = MakeBudget(inputs, mesh);
  made.toolpath = MakeToolpath(mesh, options, stop);
  for (const std::string& note : made.toolpath.notes) made.warnings.push_back("toolpath: " + note);
  return made;
}

void CheckJobGouges(const JobInputs& inputs, const Mesh& mesh, int threads, JobToolpath& made,
                    std::stop_token stop) {
  const GougeOptions options = MakeGougeOptions(inputs.job);
  made.gouges =
      CheckGouges(mesh, MakeCutterShape(inputs.cell.tool), options, threads, made.toolpath, std::move(stop));
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
    made.warnings.push_back(sentence + "; they are skipped");
  }
}

Toolpath PlacedToolpath(const JobInputs& inputs, const Toolpath& toolpath, const Pose& X_WP) {
  Toolpath placed = Transformed(toolpath, X_WP);
  for (Pass& pass : placed.passes)
    pass.rotation_reference = inputs.job.toolpath.rotation_reference.normalized();
  return placed;
}

size_t CountPoints(const Toolpath& toolpath) {
  size_t count = 0;
  for (const Pass& pass : toolpath.passes) count += pass.points.size();
  return count;
}

}  // namespace millpose
