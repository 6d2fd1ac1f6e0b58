// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose cells`: what cells the program brings.
#pragma once

#include <string>
#include <vector>

namespace millpose {

struct ListedCell {
  std::string name, arm;
  double reach = 0;                ///< of the wrist centre from axis 1, at most, mm
  std::vector<std::string> tools;  ///< their names and cutters: "spindle_d20 (20 mm)"
  std::vector<std::string> axes;   ///< external ones: "rail (linear, robot, 0 to 6000 mm)"
  std::vector<std::string> controllers;
  bool first = false;  ///< `init --arm` takes it
};

/// By name.
std::vector<ListedCell> ListCells();
std::string CellsText(const std::vector<ListedCell>& cells);
std::string CellsJson(const std::vector<ListedCell>& cells);

/// The YAML of one. Throws InputError for a name that none has.
std::string CellYaml(const std::string& name);

}  // namespace millpose
