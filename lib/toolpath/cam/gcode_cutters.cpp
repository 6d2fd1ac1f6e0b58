// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_cutters.hpp"

#include "base/text.hpp"

namespace millpose {
namespace {

// The number behind `mark`; empty when there is none.
std::optional<double> NumberBehind(std::string_view text, std::string_view mark) {
  const size_t at = text.find(mark);
  if (at == std::string_view::npos) return std::nullopt;
  text.remove_prefix(at + mark.size());
  text = text.substr(0, text.find_first_not_of("0123456789."));
  return ParseNumber(text);
}

}  // namespace

std::map<std::string, CamCutter> CuttersInComments(std::string_view bytes, double unit) {
  std::map<std::string, CamCutter> cutters;
  int line = 1;
  for (size_t at = 0; at < bytes.size(); ++line) {
    const size_t end = std::min(bytes.find('\n', at), bytes.size());
    const std::string_view text = bytes.substr(at, end - at);
    at = end + 1;
    const size_t mark = text.find("(T");
    if (mark == std::string_view::npos) continue;
    const auto number = NumberBehind(text.substr(mark), "(T"), diameter = NumberBehind(text, " D=");
    if (!number || !diameter || !(*diameter > 0)) continue;
    cutters.try_emplace(ShortestNumber(*number),
                        CamCutter{unit * *diameter, unit * NumberBehind(text, " CR=").value_or(0), line});
  }
  return cutters;
}

}  // namespace millpose
