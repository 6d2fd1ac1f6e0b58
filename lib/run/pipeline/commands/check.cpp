// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/check.hpp"

#include <map>

#include "base/loose_file.hpp"
#include "base/units.hpp"
#include "geometry/import/step_reader.hpp"
#include "geometry/mesh/corner_normals.hpp"
#include "geometry/mesh/round_holes.hpp"
#include "job/assemble.hpp"
#include "job/bent_part.hpp"
#include "job/locate.hpp"
#include "job/plausible.hpp"
#include "job/raw_stock.hpp"
#include "job/step_meshes.hpp"
#include "report/check_html.hpp"
#include "report/samples/plan_removal.hpp"
#include "run/pipeline/commands/find_reach.hpp"
#include "toolpath/stock/cuts_of.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr double kLargeArm = 2800;  // mm: what a part is compared with where no cell is given

// How the edges bend: what the normals can be trusted for.
void MeasureBends(const Mesh& mesh, MeshCheck& check) {
  constexpr double kFlat = DegToRad(0.1), kCrease = DegToRad(30);
  std::vector<double> bends;
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k) {
      if (mesh.Neighbour(face, k) <= face) continue;
      const double bend = BendAngle(mesh, face, k);
      if (bend > kCrease) {
        ++check.creases;
      } else if (bend > kFlat) {
        bends.push_back(bend);
      }
    }
  if (bends.empty()) return;
  std::ranges::sort(bends);
  check.median_bend = bends[bends.size() / 2];
}

// By diameter, to 0.001 mm; diameters that differ by rounding alone count as one.
void CountHoles(const Mesh& mesh, MeshCheck& check) {
  constexpr double kSame = 0.0015;                             // mm
  constexpr double kCrease = DegToRad(30), kTolerance = 0.05;  // as strategy drill has them by default
  std::vector<RoundHole> found = FindRoundHoles(mesh, kCrease, kTolerance);
  std::ranges::sort(found, {}, &RoundHole::diameter);
  double least = 0;  // of the diameters that count as one
  for (const RoundHole& hole : found) {
    if (check.holes.empty() || hole.diameter > least + kSame) {
      least = hole.diameter;
      check.holes.push_back({});
      check.holes.back().diameter = std::round(1e3 * least) / 1e3;
    }
    MeshCheck::Holes& holes = check.holes.back();
    ++(hole.kind == HoleKind::kBlind     ? holes.blind
       : hole.kind == HoleKind::kThrough ? holes.through
                                         : holes.rims);
  }
}

void ListFaces(const Mesh& mesh, MeshCheck& check) {
  constexpr size_t kMostOfMesh = 40;  // a scan has as many as triangles
  const std::vector<SourceFace>& source = mesh.triangles().source_faces;
  check.from_step = !source.empty();
  const MeshParts parts = FindMeshParts(mesh);
  for (size_t i = 0; i < parts.faces.size(); ++i) {
    MeshCheck::Face face{i + 1, i < source.size() ? source[i] : SourceFace{}, parts.faces[i]};
    if (!check.from_step) face.source.area = face.part.area;
    check.faces.push_back(std::move(face));
  }
  if (check.from_step || check.faces.size() <= kMostOfMesh) return;
  std::ranges::stable_sort(check.faces, std::greater<>(), [](const auto& face) { return face.source.area; });
  check.faces.resize(kMostOfMesh);
}

MeshCheck Described(const std::string& file, double unit, const ImportResult& import, double reach,
                    std::vector<std::string> warnings) {
  MeshCheck check;
  check.file = file;
  check.unit = unit;
  check.unit_plausible = import.mesh.face_count() == 0 ||
                         !UnitWarning((import.report.upper - import.report.lower).maxCoeff(), reach);
  ListFaces(import.mesh, check);
  check.report = import.report;
  CountHoles(import.mesh, check);
  check.warnings = std::move(warnings);
  MeasureBends(import.mesh, check);
  return check;
}

void Count(const std::vector<PointReach>& reach, JobCheck& check) {
  constexpr size_t kNamed = 10;
  check.points = reach.size();
  for (size_t i = 0; i < reach.size(); ++i) {
    ++check.reach[static_cast<size_t>(reach[i].best)];
    if (reach[i].best == Infeasibility::kLimit) ++check.limited[static_cast<size_t>(reach[i].axis)];
    if (reach[i].best != Infeasibility::kNone && check.out_of_reach.size() < kNamed)
      check.out_of_reach.push_back(i);
  }
}

struct WrongWay {
  std::vector<std::string> findings;
  std::optional<WrongSide> first;  ///< of the points that they are about
};

