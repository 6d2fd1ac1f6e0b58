// SPDX-License-Identifier: GPL-3.0-or-later
// What the controller is like in a cell: what M6 does there, what is taken for granted, what is checked by
// hand.
#include <cctype>

#include "program/linuxcnc/linuxcnc.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

/// Whether M6 stands in a line before its comment.
bool HoldsM6(std::string_view line) {
  line = line.substr(0, line.find_first_of("(;"));
  for (size_t i = 0; i < line.size(); ++i) {
    if ((line[i] != 'M' && line[i] != 'm') || (i > 0 && std::isalpha(line[i - 1]) != 0)) continue;
    const size_t digit = line.find_first_not_of(" 0", i + 1);
    if (digit == std::string_view::npos || line[digit] != '6') continue;
    const char behind = digit + 1 < line.size() ? line[digit + 1] : ' ';
    if (std::isdigit(behind) == 0 && behind != '.') return true;
  }
  return false;
}

/// Whether a text that the cell gives, or the default one, changes the tool by M6.
bool HasM6(const PostSettings& settings) {
  std::map<std::string, std::string> texts = LinuxCncTexts(settings);
  for (const auto& [name, text] : settings.texts) texts[name] = text;
  return std::ranges::any_of(
      texts, [](const auto& entry) { return std::ranges::any_of(SplitLines(entry.second), HoldsM6); });
}

}  // namespace

// Joints count from nothing. What M6 itself does to the arm nobody has planned.
std::string LinuxCncPost::WhyNotIn(const PostSettings& settings) const {
  if (HasM6(settings) && options_.m6_moves.value_or(true))
    return fmt::format(
        "controllers.{0}.m6_moves: {1}; programs change the tool by M6, and a way that the machine goes by "
        "itself "
        "then is not planned: expected false, with TOOL_CHANGE_POSITION, TOOL_CHANGE_AT_G30 and "
        "TOOL_CHANGE_QUILL_UP "
        "out of the ini file, or a text tool_change that calls a program which the cell declares as moving",
        Name(), options_.m6_moves ? "is true" : "is missing");
  if (!HasM6(settings) && options_.m6_moves && !settings.tool_held)
    return fmt::format("controllers.{}.m6_moves: has no effect here: no program has M6", Name());
  if (options_.cartesian || std::ranges::none_of(settings.controller_axes, &ControllerAxis::coupled))
    return "";
  return fmt::format(
      "controllers.{}.external_axes: coupled: true has no effect in joint programs (coordinates: joint); "
      "expected: false",
      Name());
}

std::vector<std::pair<std::string, std::string>> LinuxCncPost::BeforeFirstRun(
    const PostSettings& settings) const {
  return {
      {"tool", settings.tool_number
                   ? fmt::format("tool {} of the tool table is {}", *settings.tool_number, settings.tool_name)
                   : "no length is taken from the tool table (G49): the tip is the cell's"},
      {"joints",
       "jog each joint: direction and zero are the position display's; limits and accelerations of the "
       "ini file are not below the cell's"},
      {"kinematics", options_.cartesian
                         ? "MDI: cartesian_on and joints_on switch it; home by joints and by pose agree"
                         : "X Y Z A B C are joints 1 to 6 (trivkins)"},
      {"change of tool", HasM6(settings)
                             ? "no TOOL_CHANGE_POSITION, TOOL_CHANGE_AT_G30 or TOOL_CHANGE_QUILL_UP in the "
                               "ini file: M6 moves nothing"
                             : "no program has M6"},
      {"spindle at speed",
       "spindle.0.at-speed is wired to the drive: else cuts begin before the spindle turns"},
      {"texts", TextsToTry(settings)},
      {"first entry",
       "step to it at a low override, compare the joints with points.csv; then a dry run "
       "(dry_run_offset_mm)"}};
}

std::vector<std::string> LinuxCncPost::Assumptions(const PostSettings& settings) const {
  std::vector<std::string> assumptions;
  if (HasM6(settings))
    assumptions.emplace_back(
        "M6 leaves the arm where it is: no TOOL_CHANGE_POSITION, TOOL_CHANGE_AT_G30 or TOOL_CHANGE_QUILL_UP "
        "in the ini "
        "file (the cell's m6_moves)");
  if (!settings.texts.contains("spindle_on"))
    assumptions.emplace_back(
        "M3 is waited for: spindle.0.at-speed is wired, so that the first motion with a feed begins at "
        "speed");
  return assumptions;
}

// Parameter 5400: the number of the tool in the spindle.
std::string LinuxCncPost::ToolCheck(const PostSettings& settings) const {
  if (!settings.tool_number) return {};
  return "O9001 WHILE [#5400 NE {number}]\n(MSG, TOOL {number} {tool} EXPECTED)\nM0\nO9001 ENDWHILE";
}

}  // namespace millpose
