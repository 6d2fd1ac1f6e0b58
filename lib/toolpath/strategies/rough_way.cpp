// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_way.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;

constexpr double kInto = 0.02;  // mm, of a straight line into the allowance
constexpr int kCellsAbout = 2;  // cells about a place in which a free one is looked for

bool IsFreeCell(const RoughMaterial& material, const RoughRoom& room, int cell) {
  return material.IsFree(cell) && room.At(cell) >= 0;
}

bool IsStraightWay(const RoughMaterial& material, const RoughRoom& room, const Vector2d& from,
                   const Vector2d& to) {
  const RoughGrid& grid = material.grid();
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.5 * grid.cell))));
  for (int i = 1; i < steps; ++i) {
    const int cell = grid.CellAt(from + static_cast<double>(i) / steps * (to - from));
    if (cell < 0 || !material.IsFree(cell)) return false;
  }
  return room.Allows(from, to, kInto);
}

/// The open cell nearest to a place; −1 where there is none about it.
int OpenCellBy(const RoughMaterial& material, const RoughRoom& room, const Vector2d& place) {
  const RoughGrid& grid = material.grid();
  int best = -1;
  double nearest = 0;
  for (int i = -kCellsAbout; i <= kCellsAbout; ++i)
    for (int j = -kCellsAbout; j <= kCellsAbout; ++j) {
      const int column = grid.ColumnOf(place.x()) + j, row = grid.RowOf(place.y()) + i;
      if (!grid.Has(column, row) || !IsFreeCell(material, room, grid.At(column, row))) continue;
      const double away = (grid.CentreOf(grid.At(column, row)) - place).norm();
      if (best < 0 || away < nearest) best = grid.At(column, row), nearest = away;
    }
  return best;
}

std::vector<Vector2d> Straightened(const RoughMaterial& material, const RoughRoom& room,
                                   const std::vector<Vector2d>& way) {
  std::vector<Vector2d> straight{way.front()};
  for (size_t at = 0; at + 1 < way.size();) {
    size_t far = at + 1, step = 1;
    while (far + step < way.size() && IsStraightWay(material, room, way[at], way[far + step]))
      far += step, step *= 2;
    for (; step > 0; step /= 2)
      while (far + step < way.size() && IsStraightWay(material, room, way[at], way[far + step])) far += step;
    straight.push_back(way[far]);
    at = far;
  }
  return straight;
}

}  // namespace

RoughAir::RoughAir(const RoughMaterial& material, const RoughRoom& room)
    : material_(material), room_(room), before_(material.grid().size(), -1) {}

void RoughAir::Begin(const Vector2d& from) {
  for (const int cell : queue_) before_[static_cast<size_t>(cell)] = -1;
  queue_.clear();
  next_ = 0;
  from_ = from;
  const int first = OpenCellBy(material_, room_, from);
  if (first < 0) return;
  queue_.push_back(first);
  before_[static_cast<size_t>(first)] = first;
}

int RoughAir::Next() {
  constexpr std::array<std::array<int, 2>, 8> kAround{
      {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  if (next_ >= queue_.size()) return -1;
  const RoughGrid& grid = material_.grid();
  const int cell = queue_[next_++];
  const int own_column = cell % grid.columns, own_row = cell / grid.columns;
  for (const auto& [j, i] : kAround) {
    if (!grid.Has(own_column + j, own_row + i)) continue;
    const int other = grid.At(own_column + j, own_row + i);
    if (before_[static_cast<size_t>(other)] >= 0 || !IsFreeCell(material_, room_, other)) continue;
    before_[static_cast<size_t>(other)] = cell;
    queue_.push_back(other);
  }
  return cell;
}

int RoughAir::Find(const std::function<bool(int)>& take) {
  for (;;) {
    const int cell = Next();
    if (cell < 0 || take(cell)) return cell;
  }
}

std::vector<Vector2d> RoughAir::WayTo(int cell) {
  while (before_[static_cast<size_t>(cell)] < 0)
    if (Next() < 0) return {};
  std::vector<Vector2d> way;
  for (; cell != queue_.front(); cell = before_[static_cast<size_t>(cell)])
    way.push_back(material_.grid().CentreOf(cell));
  way.push_back(from_);
  std::ranges::reverse(way);
  return Straightened(material_, room_, way);
}

std::vector<Vector2d> RoughThinned(std::span<const Vector2d> way, const RoughRoom& room, double tolerance) {
  if (way.size() < 3) return std::vector<Vector2d>(way.begin(), way.end());
  std::vector<char> keep(way.size(), 0);
  keep.front() = keep.back() = 1;
  std::vector<std::pair<size_t, size_t>> open{{0, way.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    if (last < first + 2) continue;
    const Vector2d along = way[last] - way[first];
    const double length = along.squaredNorm();
    double farthest = -1;
    size_t split = first + 1;
    for (size_t i = first + 1; i < last; ++i) {
      const double share = length > 0 ? std::clamp(along.dot(way[i] - way[first]) / length, 0.0, 1.0) : 0;
      const double away = (way[first] + share * along - way[i]).norm();
      if (away > farthest) farthest = away, split = i;
    }
    if (farthest <= tolerance && room.Allows(way[first], way[last], kInto)) continue;
    keep[split] = 1;
    open.emplace_back(first, split);
    open.emplace_back(split, last);
  }
  std::vector<Vector2d> thinned;
  for (size_t i = 0; i < way.size(); ++i)
    if (keep[i] != 0) thinned.push_back(way[i]);
  return thinned;
}

}  // namespace millpose