/// What of most of a job's points tells that the part, or its region, is the wrong way round: normals that
/// look away from the arm, tools that come from below.
WrongWay WrongWayRound(const PreparedJob& prepared) {
  const Cell& cell = prepared.cell;
  const Eigen::Vector3d shoulder = cell.X_WB * Eigen::Vector3d(0, 0, cell.arm.d1);
  size_t points = 0, away = 0, below = 0;
  std::optional<WrongSide> looks_away, from_below;  // the first such
  for (const Pass& pass : prepared.toolpath.passes)
    for (const MillingPoint& point : pass.points) {
      if (point.kind != PointKind::kCut) continue;
      ++points;
      // More than 120° from the direction to the shoulder: not even a face that is milled from above or
      // beside.
      if (point.normal.dot((shoulder - point.position).normalized()) < -0.5) {
        ++away;
        if (!looks_away) looks_away = WrongSide{point.position, point.normal, point.tool_axis, true, false};
      }
      // The spindle hangs lower than the tip, by more than 17°.
      if (point.tool_axis.z() < -0.3) {
        ++below;
        if (!from_below) from_below = WrongSide{point.position, point.normal, point.tool_axis, false, true};
      }
    }
  const auto most = [&](size_t count) { return 2 * count > points; };
  const auto text = [](const Eigen::Vector3d& v) {
    const Eigen::Vector3d r = ((v * 1000).array().round() / 1000 + 0.0).matrix();
    return fmt::format("({:.3f}, {:.3f}, {:.3f})", r.x(), r.y(), r.z());
  };
  WrongWay found;
  if (most(away)) {
    found.first = looks_away;
    found.findings.push_back(
        fmt::format("{} of {} points have a normal that looks away from the arm, such as {} in the world: is "
                    "the part the right way round, and the region the face that is meant?",
                    away, points, text(looks_away->normal)));
  }
  if (most(below)) {
    if (!found.first) found.first = from_below;
    if (found.first->position == from_below->position) found.first->below = true;
    found.findings.push_back(fmt::format(
        "at {} of {} points the tool comes from below the part, with the axis {} in the world from "
        "tip to holder: is the part the right way up?",
        below, points, text(from_below->tool_axis)));
  }
  return found;
}

/// What operations after this one find taken off.
CutsOfTool ReachedCuts(const PreparedJob& prepared, const std::vector<PointReach>& reach,
                       const ToolSettings& tool) {
  Toolpath milled = prepared.made.toolpath;
  size_t number = 0;
  if (CountPoints(milled) == reach.size())
    for (Pass& pass : milled.passes)
      for (MillingPoint& point : pass.points)
        if (reach[number++].best != Infeasibility::kNone) point.gouge = 1;
  return CutsOf(milled, MakeCutterShape(tool));
}

void WriteView(const ViewFile& target, CheckHtmlInput& input) {
  if (!target) return;
  input.language = target->language;
  WriteLooseFile(target->file, CheckHtml(input));
}

}  // namespace

MeshCheck CheckMesh(const CheckMeshArguments& arguments, Progress& progress, std::stop_token stop) {
  const std::string name = arguments.mesh.string();
  StepOptions step;
  step.chord_tolerance = arguments.chord_tolerance;
  step.percent = [&](int percent) { progress.Percent(percent); };
  step.stop = std::move(stop);
  const std::string bytes = arguments.root.Read(arguments.mesh);
  const bool is_step = LooksLikeCad(bytes);
  if (is_step) progress.Begin(SurfaceStage(bytes, step.seconds, step.memory_MB), 0);
  RawMesh raw = ReadMesh(bytes, name, step);
  const double unit = arguments.unit.value_or(raw.stated_unit.value_or(1));
  const ImportResult import = ImportMesh(std::move(raw), {unit, arguments.weld_tolerance, false}, name);
  if (is_step) progress.End(fmt::format("{} triangles", import.report.triangles));
  std::vector<std::string> warnings = Findings(import.report);
  const Eigen::Vector3d size = import.report.upper - import.report.lower;
  if (const auto warning = UnitWarning(size.maxCoeff(), kLargeArm)) warnings.push_back(*warning);
  MeshCheck check = Described(name, unit, import, kLargeArm, std::move(warnings));
  CheckHtmlInput view;
  view.title = arguments.mesh.filename().string();
  view.part = &import.mesh;
  view.findings = check.warnings;
  view.text = ToText(check);
  WriteView(arguments.view, view);
  return check;
}

