// SPDX-License-Identifier: GPL-3.0-or-later
// Ways within a layer where nothing stands.
#pragma once

#include <functional>
#include <span>

#include "toolpath/strategies/rough_room.hpp"

namespace millpose {

/// Looks through the cells that the disc can reach from a place without meeting material, the nearer ones
/// first. What is free is as of the material's last Refresh(); there is none between Begin() and the last
/// question.
class RoughAir {
 public:
  /// Both outlive it.
  RoughAir(const RoughMaterial& material, const RoughRoom& room);

  void Begin(const Eigen::Vector2d& from);
  /// −1 where there are no more.
  int Next();
  /// Next() until a cell that `take` says yes to; −1 where there is none.
  int Find(const std::function<bool(int)>& take);
  /// The way to a cell, straightened, with both ends; empty where it cannot be reached.
  std::vector<Eigen::Vector2d> WayTo(int cell);

 private:
  const RoughMaterial& material_;
  const RoughRoom& room_;
  Eigen::Vector2d from_ = Eigen::Vector2d::Zero();
  std::vector<int> before_;  ///< by cell: from which it was reached; −1: not
  std::vector<int> queue_;   ///< all that were reached
  size_t next_ = 0;
};

/// The places of a way that keep straight lines between them within `tolerance` (mm) of it, and which take
/// the tip no farther than 0.02 mm into the part's allowance.
std::vector<Eigen::Vector2d> RoughThinned(std::span<const Eigen::Vector2d> way, const RoughRoom& room,
                                          double tolerance);

}  // namespace millpose
