// SPDX-License-Identifier: GPL-3.0-or-later
// Cells that are described for ROS.
#pragma once

#include "base/random.hpp"
#include "report/ros/cell_urdf.hpp"

namespace millpose {

struct NamedCell {
  std::string name;
  Cell cell;
};
/// Every shipped cell, and an odd one at the end: an arm with all lengths and offsets, one rotary axis on
/// another, names alike.
std::vector<NamedCell> AllCells();

/// The cell with its part somewhere, and shapes of every kind on every mount.
Cell WithEverything(Cell cell, RandomStream& random);

Pose RandomPose(RandomStream& random, double reach);

/// A cell as it is described.
struct DescribedCell {
  explicit DescribedCell(const Cell& cell)
      : names(NamesFor(cell)), urdf(MakeCellUrdf(cell, names, "meshes/")), srdf(CellSrdf(cell, names)) {}
  RosNames names;
  CellUrdf urdf;
  std::string srdf;
};

}  // namespace millpose
