// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_room.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;

constexpr int kBlock = 8;  // cells
constexpr double kHalfDiagonal = 0.7072;

}  // namespace

RoughRoom::RoughRoom(const RoughBound& bound, const RoughGrid& grid, double most)
    : bound_(bound), grid_(grid), room_(grid.size()) {
  const double reach = kHalfDiagonal * kBlock * grid.cell;
  for (int row = 0; row < grid.rows; row += kBlock)
    for (int column = 0; column < grid.columns; column += kBlock) {
      const Vector2d middle = grid.origin + grid.cell * Vector2d(column + kBlock / 2.0, row + kBlock / 2.0);
      const double here = bound.Room(middle, most);
      for (int i = row; i < std::min(row + kBlock, grid.rows); ++i)
        for (int j = column; j < std::min(column + kBlock, grid.columns); ++j) {
          const int cell = grid.At(j, i);
          const Vector2d place = grid.CentreOf(cell);
          const double away = (place - middle).norm();
          double room = here > 0 ? here - away : here + away;
          if (std::abs(here) <= reach) room = bound.Room(place, most);
          room_[static_cast<size_t>(cell)] = static_cast<float>(room);
        }
    }
}

bool RoughRoom::AllowsBut(const Vector2d& place, double off) const {
  const int cell = grid_.CellAt(place);
  if (cell < 0) return false;
  if (At(cell) > grid_.cell) return true;
  if (At(cell) < -grid_.cell - off) return false;
  return bound_.Room(place, grid_.cell) >= -off;
}

bool RoughRoom::Allows(const Vector2d& place) const { return AllowsBut(place, 0); }

bool RoughRoom::Allows(const Vector2d& from, const Vector2d& to, double off) const {
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.5 * grid_.cell))));
  for (int i = 0; i <= steps; ++i)
    if (!AllowsBut(from + static_cast<double>(i) / steps * (to - from), off)) return false;
  return true;
}

}  // namespace millpose
