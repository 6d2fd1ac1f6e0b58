// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rotation_curve.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/sample_curves.hpp"

namespace millpose {
namespace {

Eigen::Vector3d VectorOf(const PointsTable& points, size_t row, const std::array<const char*, 3>& columns) {
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> value = points.Number(row, columns[static_cast<size_t>(i)]);
    if (!value)
      throw InputError(Place{"points.csv", static_cast<int>(row) + 2},
                       fmt::format("{}: given nothing; allowed: a number", columns[static_cast<size_t>(i)]));
    vector[i] = *value;
  }
  return vector;
}

}  // namespace

std::vector<RotationSample> RotationCurve(const std::filesystem::path& folder, const PointsTable& points,
                                          size_t row) {
  const JobSettings job = ParseJob(ReadFile(folder / "job.yaml"), (folder / "job.yaml").string());
  CellSettings cell = ParseCell(ReadFile(folder / "cell.yaml"), (folder / "cell.yaml").string());
  cell.bodies.clear();  // the objective knows no bodies
  const PoseProblem problem = MakePoseProblem(job, cell, MakeCell(cell, {}));
  MillingPoint point;
  point.position = VectorOf(points, row, {"x_mm", "y_mm", "z_mm"});
  point.normal = VectorOf(points, row, {"nx", "ny", "nz"});
  point.tool_axis = VectorOf(points, row, {"tx", "ty", "tz"});
  point.feed = VectorOf(points, row, {"fx", "fy", "fz"});
  const PointScorer scorer(problem, point, job.toolpath.world_reference.normalized());
  const RotationGrid grid = CurveGrid();
  std::vector<FreedomValues> rotations;
  for (int i = 0; i < grid.count; ++i) rotations.push_back({grid.first + i * grid.step});
  std::vector<Candidate> candidates(8 * rotations.size());
  scorer.Score(rotations, candidates);
  std::vector<RotationSample> curve;
  for (size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].admissibility == Admissibility::kAdmissible)
      curve.push_back({rotations[i / 8][0], static_cast<int>(i % 8), candidates[i].objective});
  return curve;
}

}  // namespace millpose
