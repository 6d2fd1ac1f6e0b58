// SPDX-License-Identifier: GPL-3.0-or-later
// The stages "surface" and "toolpath", shared by plan and check.
#pragma once

#include <stop_token>

#include "base/execution.hpp"
#include "geometry/import/mesh_import.hpp"
#include "job/inputs.hpp"
#include "machine/collision/cell.hpp"
#include "planning/external/external_course.hpp"
#include "planning/external/stations.hpp"
#include "toolpath/cam/cam_source.hpp"
#include "toolpath/gouge.hpp"

namespace millpose {

/// The workpiece's mesh, bent where it was registered so, with what is to be reported about it; without a
/// face where the job names no part.
struct Part {
  ImportResult import;
  std::vector<std::string>
      warnings;  ///< findings of the import and a doubtful unit, each with the file's name
};

/// How far the tool tip can come from axis 1, mm: what a part's size is compared with.
double Reach(const Cell& cell);
double Reach(const Arm& arm, const Eigen::Vector3d& p_FT);

/// The stage's name for who watches it run; of a STEP part with what its reading may take.
std::string SurfaceStage(const JobInputs& inputs);
std::string SurfaceStage(std::string_view mesh, int seconds, int memory_MB);

/// Reads and repairs the workpiece's mesh. Throws InputError.
Part ReadPart(const JobInputs& inputs, const Cell& cell);

/// The job's cell with the workpiece in its place. Throws InputError.
Cell MakeJobCell(const JobInputs& inputs);

struct JobToolpath {
  Toolpath toolpath;  ///< in P
  GougeReport gouges;
  std::vector<std::string> warnings;        ///< of the strategy, of an imported CAM path, of the gouge check
  std::vector<std::string> findings;        ///< of the strategy; gouges that stay in the path
  std::vector<std::string> notes;           ///< how a CAM path was read
  std::vector<std::string> holes_left_out;  ///< of a CAM path's cycles: not machined, one sentence each
  std::optional<CamSource> source;          ///< of a CAM path
  std::optional<double> spindle_speed;  ///< that a CAM path asks for, rev/s; it holds in place of the job's
};

/// Makes the job's tool path on the mesh, or imports it; of a bent part on the unbent one, and carries it to
/// the bent. Throws InputError when it holds no point;
/// Interrupted.
JobToolpath MakeJobToolpath(const JobInputs& inputs, const Mesh& mesh, std::stop_token stop, int parts = 1,
                            int threads = 1);

/// Checks the cutter against the whole part and does what the job asks for where it would go into it. Throws
/// Interrupted.
void CheckJobGouges(const JobInputs& inputs, const Mesh& mesh, const Execution& execution, JobToolpath& made);

/// The tool path in W.
Toolpath PlacedToolpath(const JobInputs& inputs, const Toolpath& toolpath, const Pose& X_WP);

/// The same, each pass with the external axes as its entry of `external` says. Where they move every point is
/// in W with them where they are then, and a closed pass becomes an open one (EndingWhereItBegan).
Toolpath AtStations(const JobInputs& inputs, const Toolpath& toolpath, const Stations& stations,
                    const std::vector<ExternalCourse>& external);

size_t CountPoints(const Toolpath& toolpath);

}  // namespace millpose
