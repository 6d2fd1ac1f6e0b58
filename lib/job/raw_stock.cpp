// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/raw_stock.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"
#include "geometry/import/mesh_import.hpp"
#include "job/assemble.hpp"
#include "job/bent_part.hpp"
#include "machine/stiffness/compliance.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// A prism of the outline, counter-clockwise seen from its last end.
Triangles Prism(const std::vector<Vector3d>& outline, const Vector3d& along) {
  const int n = static_cast<int>(outline.size());
  Triangles prism;
  for (const Vector3d& corner : outline) prism.vertices.push_back(corner);
  for (const Vector3d& corner : outline) prism.vertices.push_back(corner + along);
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    prism.faces.push_back({i, next, n + next});
    prism.faces.push_back({i, n + next, n + i});
    if (i < 1 || i + 1 >= n) continue;
    prism.faces.push_back({0, i + 1, i});
    prism.faces.push_back({n, n + i, n + i + 1});
  }
  return prism;
}

Triangles BoxOf(const StockBox& box) {
  const Vector3d size = box.upper - box.lower;
  const Vector3d x(size.x(), 0, 0), y(0, size.y(), 0);
  return Prism({box.lower, box.lower + x, box.lower + x + y, box.lower + y}, {0, 0, size.z()});
}

Triangles CylinderOf(const StockCylinder& cylinder) {
  constexpr int kSides = 96;
  const double radius = cylinder.radius / SinCos(kPi / kSides).cos;
  const auto [x, y] = BasisOfPlane(cylinder.axis);
  std::vector<Vector3d> outline;
  for (int i = 0; i < kSides; ++i) {
    const SineCosine turn = SinCos(2 * kPi * i / kSides);
    outline.emplace_back(cylinder.centre + radius * (turn.cos * x + turn.sin * y));
  }
  return Prism(outline, cylinder.length * cylinder.axis);
}

Triangles UnbentStock(const JobInputs& inputs) {
  const WorkpieceSettings& workpiece = inputs.job.workpiece;
  if (workpiece.stock_box) return BoxOf(*workpiece.stock_box);
  if (workpiece.stock_cylinder) return CylinderOf(*workpiece.stock_cylinder);
  if (workpiece.stock_file.empty()) return {};
  ImportOptions options;
  options.unit = workpiece.stock_unit;
  options.weld_tolerance = workpiece.weld_tolerance;
  return ImportMesh(ReadMesh(inputs.stock_bytes, workpiece.stock_file, MakeStepOptions(workpiece)), options,
                    workpiece.stock_file)
      .mesh.triangles();
}

}  // namespace

Triangles RawStock(const JobInputs& inputs) { return BentStock(inputs.job, UnbentStock(inputs)); }

}  // namespace millpose
