// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/check.hpp"

#include <map>
#include <thread>

#include "base/file.hpp"
#include "base/parallel.hpp"
#include "base/units.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/job_engagement.hpp"
#include "pipeline/locate.hpp"
#include "pipeline/step_meshes.hpp"
#include "pipeline/workpiece.hpp"
#include "pose/scorer.hpp"
#include "surface/corner_normals.hpp"
#include "surface/round_holes.hpp"
#include "surface/step_reader.hpp"

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

// By diameter, to 0.001 mm.
void CountHoles(const Mesh& mesh, MeshCheck& check) {
  constexpr double kCrease = DegToRad(30), kTolerance = 0.05;  // as strategy drill has them by default
  std::map<long, MeshCheck::Holes> found;
  for (const RoundHole& hole : FindRoundHoles(mesh, kCrease, kTolerance)) {
    const long micrometres = std::lround(1e3 * hole.diameter);
    MeshCheck::Holes& holes = found[micrometres];
    holes.diameter = static_cast<double>(micrometres) / 1e3;
    ++(hole.kind == HoleKind::kBlind     ? holes.blind
       : hole.kind == HoleKind::kThrough ? holes.through
                                         : holes.rims);
  }
  for (const auto& [micrometres, holes] : found) check.holes.push_back(holes);
}

MeshCheck Described(const std::string& file, double unit, const ImportResult& import, double reach,
                    std::vector<std::string> warnings) {
  MeshCheck check;
  check.file = file;
  check.unit = unit;
  check.unit_plausible = import.mesh.face_count() == 0 ||
                         !UnitWarning((import.report.upper - import.report.lower).maxCoeff(), reach);
  check.source_faces = import.mesh.triangles().source_faces;
  check.report = import.report;
  CountHoles(import.mesh, check);
  check.warnings = std::move(warnings);
  MeasureBends(import.mesh, check);
  return check;
}

// What keeps the best pose of a point from being used, over a grid of rotations and all branches.
Obstacle BestReach(const PoseProblem& problem, const MillingPoint& point, const Eigen::Vector3d& reference,
                   double step) {
  const PointScorer scorer(problem, point, reference);
  const int count = std::max(1, static_cast<int>(std::ceil(2 * kPi / step)));
  std::vector<FreedomValues> rotations;
  for (int i = 0; i < count; ++i) rotations.push_back({2 * kPi * i / count});
  std::vector<Candidate> candidates(8 * rotations.size());
  scorer.Score(rotations, candidates);
  Obstacle best = Obstacle::kUnreachable;
  for (const Candidate& candidate : candidates)
    if (TestsPassed(candidate.obstacle) > TestsPassed(best)) best = candidate.obstacle;
  return best;
}

void Count(const std::vector<Obstacle>& reach, JobCheck& check) {
  constexpr size_t kNamed = 10;
  check.points = reach.size();
  for (size_t i = 0; i < reach.size(); ++i) {
    ++check.reach[static_cast<size_t>(reach[i])];
    if (reach[i] != Obstacle::kNone && check.out_of_reach.size() < kNamed) check.out_of_reach.push_back(i);
  }
}

}  // namespace

MeshCheck CheckMesh(const CheckMeshArguments& arguments, Progress& progress, std::stop_token stop) {
  const std::string name = arguments.mesh.string();
  StepOptions step;
  step.chord_tolerance = arguments.chord_tolerance;
  step.percent = [&](int percent) { progress.Percent(percent); };
  step.stop = std::move(stop);
  const std::string bytes = arguments.root.Read(arguments.mesh);
  const bool is_step = LooksLikeStep(bytes);
  if (is_step) progress.Begin(SurfaceStage(bytes, step.seconds, step.memory_MB), 0);
  RawMesh raw = ReadMesh(bytes, name, step);
  const double unit = arguments.unit.value_or(raw.stated_unit.value_or(1));
  const ImportResult import = ImportMesh(std::move(raw), {unit, arguments.weld_tolerance, false}, name);
  if (is_step) progress.End(fmt::format("{} triangles", import.report.triangles));
  std::vector<std::string> warnings = Findings(import.report);
  const Eigen::Vector3d size = import.report.upper - import.report.lower;
  if (const auto warning = UnitWarning(size.maxCoeff(), kLargeArm)) warnings.push_back(*warning);
  return Described(name, unit, import, kLargeArm, std::move(warnings));
}

namespace {

JobCheck Check(JobInputs& inputs, int threads, Progress& progress, std::stop_token stop) {
  progress.Begin(SurfaceStage(inputs), 0);
  CutStepFiles(
      &inputs, [&](int percent) { progress.Percent(percent); }, stop);
  Cell cell = MakeCell(inputs.cell, inputs.body_bytes);
  cell.X_WP = MakeWorkpiecePose(inputs.job.workpiece, cell.X_WB);
  const Part part = ReadPart(inputs, cell);
  progress.End(fmt::format("{} triangles", part.import.report.triangles));
  JobToolpath made = MakeJobToolpath(inputs, part.import.mesh, stop);
  CheckJobGouges(inputs, part.import.mesh, threads, made, stop);
  SetJobEngagement(inputs, part.import.mesh, threads, stop, made.toolpath);
  const Toolpath toolpath = PlacedToolpath(inputs, made.toolpath, cell.X_WP);
  const PoseProblem problem = MakePoseProblem(inputs.job, inputs.cell, cell);

  JobCheck check;
  std::vector<std::string> warnings = part.warnings;
  warnings.insert(warnings.end(), made.warnings.begin(), made.warnings.end());
  warnings.insert(warnings.end(), made.findings.begin(), made.findings.end());
  for (const std::string& hole : made.holes_left_out) warnings.push_back("NOT MACHINED: " + hole);
  check.mesh = Described(inputs.job.workpiece.mesh_file, inputs.job.workpiece.unit, part.import, Reach(cell),
                         std::move(warnings));
  check.mesh.notes = made.notes;
  check.job = inputs.job.name;
  check.cell = inputs.cell.name;
  check.arm = inputs.cell.arm.name;
  check.passes = toolpath.passes.size();

  std::vector<std::pair<const Pass*, const MillingPoint*>> points;
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points) points.emplace_back(&pass, &point);
  std::vector<Obstacle> reach(points.size());
  progress.Begin("reach", points.size());
  ParallelFor(points.size(), threads, stop, [&](size_t i) {
    const auto& [pass, point] = points[i];
    reach[i] = BestReach(problem, *point, pass->rotation_reference, inputs.job.path.rotation_step);
    progress.Advance(1);
  });
  Count(reach, check);
  check.gouges = made.gouges.points;
  check.deepest_gouge = made.gouges.deepest.depth;
  check.gouge_place = made.gouges.deepest.place;
  progress.End(fmt::format("{} of {} points within reach", check.reach[0], check.points));
  return check;
}

}  // namespace

JobCheck CheckJob(const CheckJobArguments& arguments, Progress& progress, std::stop_token stop) {
  const int threads =
      arguments.threads > 0 ? arguments.threads : static_cast<int>(std::thread::hardware_concurrency());
  JobInputs inputs = LoadJobInputs(arguments.job, {}, {}, arguments.root);
  inputs.max_points = arguments.max_points;
  return WithPlaces(inputs, [&] { return Check(inputs, threads, progress, stop); });
}

bool HasFindings(const MeshCheck& check) { return !check.warnings.empty(); }

bool HasFindings(const JobCheck& check) {
  return HasFindings(check.mesh) || check.reach[0] < check.points || check.gouges > 0;
}

}  // namespace millpose
