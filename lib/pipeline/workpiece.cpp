// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/workpiece.hpp"

#include "base/error.hpp"
#include "pipeline/assemble.hpp"
#include "toolpath/cam_import.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

// How far the tool tip can come from axis 1, mm: what a part's size is compared with.
double Reach(const Cell& cell) {
  return cell.arm.a1 + cell.arm.a2 + std::hypot(cell.arm.d4, cell.arm.dz) + cell.arm.d6 +
         cell.X_FT.translation().norm();
}

// A CAM path in P, its notes and its distance from the mesh.
JobToolpath ImportCam(const JobInputs& inputs, const Mesh& mesh) {
  const ToolpathSettings& settings = inputs.job.toolpath;
  const CamPath path = ReadCamPath(inputs.cam_bytes, settings.cam_file, settings.chord_tolerance);
  CamImportOptions options;
  options.spacing = settings.spacing;
  options.crease = settings.crease;
  options.contact_distance = settings.cam_contact_distance;
  options.feed_rate = inputs.job.feed;
  if (inputs.cell.tool.cutter_shape == "ball") options.ball_radius = inputs.cell.tool.cutter_diameter / 2;
  CamImportReport report;
  JobToolpath made;
  made.toolpath = ImportCamPath(path, &mesh, options, &report);
  for (const std::string& note : path.notes) made.warnings.push_back(settings.cam_file + ": " + note);
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

Part ReadPart(const JobInputs& inputs, const Cell& cell) {
  const std::string& name = inputs.job.workpiece.mesh_file;
  ImportOptions options;
  options.unit = inputs.job.workpiece.unit;
  options.weld_tolerance = inputs.job.workpiece.weld_tolerance;
  Part part{ImportMesh(ReadMesh(inputs.workpiece_bytes, name), options, name), {}};
  for (const std::string& finding : Findings(part.import.report))
    part.warnings.push_back(name + ": " + finding);
  const Eigen::Vector3d size = part.import.report.upper - part.import.report.lower;
  if (const auto warning = UnitWarning(size.maxCoeff(), Reach(cell)))
    part.warnings.push_back(name + ": " + *warning);
  return part;
}

JobToolpath MakeJobToolpath(const JobInputs& inputs, const Mesh& mesh, const Pose& X_WP,
                            std::stop_token stop) {
  JobToolpath made;
  if (inputs.job.toolpath.strategy == "cam") {
    made = ImportCam(inputs, mesh);
  } else {
    made.toolpath = MakeToolpath(mesh, MakeToolpathOptions(inputs.job, inputs.cell.tool), stop);
  }
  made.toolpath = Transformed(made.toolpath, X_WP);
  for (Pass& pass : made.toolpath.passes)
    pass.rotation_reference = inputs.job.toolpath.rotation_reference.normalized();
  return made;
}

size_t CountPoints(const Toolpath& toolpath) {
  size_t count = 0;
  for (const Pass& pass : toolpath.passes) count += pass.points.size();
  return count;
}

}  // namespace millpose
