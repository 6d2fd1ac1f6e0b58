// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/list_cells.hpp"

#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <ranges>

#include "base/error.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "job/config/config.hpp"
#include "run/init/sample_cells.hpp"

namespace millpose {
namespace {

std::string AxisText(const ExternalAxisSettings& axis) {
  const bool turns = axis.kind == AxisKind::kRotary;
  const double unit = turns ? kDegPerRad : 1;
  return fmt::format("{} ({}, carries the {}, {:.6g} to {:.6g} {})", axis.name,
                     WordOf(kAxisKindWords, axis.kind), WordOf(kCarriesWords, axis.carries),
                     unit * axis.lower, unit * axis.upper, turns ? "deg" : "mm");
}

std::string Joined(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::vector<ListedCell> ListCells() {
  std::vector<ListedCell> cells;
  for (const SampleCell& sample : SampleCells()) {
    const std::string name(sample.name);
    const CellSettings cell = ParseCell(sample.text, name + ".yaml");
    const ArmSettings& arm = cell.arm;
    ListedCell& listed = cells.emplace_back();
    listed.name = name;
    listed.arm = arm.name;
    listed.reach = Hypot(arm.a1 + arm.a2 + Hypot(arm.d4, arm.dz) + std::abs(arm.d5), arm.dy);
    for (const ToolSettings& tool : cell.tools.empty() ? std::vector{cell.tool} : cell.tools)
      listed.tools.push_back(fmt::format("{} ({:.6g} mm)", tool.name, tool.cutter_diameter));
    for (const ExternalAxisSettings& axis : cell.external_axes) listed.axes.push_back(AxisText(axis));
    for (const std::string& controller : std::views::keys(cell.controllers))
      listed.controllers.push_back(controller);
    listed.first = sample.first;
  }
  return cells;
}

std::string CellsText(const std::vector<ListedCell>& cells) {
  std::string text;
  for (const ListedCell& cell : cells)
    text += fmt::format(
        "{}{}\n  arm            {}, reach {:.0f} mm\n  tools          {}\n  external axes  {}\n"
        "  controllers    {}\n",
        cell.name, cell.first ? "" : " (not for init)", cell.arm, cell.reach, Joined(cell.tools),
        Joined(cell.axes), Joined(cell.controllers));
  return text;
}

std::string CellsJson(const std::vector<ListedCell>& cells) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ListedCell& cell : cells)
    list.push_back({{"name", cell.name},
                    {"arm", cell.arm},
                    {"reach_mm", cell.reach},
                    {"tools", cell.tools},
                    {"external_axes", cell.axes},
                    {"controllers", cell.controllers},
                    {"for_init", cell.first}});
  return nlohmann::ordered_json{{"cells", list}}.dump(2) + "\n";
}

std::string CellYaml(const std::string& name) {
  std::vector<std::string> names;
  for (const SampleCell& cell : SampleCells()) {
    if (cell.name == name) return std::string(cell.text);
    names.emplace_back(cell.name);
  }
  throw InputError(SourceLocation{}, UnknownName("cell", name, names));
}

}  // namespace millpose
