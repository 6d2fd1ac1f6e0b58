// SPDX-License-Identifier: GPL-3.0-or-later
// The material of one layer on a lattice across the tool axis.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace millpose {

/// A square lattice of cells; frame: x and y across the tool axis, mm.
struct RoughGrid {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< corner of the first cell
  double cell = 1;
  int columns = 0, rows = 0;

  size_t size() const { return static_cast<size_t>(columns) * static_cast<size_t>(rows); }
  bool Has(int column, int row) const { return column >= 0 && row >= 0 && column < columns && row < rows; }
  int At(int column, int row) const { return row * columns + column; }
  int ColumnOf(double x) const { return static_cast<int>(std::floor((x - origin.x()) / cell)); }
  int RowOf(double y) const { return static_cast<int>(std::floor((y - origin.y()) / cell)); }
  /// −1 outside.
  int CellAt(const Eigen::Vector2d& p) const {
    const int column = ColumnOf(p.x()), row = RowOf(p.y());
    return Has(column, row) ? At(column, row) : -1;
  }
  Eigen::Vector2d CentreOf(int cell_number) const {
    const int column = cell_number % columns, row = cell_number / columns;
    return origin + cell * Eigen::Vector2d(column + 0.5, row + 0.5);
  }
};

/// What of `stands` is left when all that is thinner than `thickness` (mm) is taken out: where a disc of that
/// diameter fits in.
std::vector<char> ThickerThan(const RoughGrid& grid, const std::vector<char>& stands, double thickness);

/// What of a layer stands, and how a disc of the cutter's floor meets it. Chips thinner than three quarters
/// of a cell are not seen.
class RoughMaterial {
 public:
  /// `stands`: by cell; `radius` of the disc, mm.
  RoughMaterial(const RoughGrid& grid, std::vector<char> stands, double radius);

  struct Contact {
    double angle = 0;  ///< of the disc's front half, rad
    double side = 0;   ///< above 0: more of it left of the way than right
  };
  /// What the disc's rim meets at a place when it comes there along a direction (unit). What the last sweeps
  /// took off counts as met: a step is shorter than a chip at the side is long, so that they have cleared the
  /// rim's sides before it comes there.
  Contact Meet(const Eigen::Vector2d& place, const Eigen::Vector2d& direction) const;

  /// Takes off what the disc sweeps from one place to another; appends the cells to `taken`.
  void Sweep(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::vector<int>& taken);
  void Restore(const std::vector<int>& taken);
  /// What was swept so far counts as gone from here on: another cut begins.
  void BeginCut() { sweeps_ += kFreshSweeps; }

  /// Whether the disc is free of material with its middle in a cell: as of the last Refresh().
  bool IsFree(int cell) const { return distance_[static_cast<size_t>(cell)] >= free_; }
  /// From a cell's middle to the next material, mm, no more than about two radii.
  double Distance(int cell) const { return distance_[static_cast<size_t>(cell)] * grid_.cell; }
  /// Works out distances again around cells that were taken off.
  void Refresh(const std::vector<int>& taken);

  bool Stands(int cell) const { return stands_[static_cast<size_t>(cell)] != 0; }
  const RoughGrid& grid() const { return grid_; }
  double radius() const { return radius_; }

 private:
  static constexpr int kFreshSweeps = 8;  ///< of two cells each: 0.4 of the radius

  bool Meets(int cell) const {
    return Stands(cell) || swept_[static_cast<size_t>(cell)] > sweeps_ - kFreshSweeps;
  }
  void Measure(int first_column, int first_row, int end_column, int end_row);

  RoughGrid grid_;
  std::vector<char> stands_;
  double radius_;
  float free_;                   ///< cells
  int reach_;                    ///< cells, beyond which distances are not told apart
  std::vector<float> distance_;  ///< cells
  std::vector<Eigen::Vector2d> rim_;
  std::vector<int> swept_;  ///< by cell: by which sweep
  int sweeps_ = 0;
};

}  // namespace millpose
