// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/init.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/execution.hpp"
#include "base/file.hpp"
#include "base/loose_file.hpp"
#include "base/named_progress.hpp"
#include "geometry/import/raw_mesh.hpp"
#include "geometry/import/step_reader.hpp"
#include "job/arrival.hpp"
#include "job/assemble.hpp"
#include "job/config/config.hpp"
#include "job/plausible.hpp"
#include "job/split_sections.hpp"
#include "job/step_meshes.hpp"
#include "run/init/cell_cutters.hpp"
#include "run/init/cell_text.hpp"
#include "run/init/facing_groups.hpp"
#include "run/init/job_text.hpp"
#include "run/init/path_job.hpp"
#include "run/init/place_part.hpp"
#include "run/init/work_folder.hpp"
#include "run/pipeline/stages/plan_job.hpp"
#include "store/folder_checkpoints.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostGroups = 8;     // of a part that are tried
constexpr int kMostPlans = 6;         // that may fail before init gives up
constexpr size_t kTriedPoints = 150;  // of a tool path that a trial plans, about
constexpr double kSmallPatch = 0.25;
constexpr double kMostLift = 0.5;  // mm: what rough facets ask for; more is another face in the way
constexpr size_t kPlacesEach = 2;  // of a tool path that are planned

fs::path FileOf(const fs::path& given) {
  if (!Exists(given)) throw InputError({given.string()}, "no such file");
  return fs::canonical(given);
}

/// The folder to come: absolute, links followed as far as it exists.
fs::path FolderFor(const InitArguments& arguments) {
  const fs::path given = arguments.out.value_or(arguments.part.stem());
  fs::path folder = fs::weakly_canonical(fs::absolute(given));
  if (!folder.has_filename()) folder = folder.parent_path();
  if (Exists(folder) && !fs::is_directory(folder))
    throw InputError({folder.string()}, "is a file; allowed: a folder, or a name that is free (--out DIR)");
  return folder;
}

bool Stands(const fs::path& file) { return fs::symlink_status(file).type() != fs::file_type::not_found; }

/// A name that job files allow, from the part's.
std::string JobName(const fs::path& part) {
  std::string name;
  for (const char c : part.stem().string()) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  if (name.empty() || !std::isalpha(static_cast<unsigned char>(name[0]))) name = "part_" + name;
  return name.substr(0, 40);
}

/// The part as it was read, with a job around it.
struct Draft {
  JobInputs inputs;
  std::optional<Part> part{};
  double reach = 0;
};

class Init {
 public:
  Init(const InitArguments& arguments, Progress& progress, std::stop_token stop)
      : arguments_(arguments),
        progress_(progress),
        stop_(std::move(stop)),
        out_(FolderFor(arguments)),
        part_(FileOf(arguments.part)) {}

  InitOutcome Run() {
    if (!Exists(WorkFolder::PathFor(out_))) RefuseTaken();
    work_.emplace(out_);
    try {
      return Work();
    } catch (const Interrupted&) {
      work_->Stay();
      throw;
    }
  }

 private:
  InitOutcome Work() {
    TakeBack();
    RefuseTaken();
    if (arguments_.cell) {
      cell_file_ = FileOf(*arguments_.cell);
      job_.cell = YamlPath(cell_file_, out_);
    } else {
      cell_file_ = work_->CellFile();
      cell_text_ = CellText();
      work_->WriteCell(cell_text_);
    }
    job_.name = JobName(part_);
    job_.part = YamlPath(part_, out_);
    if (LooksLikeCamPath(ReadFile(part_))) return WorkOnPath();
    job_.unit = UnitOfPart();
    ReadDraft();
    const std::vector<FacingGroup> groups = FindFacingGroups(draft_.part->import.mesh, kMostGroups);
    for (const FacingGroup& group : groups)
      for (const double share : {1.0, kSmallPatch})  // of the usual patch: less of a face has less beside it
        for (const FirstStrategy strategy : {FirstStrategy::kPad, FirstStrategy::kPlanesFree,
                                             FirstStrategy::kPlanes, FirstStrategy::kBall}) {
          if (strategy == (group.flat ? FirstStrategy::kBall : FirstStrategy::kPad)) continue;
          // The cutter of the user's own cell is what it is.
          if (arguments_.cell &&
              (strategy == FirstStrategy::kBall) != (cell_.tool.cutter_tip == CutterTip::kBall) &&
              !group.flat)
            continue;
          job_.group = group;
          job_.strategy = strategy;
          job_.patch_half = share * PatchHalf(draft_.reach);
          if (TryGroup()) return Publish(RegionText());
          if (failed_plans_ >= kMostPlans) Refuse(groups);
        }
    Refuse(groups);
  }

