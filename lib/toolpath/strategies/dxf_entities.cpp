// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/dxf_entities.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/shown.hpp"
#include "base/text.hpp"

namespace millpose {
namespace {

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r'))
    text.remove_suffix(1);
  return text;
}

class DxfPairs {
 public:
  DxfPairs(std::string_view bytes, const std::string& name) : rest_(bytes), name_(name) {}

  /// The next pair; none at the end.
  std::optional<DxfPair> Next() {
    if (rest_.empty()) return std::nullopt;
    const std::string_view code = Line();
    const std::optional<double> number = ParseNumber(code);
    if (!number || *number != static_cast<int>(*number))
      throw InputError({name_, line_},
                       fmt::format("given {}; allowed: the number of a code, as DXF files have on "
                                   "every other line",
                                   Shown(code)));
    if (rest_.empty()) throw InputError({name_, line_}, "the file is cut off behind a code");
    DxfPair pair;
    pair.code = static_cast<int>(*number);
    pair.value = Line();
    pair.line = line_;
    return pair;
  }
  int line() const { return line_; }

 private:
  std::string_view Line() {
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = Trimmed(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    return line;
  }

  std::string_view rest_;
  const std::string& name_;
  int line_ = 0;
};

}  // namespace

std::string_view DxfEntity::Text(int code) const {
  const auto found = std::ranges::find(pairs, code, &DxfPair::code);
  return found == pairs.end() ? std::string_view() : found->value;
}

DxfFile ReadDxfFile(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("AutoCAD Binary DXF"))
    throw InputError({name}, "this is a binary DXF; allowed: text, which every CAD program can write");
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  DxfPairs pairs(bytes, name);
  DxfFile file;
  std::string_view section;
  bool is_unit = false, ended = false, names_section = false;
  while (const std::optional<DxfPair> pair = pairs.Next()) {
    if (ended) break;
    if (pair->code == 0) {
      ended = pair->value == "EOF";
      names_section = pair->value == "SECTION";
      if (pair->value == "ENDSEC") section = {};
      if (section == "ENTITIES") file.entities.push_back({pair->value, pair->line, {}});
      continue;
    }
    if (names_section && pair->code == 2) {
      section = pair->value;
      names_section = false;
      continue;
    }
    if (section == "ENTITIES" && !file.entities.empty()) file.entities.back().pairs.push_back(*pair);
    if (section == "HEADER" && is_unit && pair->code == 70) file.unit = *pair;
    if (section == "HEADER" && pair->code == 9) is_unit = pair->value == "$INSUNITS";
  }
  if (!ended) throw InputError({name, pairs.line()}, "no DXF, or cut off: its end (0, EOF) is missing");
  return file;
}

}  // namespace millpose
