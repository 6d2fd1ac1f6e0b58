// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/templates.hpp"

#include "base/text.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

constexpr std::string_view kRpm = "{rpm}";

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (const std::string_view line : SplitLines(text)) {
    if (!Trim(line).empty()) lines.emplace_back(Trim(line));
  }
  return lines;
}

/// Upper case, white space single: two texts that differ in neither are the same.
std::string Normalised(std::string_view text) {
  std::string result;
  for (const char c : Trim(text)) {
    const char plain = c == '\t' ? ' ' : c;
    if (plain == ' ' && result.ends_with(' ')) continue;
    result += plain >= 'a' && plain <= 'z' ? static_cast<char>(plain - 'a' + 'A') : plain;
  }
  return result;
}

/// Whether `line` is `pattern` with a number in place of {rpm}, which goes to `rpm`.
bool Matches(const std::string& pattern, std::string_view line, double& rpm) {
  const std::string wanted = Normalised(pattern), given = Normalised(line);
  const size_t hole = wanted.find("{RPM}");
  if (hole == std::string::npos) return wanted == given;
  const std::string_view tail = std::string_view(wanted).substr(hole + kRpm.size());
  if (given.size() < hole + tail.size() || !given.starts_with(wanted.substr(0, hole)) ||
      !given.ends_with(tail)) {
    return false;
  }
  const std::optional<double> value =
      ParseNumber(std::string_view(given).substr(hole, given.size() - hole - tail.size()));
  if (value) rpm = *value;
  return value.has_value();
}

/// How many lines from `first` on hold all patterns, one a line, with blank lines between; 0 when they do
/// not.
size_t MatchAll(const std::vector<std::string>& patterns, const std::vector<std::string_view>& lines,
                size_t first, double& rpm) {
  size_t line = first;
  for (const std::string& pattern : patterns) {
    while (line > first && line < lines.size() && Trim(lines[line]).empty()) ++line;
    if (line == lines.size() || !Matches(pattern, lines[line], rpm)) return 0;
    ++line;
  }
  return line - first;
}

}  // namespace

Templates::Templates(std::map<std::string, std::string> defaults,
                     const std::map<std::string, std::string>& overrides) {
  for (const auto& [name, text] : overrides) defaults[name] = text;
  on_ = LinesOf(defaults["spindle_on"]);
  off_ = LinesOf(defaults["spindle_off"]);
}

std::vector<std::string> Templates::Lines(const ProgramEvent& event) const {
  std::vector<std::string> lines = event.kind == ProgramEvent::Kind::kSpindleOn ? on_ : off_;
  for (std::string& line : lines) {
    for (size_t hole = line.find(kRpm); hole != std::string::npos; hole = line.find(kRpm, hole)) {
      line.replace(hole, kRpm.size(), ShortestNumber(std::round(event.value * 60 * 1000) / 1000));
    }
  }
  return lines;
}

std::optional<Templates::Match> Templates::Recognise(const std::vector<std::string_view>& lines,
                                                     size_t first) const {
  double rpm = 0;
  if (const size_t taken = MatchAll(on_, lines, first, rpm)) {
    return Match{ProgramEvent::Kind::kSpindleOn, rpm / 60, taken};
  }
  if (const size_t taken = MatchAll(off_, lines, first, rpm)) {
    return Match{ProgramEvent::Kind::kSpindleOff, rpm / 60, taken};
  }
  return std::nullopt;
}

}  // namespace millpose
