// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/templates.hpp"

#include "base/text.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (const std::string_view line : SplitLines(text)) {
    if (!Trim(line).empty()) lines.emplace_back(Trim(line));
  }
  return lines;
}

/// Characters that a blank keeps apart: of words, and of the holes that words take.
bool KeepsBlank(char c) { return IsWordCharacter(c) || c == '{' || c == '}' || c == '.' || c == '"'; }

/// Upper case, white space single and only where it parts words (`blanks`), no remark behind a statement: two
/// texts that differ in nothing else are the same.
std::string Normalised(std::string_view text, bool blanks = true) {
  text = Trim(text);
  if (!text.starts_with(';')) text = Trim(text.substr(0, text.find(';')));
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i] == '\t' ? ' ' : text[i];
    const bool parts = blanks && i + 1 < text.size() && !result.empty() && KeepsBlank(result.back()) &&
                       KeepsBlank(text[i + 1]);
    const bool comment = text.starts_with(';') || text.starts_with('(');
    if (c == ' ' && (result.ends_with(' ') || (!comment && !parts))) continue;
    result += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return result;
}

/// Numbers of an upper-case text without zeros in front of others: M03 is M3, L-0 is L0.
std::string WithoutZeros(const std::string& text) {
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const char before = result.empty() ? ' ' : result.back(), next = i + 1 < text.size() ? text[i + 1] : ' ';
    const bool begins = !IsDigit(before) && before != '.' && before != '_';
    if (text[i] == '0' && begins && IsDigit(next)) continue;
    const char behind = i + 2 < text.size() ? text[i + 2] : ' ';
    if (text[i] == '-' && next == '0' && !IsDigit(behind) && behind != '.') continue;
    result += text[i];
  }
  return result;
}

constexpr std::array<std::string_view, 3> kHoles = {"{RPM}", "{PASS}", "{PIECE}"};

/// Where the next hole of a pattern begins, and its name; npos when there is none.
std::pair<size_t, std::string_view> NextHole(std::string_view pattern) {
  std::pair<size_t, std::string_view> next{std::string_view::npos, {}};
  for (const std::string_view hole : kHoles) {
    if (const size_t at = pattern.find(hole); at < next.first) next = {at, hole};
  }
  return next;
}

/// Whether `line` is `pattern` with values in place of its holes; the numbers there go to `filled`.
bool Matches(std::string_view pattern, std::string_view line, Templates::Filled& filled) {
  while (true) {
    const auto [at, hole] = NextHole(pattern);
    if (at == std::string_view::npos) return pattern == line;
    if (!line.starts_with(pattern.substr(0, at))) return false;
    line.remove_prefix(at);
    pattern.remove_prefix(at + hole.size());
    // The value reaches up to the text that follows the hole.
    const std::string_view next = pattern.substr(0, NextHole(pattern).first);
    const size_t stop = next.empty() ? line.size() : line.find(next);
    if (stop == std::string_view::npos || stop == 0) return false;
    const std::optional<double> value = ParseNumber(line.substr(0, stop));
    if (!value) return false;
    std::vector<double>& values = hole == "{RPM}"    ? filled.rpm
                                  : hole == "{PASS}" ? filled.pass
                                                     : filled.piece;
    values.push_back(*value);
    line.remove_prefix(stop);
  }
}

/// A line without a block number "N10 " before it.
std::string_view WithoutNumber(std::string_view line) {
  if (line.empty() || std::toupper(line[0]) != 'N') return line;
  const size_t end = line.find_first_not_of("0123456789", 1);
  return end == std::string_view::npos || end == 1 || line[end] != ' ' ? line : Trim(line.substr(end));
}

/// Whether `name` stands in `line` as a word, outside a comment that takes the whole line.
bool HoldsWord(const std::string& line, const std::string& name) {
  if (line.starts_with(';') || line.starts_with('(') || line.starts_with('!')) return false;
  const std::string text = Normalised(line), word = Normalised(name);
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const size_t end = at + word.size();
    if ((at == 0 || !IsWordCharacter(text[at - 1])) && (end == text.size() || !IsWordCharacter(text[end])))
      return true;
  }
  return false;
}

void Fill(std::string& line, const std::string& hole, const std::string& value) {
  for (size_t at = line.find(hole); at != std::string::npos; at = line.find(hole, at + value.size())) {
    line.replace(at, hole.size(), value);
  }
}

void FillTool(std::string& line, const Templates::Tool& tool) {
  Fill(line, "{tool}", tool.name);
  if (tool.number) Fill(line, "{number}", std::to_string(*tool.number));
}

