// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/export_ros.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "job/assemble.hpp"
#include "job/step_meshes.hpp"
#include "job/workpiece.hpp"
#include "planning/compensation/compensate.hpp"
#include "report/ros/trajectory_files.hpp"
#include "run/pipeline/programs/plan_timeline.hpp"
#include "run/pipeline/programs/program_motions.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

/// Names of a set of this kind.
const SetNames kRosFiles{"cell.urdf", "cell.srdf",  "joint_trajectory.yaml", "joint_trajectory.csv",
                         "meshes",    kManifestFile};

/// In millpose's own folders of other kinds.
constexpr std::array kOthers = {kPlanFile,        kOperationsFolder, kPlansFolder,   "checkpoints",
                                "placement.json", "batch.json",      kProgramsFolder};

void RefuseFolder(const fs::path& folder) {
  if (!Exists(folder)) return;
  if (!fs::is_directory(folder)) throw InputError({folder.string()}, "exists and is not a folder");
  const Folder open(folder);
  if (!IsOutputFolder(folder)) {
    if (!open.Names().empty())
      throw InputError({folder.string()},
                       "exists and was not written by millpose export; allowed: a new or empty folder");
    return;
  }
  for (const char* name : kOthers)
    if (open.KindOf(name) != Folder::Kind::kNothing)
      throw InputError(
          {folder.string()},
          fmt::format("holds {} of another command of millpose; allowed: a folder of its own", name));
}

std::vector<std::string> HeadOf(const PlanResult& plan, const JobInputs& inputs, double tolerance) {
  std::vector<std::string> head{
      fmt::format("Written by millpose export: job {}, cell {}, inputs {}.", plan.job, plan.cell,
                  plan.input_hash),
      "trajectory_msgs/JointTrajectory: rad, m and s; the arm stands at home at its begin and end.",
      fmt::format("Joined by cubics it stays within {} mm of the program's path.", tolerance)};
  for (std::string& line : head)
    for (char& c : line)
      if (c == '\n' || c == '\r') c = ' ';
  const double lift = inputs.job.program_options.dry_run_offset;
  if (lift > 0) head.push_back(fmt::format("Dry run: cuts are lifted by {} mm along the tool axis.", lift));
  if (lift == 0 && IsCompensated(plan)) head.emplace_back(kCompensatedNotice);
  return head;
}

std::string LoadText(const char* what, const AxisLoad& load, const RosExport& made) {
  const TrajectoryInstant& at = made.run[load.at];
  const int pass = made.program.motions[at.motion].pass;
  return fmt::format("{:<13}at most {:.1f} % of {}'s, after {:.3f} s{}\n", what, 100 * load.share,
                     made.names.joints[load.axis], at.time, pass < 0 ? "" : fmt::format(" (pass {})", pass));
}

std::string TextOf(const RosExport& made, const fs::path& folder) {
  const RunLoads loads = LoadsOf(made.run, made.cell.arm, made.cell.external_axes);
  std::string text = fmt::format(
      "cell         {}: {} moving joints, {} bodies, {} of them meshes\n"
      "trajectory   {} points, {:.3f} s\n",
      made.cell.name, made.names.joints.size(), made.cell.bodies.size(), made.urdf.meshes.size(),
      made.run.size(), made.run.back().time);
  text += LoadText("speed", loads.speed, made) + LoadText("acceleration", loads.acceleration, made);
  text += "not in it    spindle, outputs, programs of the plant\n";
  return text + fmt::format("written to {}\n", folder.string());
}

}  // namespace

RosExport MakeRosExport(const PlanResult& plan, const JobInputs& inputs, const std::string& package) {
  RosExport made;
  made.cell = MakeJobCell(inputs);
  made.names = NamesFor(made.cell);
  made.program = MakeRunProgram(plan, inputs.job, RunOptions(inputs.job));
  const double tolerance = inputs.job.program_options.path_tolerance;
  made.run = SampleRun(made.program, plan.arm, RunClock(inputs), tolerance);
  made.beyond = BeyondLimits(made.run, made.program, plan.arm);
  made.urdf = MakeCellUrdf(made.cell, made.names,
                           package.empty() ? "meshes/" : fmt::format("package://{}/meshes/", package));
  made.files["cell.urdf"] = made.urdf.text;
  made.files["cell.srdf"] = CellSrdf(made.cell, made.names);
  made.files["joint_trajectory.yaml"] =
      TrajectoryYaml(made.run, plan.external_axes, made.names, HeadOf(plan, inputs, tolerance));
  made.files["joint_trajectory.csv"] = TrajectoryTable(made.run, plan, made.program, made.names);
  for (const auto& [name, bytes] : made.urdf.meshes) made.files["meshes/" + name] = bytes;
  return made;
}

ExportOutcome ExportRos(const ExportArguments& arguments, const Execution& execution) {
  RefuseFolder(arguments.ros);
  PlanFolder folder = ReadPlanFolder(arguments.plan, arguments.job, arguments.root);
  if (const std::string why = WhyNotProgrammable(folder.plan); !why.empty())
    return {1, fmt::format("nothing is written: {}\n", why)};
  CutStepFiles(
      &folder.inputs, [](int) {}, execution.stop);
  const RosExport made = MakeRosExport(folder.plan, folder.inputs, arguments.package);
  if (!made.beyond.empty()) {
    std::string text = "nothing is written: the arm cannot follow the plan at its feeds\n";
    for (const std::string& beyond : made.beyond) text += "  " + beyond + "\n";
    return {1, text + "  process.feed: reduce plans cuts that the joints can hold\n"};
  }
  const OutputFolder out(arguments.ros, FolderUse::kResults);
  ResultSet results(out, kRosFiles);
  for (const auto& [name, bytes] : made.files) results.Add(name, bytes);
  results.AddManifest(folder.plan.input_hash);
  results.Publish();
  std::string text = TextOf(made, arguments.ros);
  for (const std::string& warning : out.warnings()) text += fmt::format("warning    {}\n", warning);
  return {0, text};
}

}  // namespace millpose
