// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_levels.hpp"

#include "base/error.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kCellsPerRadius = 40;
constexpr double kNothing = -1e30;  // height where there is no stock, mm
constexpr double kMostCells = 3e7;
constexpr double kLevel = 0.99996;    // cosine of 0.5°: a face across the axis
constexpr double kSameHeight = 0.01;  // mm
constexpr double kRoundStock = 4;     // mm that the axis may go round the stock, beyond the radius

Eigen::Matrix3d FrameAlong(const Vector3d& axis) {
  const Vector3d near = std::abs(axis.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d x = (near - near.dot(axis) * axis).normalized();
  Eigen::Matrix3d rows;
  rows.row(0) = x;
  rows.row(1) = axis.cross(x);
  rows.row(2) = axis;
  return rows;
}

/// Raises the cells whose middles lie in the square of a column, or the one that holds it.
void Paint(const Vector3d& at, double half, const RoughGrid& grid, std::vector<float>& tops) {
  const auto raise = [&](int column, int row) {
    if (!grid.Has(column, row)) return;
    float& top = tops[static_cast<size_t>(grid.At(column, row))];
    top = std::max(top, static_cast<float>(at.z()));
  };
  raise(grid.ColumnOf(at.x()), grid.RowOf(at.y()));
  const double shift = grid.cell / 2;
  for (int row = grid.RowOf(at.y() - half + shift); row < grid.RowOf(at.y() + half + shift); ++row)
    for (int column = grid.ColumnOf(at.x() - half + shift); column < grid.ColumnOf(at.x() + half + shift);
         ++column)
      raise(column, row);
}

std::vector<float> TopsOf(const StandingColumns& stock, const Eigen::Matrix3d& across,
                          const RoughGrid& grid) {
  std::vector<float> tops(grid.size(), static_cast<float>(kNothing));
  const double half = stock.spacing / 2;
  for (const auto& [low, high] : stock.columns) {
    const Vector3d from = across * low, way = across * high - from;
    const int steps =
        std::max(1, static_cast<int>(std::ceil(way.head<2>().norm() / std::min(grid.cell, half))));
    if (way.head<2>().norm() < 1e-6) {
      Paint(way.z() > 0 ? Vector3d(from + way) : from, half, grid, tops);
      continue;
    }
    for (int i = 0; i <= steps; ++i) Paint(from + static_cast<double>(i) / steps * way, half, grid, tops);
  }
  return tops;
}

RoughGrid GridAround(const Eigen::AlignedBox2d& box, const CutterShape& cutter) {
  RoughGrid grid;
  grid.cell = RoughDisc(cutter) / kCellsPerRadius;
  const double beside = 2 * cutter.radius + kRoundStock;
  grid.origin = box.min() - Vector2d::Constant(beside);
  const Vector2d cells = (box.sizes() + Vector2d::Constant(2 * beside)) / grid.cell;
  if (cells.x() * cells.y() > kMostCells)
    throw InputError(
        {}, fmt::format("toolpath.rough: the stock is {:.0f} x {:.0f} mm across the tool axis, too large for "
                        "a cutter of {:.6g} mm; allowed: at most {:.0f} million cells of a fortieth of its "
                        "floor's radius",
                        box.sizes().x(), box.sizes().y(), 2 * cutter.radius, kMostCells / 1e6));
  grid.columns = static_cast<int>(std::ceil(cells.x()));
  grid.rows = static_cast<int>(std::ceil(cells.y()));
  return grid;
}

}  // namespace

RoughScene RoughSceneOf(const StrategyInputs& inputs, const Vector3d& axis) {
  RoughScene scene;
  scene.across = FrameAlong(axis);
  const Mesh& mesh = inputs.mesh;
  for (int face = 0; face < mesh.face_count(); ++face)
    scene.part.push_back({scene.across * mesh.Corner(face, 0), scene.across * mesh.Corner(face, 1),
                          scene.across * mesh.Corner(face, 2)});
  Eigen::AlignedBox2d box;
  for (const auto& [low, high] : inputs.stock->columns)
    box.extend((scene.across * low).head<2>()), box.extend((scene.across * high).head<2>());
  if (box.isEmpty())
    throw InputError({}, "toolpath.rough: nothing stands of workpiece.stock; check its corners and unit");
  scene.grid = GridAround(box, inputs.options.cutter);
  scene.tops = TopsOf(*inputs.stock, scene.across, scene.grid);
  return scene;
}

std::vector<double> RoughLevels(const Rough& rough, const RoughScene& scene) {
  const double top = *std::ranges::max_element(scene.tops);
  std::vector<double> fixed;
  double lowest = std::numeric_limits<double>::infinity();
  for (const RoughBound::Triangle& corner : scene.part) {
    const double height = std::max({corner[0].z(), corner[1].z(), corner[2].z()});
    lowest = std::min({lowest, corner[0].z(), corner[1].z(), corner[2].z()});
    const Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    if (normal.z() >= kLevel * normal.norm()) fixed.push_back(height + rough.allowance);
  }
  const double bottom = rough.bottom.value_or(lowest + rough.allowance);
  if (bottom >= top - kSameHeight)
    throw InputError({}, fmt::format("toolpath.rough: nothing to take off: the stock ends {:.3f} mm along "
                                     "the tool axis, the lowest layer would be at {:.3f} mm",
                                     top, bottom));
  fixed.push_back(bottom);
  std::ranges::sort(fixed, std::greater());
  std::vector<double> levels;
  double above = top;
  for (const double height : fixed) {
    if (height > above - kSameHeight || height < bottom) continue;
    const int layers = static_cast<int>(std::ceil((above - height) / rough.per_layer - 1e-9));
    for (int i = 1; i < layers; ++i) levels.push_back(above + (height - above) * i / layers);
    levels.push_back(height);
    above = height;
  }
  return levels;
}

}  // namespace millpose
