// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "toolpath/cam/cam_guess.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {
namespace {

std::string_view TakeLine(std::string_view& rest) {
  const size_t end = rest.find_first_of("\r\n");
  const std::string_view line = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  const size_t first = line.find_first_not_of(" \t");
  return first == std::string_view::npos ? std::string_view() : line.substr(first);
}

// A CSV's first line that is no comment names its x column.
bool LooksLikeCsv(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::string_view line = TakeLine(bytes);
    if (line.empty() || line.front() == '#') continue;
    return line.find("x_m") != std::string_view::npos || line.find("x_in") != std::string_view::npos;
  }
  return false;
}

char Upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

bool IsMajorWord(std::string_view text) {
  return std::ranges::all_of(text, [](char c) {
    return (Upper(c) >= 'A' && Upper(c) <= 'Z') || c == ' ' || c == '-' || c == ',' || c == '_';
  });
}

// Statements of CLDATA are words of letters, most with a slash; blocks of G-code begin with a letter and a
// digit, "%", ":" or "/".
bool LooksLikeGcode(std::string_view bytes) {
  constexpr int kLines = 400;  // comments may come first
  bytes.remove_prefix(bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0);
  for (int i = 0; i < kLines && !bytes.empty(); ++i) {
    const std::string_view line = TakeLine(bytes);
    if (line.empty() || line.front() == '(' || line.front() == ';') continue;
    if (line.starts_with("$$")) return false;
    if (line.front() == '%' || line.front() == ':') return true;
    const size_t slash = line.find('/');
    if (slash != std::string_view::npos && slash > 1 && IsMajorWord(line.substr(0, slash))) return false;
    const char first = Upper(line.front()), next = line.size() > 1 ? line[1] : ' ';
    const bool letter = first >= 'A' && first <= 'Z';
    if (letter && ((next >= '0' && next <= '9') || next == '-' || next == '=' || next == '.')) return true;
  }
  return false;
}

// Some line is a GOTO of CLDATA.
bool HasGoto(std::string_view bytes) {
  constexpr int kLines = 20'000;  // comments and settings may come first
  for (int i = 0; i < kLines && !bytes.empty(); ++i) {
    const std::string_view line = TakeLine(bytes);
    const size_t slash = line.find('/');
    if (slash == std::string_view::npos || slash < 4) continue;
    std::string word;
    for (const char c : line.substr(0, slash))
      if (c != ' ') word += Upper(c);
    if (word == "GOTO") return true;
  }
  return false;
}

// A key of the job that another format alone uses is an error.
void CheckKeys(const CamReadOptions& options, bool apt, bool gcode, const std::string& name) {
  const auto check = [&](bool given, bool used, std::string_view key, std::string_view format) {
    if (given && !used)
      throw InputError({name},
                       fmt::format("toolpath.cam.{} holds for {} alone, and the file is {}", key, format,
                                   apt     ? "APT CLDATA"
                                   : gcode ? "G-code"
                                           : "CSV"));
  };
  check(options.circle != CircleSense::kBoth, apt, "circle", "APT CLDATA");
  check(options.frame.has_value(), apt, "frame", "APT CLDATA");
  check(options.cycle_point.has_value(), apt, "cycle_point", "APT CLDATA");
  check(!options.offsets.empty(), gcode, "offsets_mm", "G-code");
  check(options.unit.has_value(), apt || gcode, "unit", "APT CLDATA and G-code");
  check(options.sender.has_value(), apt || gcode, "sender", "APT CLDATA and G-code");
  if (const SenderRules& rules = RulesOf(options.sender.value_or(CamSender::kPlain));
      (apt && !rules.apt) || (gcode && !rules.gcode))
    throw InputError({name},
                     fmt::format("toolpath.cam.sender: {} writes no {}; given such a file, it is one of {}",
                                 rules.key, apt ? "APT CLDATA" : "G-code", SenderKeys(gcode)));
  check(options.tip_programming.has_value(), gcode, "tip_programming", "G-code");
  check(!options.kinematics_codes.empty(), gcode, "kinematics_codes", "G-code");
}

}  // namespace

void CheckReach(const CamPath& path, const std::string& name) {
  constexpr double kLargest = 1e9;  // mm
  for (const CamPoint& point : path.points)
    if (!(point.position.cwiseAbs().maxCoeff() <= kLargest))
      throw InputError(
          {name, point.line},
          fmt::format("the point ({:.6g}, {:.6g}, {:.6g}) mm lies beyond ±{} mm: is the unit right?",
                      point.position.x(), point.position.y(), point.position.z(), kLargest));
}

bool LooksLikeCamPath(std::string_view bytes) {
  const auto is_text = [](char c) {
    return static_cast<unsigned char>(c) >= ' ' || c == '\t' || c == '\r' || c == '\n';
  };
  if (!std::ranges::all_of(bytes.substr(0, 4096), is_text)) return false;
  return LooksLikeCsv(bytes) || (!GuessFormat(bytes) && (LooksLikeGcode(bytes) || HasGoto(bytes)));
}

CamPath ReadCamPath(std::string_view bytes, const std::string& name, const CamReadOptions& options) {
  if (LooksLikeCsv(bytes)) {
    CheckKeys(options, false, false, name);
    return ReadCamCsv(bytes, name);
  }
  if (const auto guess = GuessFormat(bytes))
    throw InputError({name},
                     fmt::format("no tool path: the file seems to be {}; read are APT CLDATA, G-code and "
                                 "CSV with a header that names x_mm",
                                 *guess));
  const bool gcode = LooksLikeGcode(bytes);
  CheckKeys(options, !gcode, gcode, name);
  if (gcode) return ReadGcode(bytes, name, options);
  return ReadApt(bytes, name, options);
}

}  // namespace millpose