  /// A CAM file's own path, an operation for each of its sections.
  InitOutcome WorkOnPath() {
    if (arguments_.unit)
      throw InputError({part_.string()},
                       "--unit: given for a CAM file; it says its unit (toolpath.cam.unit)");
    TakeCell();
    work_->WriteJob(PathJobText(job_, {}, cell_));
    sections_ = SectionsOf(LoadJobInputs(work_->Job()));
    if (sections_.empty()) throw InputError({part_.string()}, "the CAM path holds no cut");
    if (!arguments_.cell) {
      cell_text_ = WithCutters(cell_text_, sections_);
      work_->WriteCell(cell_text_);
      TakeCell();
    }
    const FacingGroup path = GroupOfPath(WritePathJob());
    CheckSize((path.upper - path.lower).maxCoeff());
    for (const Placement& placement : PlacesOfPath(WritePathJob(), kPlacesEach, stop_)) {
      job_.placement = placement;
      const std::vector<PathOperation> operations = WritePathJob();
      if (!Plans([&](const CheckpointStore& kept, const Execution& execution) {
            return TryOperations(operations, kTriedPoints, kept, execution);
          }))
        continue;
      std::vector<std::string> names;
      for (const PathOperation& operation : operations)
        names.push_back(operation.inputs.job.operation.empty() ? operation.inputs.cell.tool.name
                                                               : operation.inputs.job.operation);
      return Publish(fmt::format("path       {} operation{}: {}\n", names.size(), names.size() > 1 ? "s" : "",
                                 fmt::join(names, ", ")));
    }
    throw InputError(
        {part_.string()},
        fmt::format(
            "no place before the arm was found at which the path can be planned completely{}; allowed: "
            "another arm, or a job written by hand (docs/cam-import.md)",
            tried_.problem.empty() ? "" : ", the last for: " + tried_.problem));
  }

  /// The path's job at the placement of now, and its operations as they are laid.
  std::vector<PathOperation> WritePathJob() {
    if (!cell_.tools.empty()) job_.tool = ToolOfSection(sections_[0], 1, cell_, part_.string());
    std::string text = PathJobText(job_, sections_[0], cell_);
    work_->WriteJob(text);
    if (sections_.size() > 1) work_->WriteJob(SplitIntoOperations(text, LoadJobInputs(work_->Job())));
    return LayPathOperations(work_->Job(), stop_);
  }

  /// Nothing of the user's is written over; with a cell of the user's own only the job is written.
  void RefuseTaken() const {
    for (const char* name : kWritten)
      if (Stands(out_ / name) && !(arguments_.cell && name == kWritten[0]))
        throw InputError({(out_ / name).string()},
                         "exists already; allowed: a folder without it (--out DIR)");
  }

  std::string CellText() const {
    const bool is_file = Exists(arguments_.arm);
    if (!is_file && fs::path(arguments_.arm).extension() != ".urdf") return SampleCellText(arguments_.arm);
    return UrdfCellText(
        {FileOf(arguments_.arm), arguments_.base_link, arguments_.flange_link, arguments_.tolerance}, out_);
  }

  /// The file's own unit where it states one; never one that makes the part fit.
  double UnitOfPart() const {
    if (arguments_.unit) return *arguments_.unit;
    const std::string bytes = ReadFile(part_);
    if (!LooksLikeCad(bytes)) return 1;
    return ReadMesh(bytes, part_.string(), {}).stated_unit.value_or(1);
  }

  /// Reads the cell, its first tool where none is named; says how the arm was understood.
  void TakeCell() {
    std::map<std::string, std::string> body_bytes;
    CellSettings cell = LoadCell(cell_file_, &body_bytes);
    SelectTool(arguments_.tool.empty() && !cell.tools.empty() ? cell.tools.front().name : arguments_.tool,
               &cell);
    if (!cell.tools.empty()) job_.tool = cell.tool.name;
    const Cell made = MakeCell(cell, body_bytes);
    if (draft_.reach == 0)
      arguments_.say(fmt::format("arm                 {}, reach {:.4g} mm\n", cell.arm.name, Reach(made)) +
                     ToText(DescribeArrival(cell, made)));
    RefuseDoubts(cell, made);
    draft_.reach = Reach(made);
    cell_ = std::move(cell);
  }

