// SPDX-License-Identifier: GPL-3.0-or-later
// The names of a cell's joints and links for ROS (docs/ros.md): letters, digits, _, - and . alone, each once.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "machine/collision/cell.hpp"

namespace millpose {

/// Links without geometry that every cell has.
inline constexpr const char* kRosWorld = "world";           ///< W
inline constexpr const char* kRosBase = "base_link";        ///< B
inline constexpr const char* kRosFlange = "tool0";          ///< F
inline constexpr const char* kRosTip = "tool_tip";          ///< T
inline constexpr const char* kRosPart = "workpiece_frame";  ///< P

inline constexpr double kMetre = 1000;  ///< mm

struct RosNames {
  std::string cell;
  std::array<std::string, 6> links;    ///< behind each of the arm's joints
  std::vector<std::string> joints;     ///< that move: the arm's six, then the external axes in their order
  std::vector<std::string> carriages;  ///< links that the external axes move, in their order
  std::vector<std::string> bodies;     ///< links of Cell::bodies, in their order
};

RosNames NamesFor(const Cell& cell);

}  // namespace millpose
