// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/pose_settings.hpp"
#include "base/units.hpp"
#include "program/post.hpp"

namespace millpose {

/// A positioner whose motion RAPID counts in: work objects are fixed to it.
struct RapidWorkUnit {
  std::string name;    ///< of the mechanical unit: "STN1"
  PoseSettings frame;  ///< its user frame with its axes at 0, in the controller's world
};

/// What of a cell only RAPID knows. Every default here and only here; the keys stand in rapid_keys.cpp.
struct RapidOptions {
  PoseSettings base_frame;                       ///< of the robot, in the controller's world
  double way_speed = 500;                        ///< mm/s of the tip, between cuts
  double orientation_speed = DegToRad(200);      ///< rad/s, v_ori of every motion
  std::string signal_prefix = "do";              ///< output 5 of the cell is the signal do5
  std::vector<std::string> activate_units = {};  ///< mechanical units, by ActUnit
  std::optional<RapidWorkUnit> work_unit;        ///< coupled axes that carry the workpiece
  std::string load_from = {};                    ///< folder at the controller; empty: all is loaded at once
  std::optional<int> memory_kbytes;              ///< of all files together

  size_t Memory() const {
    return memory_kbytes && load_from.empty() ? static_cast<size_t>(*memory_kbytes) * 1000 : 0;
  }
};

}  // namespace millpose