  void ReadDraft() {
    TakeCell();
    work_->WriteJob(JobText(job_, cell_));
    draft_.inputs = LoadJobInputs(work_->Job());
    progress_.Begin(SurfaceStage(draft_.inputs), 0);
    CutStepFiles(
        &draft_.inputs, [&](int percent) { progress_.Percent(percent); }, stop_);
    draft_.part = ReadPart(draft_.inputs, MakeCell(draft_.inputs.cell, draft_.inputs.body_bytes));
    progress_.End(fmt::format("{} triangles", draft_.part->import.report.triangles));
    const ImportReport& report = draft_.part->import.report;
    CheckSize((report.upper - report.lower).maxCoeff());
    if (arguments_.unit) return;
    if (const auto doubt = UnitWarning((report.upper - report.lower).maxCoeff(), draft_.reach))
      throw InputError({part_.string()}, *doubt + "; give --unit mm, cm, in or m");
  }

  /// A part longer than the arm's whole space has no place before it.
  void CheckSize(double size) const {
    if (size <= 2 * draft_.reach) return;
    const auto unit = UnitWarning(size, draft_.reach);
    throw InputError(
        {part_.string()},
        fmt::format(
            "is {:.4g} m long, while the arm with its tool reaches {:.4g} m to either side{}; allowed: "
            "a smaller part, another arm, or a job written by hand that mills it from several "
            "places (docs/placement.md)",
            size / 1000, draft_.reach / 1000, unit ? fmt::format(" ({}: --unit?)", *unit) : ""));
  }

  /// No plan in such a cell would be without findings.
  static void RefuseDoubts(const CellSettings& cell, const Cell& made) {
    std::vector<Problem> problems;
    for (const std::string& doubt : TellDoubts(DoubtsOf({cell, made}), cell)) problems.push_back({{}, doubt});
    if (!problems.empty()) throw InputError(std::move(problems));
  }

  /// Puts the cutter's shape into the cell: curved faces of rough facets want a ball.
  void TakeCutter(CutterTip tip) {
    if (arguments_.cell || draft_.inputs.cell.tool.cutter_tip == tip) return;
    draft_.inputs.cell.tool.cutter_tip = tip;
    work_->WriteCell(tip == CutterTip::kBall ? WithBall(cell_text_) : cell_text_);
  }

  /// Whether a place was found at which the group is planned whole; the work folder holds its job then.
  bool TryGroup() {
    const Mesh& mesh = draft_.part->import.mesh;
    TakeCutter(job_.strategy == FirstStrategy::kBall ? CutterTip::kBall : cell_.tool.cutter_tip);
    draft_.inputs.job = ParseJob(JobText(job_, cell_), work_->Job().string());
    JobToolpath made;
    try {
      made = MakeJobToolpath(draft_.inputs, mesh, stop_);
    } catch (const InputError&) {  // this strategy has nothing to lay there
      return false;
    }
    CheckJobGouges(draft_.inputs, mesh, {.threads = arguments_.threads, .stop = stop_}, made);
    const bool ball = job_.strategy == FirstStrategy::kBall;
    if (ball ? made.gouges.largest_lift > kMostLift : made.gouges.points > 0) return false;
    if (!made.findings.empty()) return false;
    const Cell cell = MakeCell(draft_.inputs.cell, draft_.inputs.body_bytes);
    const std::vector<Placement> likely =
        LikelyPlacements(job_.group, draft_.part->import.report, cell, draft_.inputs.cell.home);
    for (const Placement& placement :
         ReachedPlacements(draft_.inputs, mesh, made.toolpath, likely, kPlacesEach, stop_)) {
      job_.placement = placement;
      if (PlansPart()) return true;
      if (failed_plans_ >= kMostPlans) return false;
    }
    return false;
  }

  /// A coarse trial: every n-th pass and the ways between these. The folders of earlier trials stay until the
  /// end: an init that goes on finds what was planned in them.
  bool Plans(const std::function<TriedJob(const CheckpointStore&, const Execution&)>& plan) {
    const std::string trial = fmt::format("trial {} (coarse)", failed_plans_ + 1);
    NamedProgress told(progress_, trial);
    const OutputFolder kept(work_->Trial(failed_plans_ + 1), FolderUse::kCheckpoints);
    tried_ = plan(FolderCheckpoints(kept, true), {arguments_.threads, told, stop_});
    failed_plans_ += tried_.problem.empty() ? 0 : 1;
    progress_.Begin(trial, 0);
    progress_.End(fmt::format("{} of {} points: {}", tried_.points, tried_.of_points,
                              tried_.problem.empty()
                                  ? "planned completely"
                                  : tried_.problem + "; another place or region is tried"));
    return tried_.problem.empty();
  }

