// SPDX-License-Identifier: GPL-3.0-or-later
// RoughBound over a lattice: most places are answered by their cell.
#pragma once

#include "toolpath/strategies/rough_bound.hpp"
#include "toolpath/strategies/rough_material.hpp"

namespace millpose {

class RoughRoom {
 public:
  /// `bound` outlives it. Rooms above `most` (mm) are not told apart.
  RoughRoom(const RoughBound& bound, const RoughGrid& grid, double most);

  /// Whether the tip may stand there; nowhere beside the lattice.
  bool Allows(const Eigen::Vector2d& place) const;
  /// How much less than that it may be off there, mm: in between points of a way.
  bool Allows(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double off) const;
  /// At a cell's middle, mm: no more than there is, and above 0 where there is any.
  double At(int cell) const { return room_[static_cast<size_t>(cell)]; }

 private:
  bool AllowsBut(const Eigen::Vector2d& place, double off) const;

  const RoughBound& bound_;
  RoughGrid grid_;
  std::vector<float> room_;
};

}  // namespace millpose
