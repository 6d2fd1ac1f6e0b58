// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/cell_cutters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

/// Puts `value` behind "key" where it first stands in `line`.
void SetNumber(std::string& line, std::string_view key, const std::string& value) {
  const size_t at = line.find(key);
  if (at == std::string::npos) return;
  const size_t begin = at + key.size(), end = line.find_first_not_of("0123456789.", begin);
  line.replace(begin, end - begin, value);
}

/// A tool block as the cell has it ("tool:" and what is indented under it) for another cutter, as an entry of
/// `tools` where it has a number.
std::string ToolWith(const std::vector<std::string>& block, const CamSection& section,
                     std::optional<int> number) {
  std::string text;
  for (size_t i = 1; i < block.size(); ++i) {
    std::string line = block[i];
    const bool cutter = line.starts_with("  cutter:");
    if (section.diameter && line.starts_with("  name:"))
      line = fmt::format("  name: mill_d{}", ShortestNumber(*section.diameter));
    if (section.diameter && (cutter || line.find("class: cutter") != std::string::npos))
      SetNumber(line, "diameter_mm: ", ShortestNumber(*section.diameter));
    if (const double corner = section.corner_radius; cutter && corner > 0) {
      const bool ball = std::abs(2 * corner - section.diameter.value_or(0)) < 1e-6;
      const size_t flat = line.find("shape: flat");
      if (flat != std::string::npos)
        line.replace(flat, 11,
                     ball ? "shape: ball" : "shape: bull, corner_radius_mm: " + ShortestNumber(corner));
    }
    for (size_t at = 0; (at = line.find('.', at)) != std::string::npos && line.starts_with("  name:"); ++at)
      line[at] = '_';
    text += (!number ? "" : i == 1 ? "  - " : "    ") + line.substr(number ? 2 : 0) + '\n';
    if (number && i == 1) text += fmt::format("    number: {}\n", *number);
  }
  return text;
}

}  // namespace

std::string WithBall(std::string cell) {
  constexpr std::string_view kFlat = "cutter: {shape: flat";
  const size_t at = cell.find(kFlat);
  if (at != std::string::npos)
    cell.replace(at, kFlat.size(),
                 "# GUESS: a ball, since the part's curved facets are rough.\n  cutter: {shape: ball");
  return cell;
}

std::string WithCutters(const std::string& cell, const std::vector<CamSection>& sections) {
  std::vector<CamSection> cutters;
  for (const CamSection& section : sections)
    if (std::ranges::none_of(cutters, [&](const CamSection& known) {
          return known.diameter == section.diameter && known.corner_radius == section.corner_radius;
        }))
      cutters.push_back(section);
  std::vector<std::string> lines, block;
  for (const std::string_view line : SplitLines(cell)) lines.emplace_back(line);
  const auto begin = std::ranges::find(lines, "tool:");
  auto end = begin;
  while (end != lines.end() && (end == begin || end->starts_with(' '))) block.push_back(*end++);
  const bool several = cutters.size() > 1;
  std::string tools = several ? "tools:\n" : "tool:\n";
  for (size_t i = 0; i < cutters.size(); ++i)
    tools += ToolWith(block, cutters[i], several ? std::optional(static_cast<int>(i) + 1) : std::nullopt);
  std::string text;
  for (auto line = lines.begin(); line != lines.end(); ++line) {
    if (line == begin) text += tools;
    if (line >= begin && line < end) continue;
    if (several && *line == "  linuxcnc: {}")
      *line = "  linuxcnc: {m6_moves: false}   # GUESS: no TOOL_CHANGE_POSITION and the like in the ini file";
    text += *line + '\n';
    if (several && *line == "  linuxcnc:")
      text += "    m6_moves: false   # GUESS: no TOOL_CHANGE_POSITION and the like in the ini file\n";
    if (several && line->starts_with("home_deg:"))
      text +=
          "# GUESS: where tools are changed; home stands there.\ntool_change_deg:" + line->substr(9) + '\n';
  }
  return text;
}

}  // namespace millpose
