// SPDX-License-Identifier: GPL-3.0-or-later
// What hangs on the tool, against material that is no body of the cell (docs/stock.md).
#pragma once

#include <functional>
#include <memory>

#include "machine/collision/cell.hpp"

namespace millpose {

/// The bodies on a cell's tool that must not meet standing material while it mills: spindle, holder, and of
/// the cutter what lies above its cutting length. Immutable, so threads may share it.
class ToolBodies {
 public:
  /// Every body keeps its clearance (Clearances::cutting), and at least so much that it cannot touch what
  /// stands up to `beside` (mm) beside the places that are asked about, while it travels up to `travel` (mm)
  /// between two questions. The cutter's shank runs along the walls that the cutter has cut: it keeps no
  /// clearance and counts as thinner by `beside` and 0.2 mm.
  ToolBodies(const Cell& cell, double beside, double travel);
  ~ToolBodies();

  size_t size() const;
  const std::string& Name(size_t body) const;

  /// Whether a body comes too near to a box; of boxes with width it may say so where that is not the case.
  /// Both in one frame, in which the tool stands at `X_T`.
  std::function<bool(const Eigen::AlignedBox3d&)> NearTo(size_t body, const Pose& X_T) const;

  /// The farthest that a point of them is from the tip, mm.
  double Reach() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace millpose