namespace {

JobCheck Check(JobInputs& inputs, const CheckJobArguments& arguments, const Execution& execution) {
  CheckPrograms(inputs);
  execution.progress.Begin(SurfaceStage(inputs), 0);
  CutStepFiles(
      &inputs, [&](int percent) { execution.progress.Percent(percent); }, execution.stop);
  const PreparedJob prepared = PrepareJob(inputs, NoCheckpoints{}, execution);
  JobCheck check;
  // What `plan` warns of, and its findings; how a path was read is none.
  std::vector<std::string> warnings;
  for (const std::string& warning : prepared.warnings)
    if (std::ranges::find(prepared.made.notes, warning) == prepared.made.notes.end())
      warnings.push_back(warning);
  warnings.insert(warnings.end(), prepared.made.findings.begin(), prepared.made.findings.end());
  WrongWay wrong = WrongWayRound(prepared);
  std::ranges::move(wrong.findings, std::back_inserter(warnings));
  check.mesh = Described(inputs.job.workpiece.mesh_file, inputs.job.workpiece.unit, prepared.surface,
                         Reach(prepared.cell), std::move(warnings));
  check.mesh.notes = prepared.made.notes;
  check.source = prepared.made.source;
  check.job = inputs.job.name;
  check.operation = inputs.job.operation;
  check.cell = inputs.cell.name;
  check.arm = inputs.cell.arm.name;
  if (inputs.job.compensation.deviations) check.for_arm = MeasuredName(inputs.cell.arm);
  check.passes = prepared.toolpath.passes.size();
  const std::vector<PointReach> reach = FindReach(prepared, inputs.job.path.rotation_step, execution);
  Count(reach, check);
  if (inputs.job.workpiece.HasStock()) check.cuts = ReachedCuts(prepared, reach, inputs.cell.tool);
  check.gouges = prepared.made.gouges.points;
  check.deepest_gouge = prepared.made.gouges.deepest.depth;
  check.gouge_place = prepared.made.gouges.deepest.place;
  if (!arguments.view) return check;
  CheckHtmlInput view;
  view.title = check.operation.empty() ? check.job : check.job + ": " + check.operation;
  view.cell = &prepared.cell;
  view.part = &prepared.surface.mesh;
  if (prepared.surface.mesh.face_count() > 0 && inputs.job.toolpath.strategy->File().empty()) {
    const Region region(UnbentPart(inputs.job, prepared.surface.mesh),
                        MakeToolpathOptions(inputs.job, inputs.cell.tool).region);
    for (int face = 0; face < prepared.surface.mesh.face_count(); ++face)
      view.in_region.push_back(region.HasFace(face));
  }
  view.toolpath = &prepared.toolpath;
  std::optional<Removal> removal;
  if (inputs.job.workpiece.HasStock())
    removal = PathRemoval(check.cuts,
                          {RawStock(inputs), prepared.surface.mesh.triangles(), inputs.cut_before,
                           inputs.job.workpiece.stock_resolution},
                          execution);
  view.removal = removal ? &*removal : nullptr;
  view.wrong_side = wrong.first;
  view.reach = reach;
  view.findings = check.mesh.warnings;
  view.notes = check.mesh.notes;
  if (inputs.cell.arm.deviations) view.measured = MeasuredName(inputs.cell.arm);
  view.text = ToText(check);
  view.settings = WriteJob(inputs.job) + "\n" + WriteCell(inputs.cell);
  WriteView(arguments.view, view);
  return check;
}

}  // namespace

JobCheck CheckJob(JobInputs inputs, const CheckJobArguments& arguments, Progress& progress,
                  std::stop_token stop) {
  inputs.max_points = arguments.max_points;
  return WithPlaces(inputs, [&] { return Check(inputs, arguments, {arguments.threads, progress, stop}); });
}

CellCheck CheckCell(const CheckCellArguments& arguments) {
  std::map<std::string, std::string> body_bytes;
  const CellSettings settings = LoadCell(arguments.cell, &body_bytes, arguments.root);
  const Cell cell = MakeCell(settings, body_bytes);
  CellCheck check;
  check.cell = settings.name;
  check.arm = settings.arm.name;
  check.bodies = cell.bodies.size();
  check.reach = Reach(cell);
  check.external_axes = cell.external_axes;
  for (const auto& [controller, post] : settings.controllers) check.controllers.push_back(controller);
  check.arrival = DescribeArrival(settings, cell);
  check.measured = DescribeMeasured(settings);
  check.warnings = CellWarnings(settings);
  std::ranges::move(TellDoubts(DoubtsOf({settings, cell}), settings), std::back_inserter(check.warnings));
  if (const auto found = Checker(World(cell)).At(cell.home, Phase::kFree))
    check.warnings.push_back(HomeWarning(settings.file, *found));
  if (!arguments.view) return check;
  CheckHtmlInput view;
  view.title = check.cell;
  view.cell = &cell;
  view.findings = check.warnings;
  if (settings.arm.deviations) view.measured = MeasuredName(settings.arm);
  view.text = ToText(check);
  view.settings = WriteCell(settings);
  WriteView(arguments.view, view);
  return check;
}

bool IsCellFile(const std::filesystem::path& file, const FileRoot& root) {
  // The key stands at the beginning of a line: anything else is told by whoever reads the file as a job.
  return ("\n" + root.Read(file)).find("\nmillpose_cell:") != std::string::npos;
}

bool HasFindings(const CellCheck& check) { return !check.warnings.empty(); }

bool HasFindings(const MeshCheck& check) { return !check.warnings.empty(); }

bool HasFindings(const JobCheck& check) {
  return HasFindings(check.mesh) || check.reach[0] < check.points || check.gouges > 0;
}

}  // namespace millpose
