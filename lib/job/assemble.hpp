// SPDX-License-Identifier: GPL-3.0-or-later
// From settings, which config reads, to the values that the stages work on. The only place that knows both.
#pragma once

#include "geometry/import/step_options.hpp"
#include "job/config/cell_settings.hpp"
#include "job/config/job_settings.hpp"
#include "job/inputs.hpp"
#include "machine/collision/cell.hpp"
#include "machine/robot/deviations.hpp"
#include "machine/stiffness/series.hpp"
#include "planning/links/link_move_planner.hpp"
#include "planning/pass/fixed_rotation.hpp"
#include "planning/pass/pass_planner.hpp"
#include "planning/result/gear_course.hpp"
#include "program/pose_text.hpp"
#include "program/post.hpp"
#include "program/verify/verify.hpp"
#include "toolpath/gouge.hpp"
#include "toolpath/toolpath_options.hpp"

namespace millpose {

Arm MakeArm(const ArmSettings& settings);

/// As the cell states them; frames 0 (base) to 6 (flange).
ArmDeviations MakeDeviations(const DeviationSettings& settings);
/// In which ways the arm may differ from them yet.
std::vector<ArmDeviations> MakePatterns(const DeviationSettings& settings);

/// Compliances beside the joints.
std::vector<SeriesCompliance> MakeCompliances(const CellSettings& settings);

/// The same with the external axes', which stand at home.
std::vector<SeriesCompliance> MakeCompliancesAtHome(const CellSettings& settings);

/// Weights as the cell gives them; empty when it gives none.
struct GravityModel {
  Joints reference;  ///< pose in which the arm was calibrated, rad
  std::vector<LinkMass> masses;
  Counterbalance counterbalance;
  bool counterbalance_given = false;
  Eigen::Vector3d gravity;  ///< in B, mm/s²
};
std::optional<GravityModel> MakeGravity(const CellSettings& settings);

/// What a cell says of its gears: lost motion, how they count, and where friction is given the weights that
/// load them.
GearModel MakeGearModel(const CellSettings& settings);

/// X_FT of a tool: z along its axis from tip to holder, x as near to its x as a right angle allows.
Pose MakeToolPose(const ToolSettings& settings);

/// The cell without a workpiece. `body_bytes` holds the mesh files that bodies name.
Cell MakeCell(const CellSettings& settings, const std::map<std::string, std::string>& body_bytes);

/// A body that stands in the cell where the part must not be; `mesh_bytes`: JobInputs::keep_out_bytes.
Body MakeKeepOut(const KeepOutSettings& settings, const std::map<std::string, std::string>& mesh_bytes);

/// The cell with the stacks of all its tools in the spindle at once: what is free with it is free with any.
Cell WithAllTools(Cell cell, const CellSettings& settings);

/// How a part's STEP file is read, and what that may take.
StepOptions MakeStepOptions(const WorkpieceSettings& workpiece);

/// Material on the part's surface, mm.
double AllowanceOf(const JobSettings& job);

/// Puts the workpiece into the cell: the finished part with its allowance, the stock where the job has one,
/// and the job's fixtures.
void AddWorkpiece(const JobInputs& inputs, Triangles finished, Cell* cell);

/// Where the workpiece stands in W: as given, or where its measured targets fit best. Throws InputError when
/// they do not determine it or a residual is above the job's bound.
Pose MakeWorkpiecePose(const WorkpieceSettings& settings, const Pose& X_WB);

/// The admissible limits of a job: the arm's, narrowed by the task's, less the margin.
AdmissibleBounds MakeBounds(const JobSettings& job, const Arm& arm);

PoseProblem MakePoseProblem(const JobSettings& job, const CellSettings& cell_settings, const Cell& cell);
CutterShape MakeCutterShape(const ToolSettings& tool);
/// The job's own, with cutter and feed.
ToolpathOptions MakeToolpathOptions(const JobSettings& job, const ToolSettings& tool);
PathOptions MakePathOptions(const JobSettings& job);
/// The first pass of the last layer: every layer has the same passes, one layer after the other.
int FinishedFrom(const JobSettings& job, size_t passes);
/// `passes`: how many the job has.
FixedRotationOptions MakeFixedOptions(const JobSettings& job, const CellSettings& cell, size_t passes,
                                      int threads, std::stop_token stop);
LinkMoveOptions MakeLinkMoveOptions(const JobSettings& job);
VerifyOptions MakeVerifyOptions(const JobSettings& job, const Arm& arm);

/// Why `controller` cannot run programs for an arm; empty where it can.
std::string NoProgramsFor(const ArmSettings& arm, const std::string& controller);

/// Settings of one post as far as the cell's texts need them: without asking whether the controller can run
/// the cell as it stands, its external axes among it. InputError when the cell has no section for it, or the
/// controller cannot run the arm.
PostSettings MakeTextSettings(const JobSettings& job, const CellSettings& cell,
                              const std::string& controller);

/// Settings of one post, for programs. InputError as MakeTextSettings, and where the controller cannot run
/// the cell as it stands.
PostSettings MakePostSettings(const JobSettings& job, const CellSettings& cell,
                              const std::string& controller);

}  // namespace millpose