std::vector<std::string> Together(std::vector<std::string> first, const std::vector<std::string>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace

const std::vector<std::string>& Templates::Names() {
  static const std::vector<std::string> names = {"cartesian_on", "coolant_off", "coolant_on", "footer",
                                                 "header",       "joints_on",   "pass_begin", "pass_end",
                                                 "spindle_off",  "spindle_on",  "tool_change"};
  return names;
}

Templates::Templates(std::map<std::string, std::string> defaults,
                     const std::map<std::string, std::string>& overrides, const Tool& tool, Spelling spelling)
    : spelling_(spelling) {
  for (const auto& [name, text] : overrides) defaults[name] = text;
  for (const auto& [name, text] : defaults) {
    texts_[name] = LinesOf(text);
    for (std::string& line : texts_[name]) FillTool(line, tool);
  }
  texts_["spindle_on"] = Together(texts_["spindle_on"], texts_["coolant_on"]);
  texts_["spindle_off"] = Together(texts_["coolant_off"], texts_["spindle_off"]);
  for (const std::string& name : Names()) texts_[name];  // every name has lines, if none
  if (texts_["tool_change"].empty() && !tool.held) return;
  std::vector<std::string> check = LinesOf(tool.check);
  for (std::string& line : check) FillTool(line, tool);
  check_lines_ = check.size();
  texts_["tool_change"] = Together(texts_["tool_change"], check);
}

std::string Templates::NameOf(ProgramEvent::Kind kind) {
  using Kind = ProgramEvent::Kind;
  if (kind == Kind::kOutput || kind >= Kind::kHandover) return {};
  if (kind == Kind::kSpindleOn) return "spindle_on";
  if (kind == Kind::kSpindleOff) return "spindle_off";
  return kind == Kind::kPassBegin ? "pass_begin" : "pass_end";
}

std::vector<std::string> Templates::Lines(const ProgramEvent& event) const {
  const std::string name = NameOf(event.kind);
  if (name.empty()) return {};
  std::vector<std::string> lines = texts_.at(name);
  for (std::string& line : lines) {
    Fill(line, "{rpm}", ShortestNumber(std::round(event.value * 60 * 1000) / 1000));
    Fill(line, "{pass}", ShortestNumber(event.value));
    Fill(line, "{piece}", ShortestNumber(event.piece));
  }
  return lines;
}

const std::vector<std::string>& Templates::Lines(const std::string& name) const { return texts_.at(name); }

/// How many lines from `first` on are the lines of the text, with blank lines between; 0 when they are not.
size_t Templates::MatchAll(const std::string& name, const std::vector<std::string_view>& lines, size_t first,
                           Filled& filled) const {
  size_t line = first;
  for (const std::string& pattern : texts_.at(name)) {
    while (line > first && line < lines.size() && Trim(lines[line]).empty()) ++line;
    if (line == lines.size()) return 0;
    const std::string_view text = Trim(lines[line]);
    const std::string_view given = spelling_.numbers ? WithoutNumber(text) : text;
    const char begin = given.empty() ? '\0' : given.front();
    if (std::toupper(begin) != std::toupper(pattern.front()) && pattern.front() != '{') return 0;  // cheap
    if (!Matches(Spelled(pattern), Spelled(given), filled)) return 0;
    ++line;
  }
  return line - first;
}

std::string Templates::Spelled(std::string_view line) const {
  return spelling_.blanks ? Normalised(line) : WithoutZeros(Normalised(line, false));
}

std::optional<Templates::Match> Templates::Recognise(const std::vector<std::string_view>& lines,
                                                     size_t first) const {
  Filled filled;
  const auto fits = [&] {
    return std::ranges::adjacent_find(filled.rpm, std::not_equal_to{}) == filled.rpm.end();
  };
  if (const size_t taken = MatchAll("spindle_on", lines, first, filled); taken > 0 && fits()) {
    return Match{ProgramEvent::Kind::kSpindleOn, filled.rpm.empty() ? 0 : filled.rpm.back() / 60, taken};
  }
  if (const size_t taken = MatchAll("spindle_off", lines, first, filled)) {
    return Match{ProgramEvent::Kind::kSpindleOff, 0, taken};
  }
  return std::nullopt;
}

size_t Templates::Recognise(const std::string& name, const std::vector<std::string_view>& lines,
                            size_t first) const {
  Filled filled;
  return MatchAll(name, lines, first, filled);
}

size_t Templates::Recognise(const std::string& name, const std::vector<std::string_view>& lines, size_t first,
                            double pass, double piece) const {
  Filled filled;
  const size_t taken = MatchAll(name, lines, first, filled);
  const auto all = [](const std::vector<double>& values, double wanted) {
    return std::ranges::all_of(values, [&](double value) { return value == wanted; });
  };
  return all(filled.pass, pass) && all(filled.piece, piece) ? taken : 0;
}

size_t Templates::BeforeCheck(const std::vector<std::string_view>& lines, size_t first, size_t count) const {
  for (size_t left = check_lines_; left > 0; --count)
    if (!Trim(lines[first + count - 1]).empty()) --left;
  return count;
}

bool Templates::Calls(const std::string& name, const std::vector<DeclaredCall>& calls, bool moving) const {
  for (const std::string& line : texts_.at(name)) {
    for (const DeclaredCall& call : calls) {
      if ((call.moves || !moving) && HoldsWord(line, call.name)) return true;
    }
  }
  return false;
}

std::string Templates::WithSamples(std::string text, const Tool& tool) {
  Fill(text, "{rpm}", "1000");
  Fill(text, "{pass}", "0");
  Fill(text, "{piece}", "0");
  FillTool(text, tool);
  return text;
}

}  // namespace millpose
