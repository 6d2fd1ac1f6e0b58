// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "job/config/config.hpp"

namespace millpose {
void SelectTool(const std::string& name, CellSettings* cell) {
  std::vector<std::string> names{cell->tool.name};
  if (!cell->tools.empty()) {
    names.clear();
    for (const ToolSettings& tool : cell->tools) names.push_back(tool.name);
  }
  if (name.empty() && names.size() > 1)
    throw InputError({}, fmt::format("tool: missing; cell {} has several, allowed: {}", cell->name,
                                     fmt::join(names, ", ")));
  if (!name.empty()) {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      const std::string nearest = NearestName(name, names);
      throw InputError(
          {}, fmt::format("tool: given {}; allowed, the tools of cell {}: {}{}", name, cell->name,
                          fmt::join(names, ", "), nearest.empty() ? "" : "; did you mean " + nearest + "?"));
    }
    if (!cell->tools.empty()) cell->tool = cell->tools[static_cast<size_t>(found - names.begin())];
  }
}

}  // namespace millpose