  bool PlansPart() {
    const std::string text = JobText(job_, cell_);
    work_->WriteJob(text);
    draft_.inputs.job = ParseJob(text, work_->Job().string());
    draft_.inputs.hash = HashOf(draft_.inputs);
    CheckPrograms(draft_.inputs);
    return Plans([&](const CheckpointStore& kept, const Execution& execution) {
      return TryJob(draft_.inputs, kTriedPoints, kept, execution);
    });
  }

  [[noreturn]] void Refuse(const std::vector<FacingGroup>& groups) const {
    throw InputError(
        {part_.string()},
        fmt::format(
            "no job was found that can be planned completely: {} smooth faces tried, the largest {:.6g} mm²; "
            "{} plans "
            "tried. Elsewhere the cutter of {:.6g} mm would go into what is next to it, or the arm does not "
            "reach; allowed: another part, arm or --unit, or a job written by hand (docs/tutorial.md)",
            groups.size(), groups.empty() ? 0 : groups[0].area, failed_plans_, cell_.tool.cutter_diameter));
  }

  /// The cell comes first. One that stands alone and is the one of the work folder was left by an init that
  /// was ended between the two.
  void TakeBack() const {
    if (arguments_.cell) return;
    const fs::path cell = out_ / kWritten[0];
    if (Stands(out_ / kWritten[1]) || fs::symlink_status(cell).type() != fs::file_type::regular) return;
    if (Exists(work_->CellFile()) && ReadFile(cell) == ReadFile(work_->CellFile())) RemoveAll(cell);
  }

  std::string RegionText() const {
    const FacingGroup& group = job_.group;
    return fmt::format("region     {}{:.0f} mm², about {:.1f}, {:.1f}, {:.1f} mm on the part\n",
                       group.flat ? "a plane face, " : "a curved face, ", group.area, group.seed.x(),
                       group.seed.y(), group.seed.z());
  }

  /// `what`: a line on what is milled.
  InitOutcome Publish(const std::string& what) {
    RefuseTaken();  // somebody may have written there meanwhile
    const bool made = !Exists(out_);
    MakeFolders(out_);
    try {
      if (!arguments_.cell) WriteLooseFile(out_ / kWritten[0], ReadFile(work_->CellFile()));
      WriteLooseFile(out_ / kWritten[1], ReadFile(work_->Job()));
    } catch (const InputError&) {
      TakeBack();
      std::error_code ignored;
      if (made) fs::remove(out_, ignored);
      throw;
    }
    const std::string shown = arguments_.out.value_or(arguments_.part.stem()).string();
    const Eigen::Vector3d place = job_.placement.X_WP.translation();
    return {out_, fmt::format(
                      "{}wrote      {}/job.yaml\n{}"
                      "place      {}, {:.1f}, {:.1f}, {:.1f} mm in the world\n"
                      "tried      coarsely: {} of {} points in {} of {} passes and the ways between them; no "
                      "programs\n"
                      "next       millpose plan {}/job.yaml\n"
                      "to do      every line marked GUESS: measure or replace it\n",
                      arguments_.cell ? "" : fmt::format("wrote      {}/cell.yaml\n", shown), shown, what,
                      job_.placement.upright ? "upright before the arm" : "facing up", place.x(), place.y(),
                      place.z(), tried_.points, tried_.of_points, tried_.passes, tried_.of_passes, shown)};
  }

  const InitArguments& arguments_;
  Progress& progress_;
  std::stop_token stop_;
  fs::path out_, part_;
  std::optional<WorkFolder> work_;
  FirstJob job_;
  fs::path cell_file_;
  std::string cell_text_;  ///< with its first cutter; empty of the user's own
  CellSettings cell_;
  Draft draft_{};
  int failed_plans_ = 0;
  TriedJob tried_;
  std::vector<CamSection> sections_;  ///< of a CAM file
};

}  // namespace

InitOutcome RunInit(const InitArguments& arguments, Progress& progress, std::stop_token stop) {
  return Init(arguments, progress, std::move(stop)).Run();
}

}  // namespace millpose
