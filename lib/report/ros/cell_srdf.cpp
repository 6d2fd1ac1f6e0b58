// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.hpp"
#include "machine/collision/body_pairs.hpp"
#include "report/ros/cell_urdf.hpp"

namespace millpose {
namespace {

/// A pose of a group's joints that has a name.
std::string HomeState(const std::string& group, const std::vector<std::pair<std::string, double>>& joints) {
  std::string text = fmt::format("  <group_state name=\"home\" group=\"{}\">\n", group);
  for (const auto& [joint, value] : joints)
    text += fmt::format("    <joint name=\"{}\" value=\"{}\"/>\n", joint, ShortestNumber(value + 0.0));
  return text + "  </group_state>\n";
}

std::string Groups(const Cell& cell, const RosNames& names) {
  std::string text = fmt::format(
      "  <group name=\"manipulator\">\n    <chain base_link=\"{}\" tip_link=\"{}\"/>\n  </group>\n", kRosBase,
      kRosTip);
  std::vector<std::pair<std::string, double>> home;
  for (size_t i = 0; i < 6; ++i) home.emplace_back(names.joints[i], cell.home[static_cast<Eigen::Index>(i)]);
  const std::string arm_home = HomeState("manipulator", home);
  if (cell.external_axes.empty()) return text + arm_home;
  text += "  <group name=\"external_axes\">\n";
  home.clear();
  for (size_t i = 0; i < cell.external_axes.size(); ++i) {
    const ExternalAxis& axis = cell.external_axes[i];
    text += fmt::format("    <joint name=\"{}\"/>\n", names.joints[6 + i]);
    home.emplace_back(names.joints[6 + i], axis.home / (axis.kind == AxisKind::kLinear ? kMetre : 1));
  }
  return text +
         "  </group>\n  <group name=\"manipulator_and_external_axes\">\n    <group name=\"manipulator\"/>\n"
         "    <group name=\"external_axes\"/>\n  </group>\n" +
         arm_home + HomeState("external_axes", home);
}

}  // namespace

std::string CellSrdf(const Cell& cell, const RosNames& names) {
  std::string text =
      fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", names.cell) + Groups(cell, names);
  for (size_t i = 0; i < cell.bodies.size(); ++i)
    for (size_t j = i + 1; j < cell.bodies.size(); ++j) {
      const Body &a = cell.bodies[i], &b = cell.bodies[j];
      if (!NeverChecked(cell, a, b)) continue;
      text += fmt::format("  <disable_collisions link1=\"{}\" link2=\"{}\" reason=\"{}\"/>\n",
                          names.bodies[i], names.bodies[j], IsExcluded(cell, a, b) ? "User" : "Adjacent");
    }
  return text + "</robot>\n";
}

}  // namespace millpose
