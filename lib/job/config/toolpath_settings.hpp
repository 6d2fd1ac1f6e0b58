// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of a job's `toolpath:` as read; inside units. Every default stands in the options of lib/toolpath.
#pragma once

#include "planning/pose/open_toolpath.hpp"
#include "toolpath/gouge.hpp"

namespace millpose {

struct ToolpathSettings : OpenToolpath {
  GougeOptions gouges;
  Eigen::Vector3d world_reference =
      Eigen::Vector3d::UnitZ();  ///< the rotation about the tool axis counts from it, W
};

}  // namespace millpose
