// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/sinumerik/sinumerik_block.hpp"

#include <algorithm>
#include <cmath>

#include "base/text.hpp"

namespace millpose {
namespace {

constexpr bool kBlanks = false;    // between a letter and its number: the manual shows none
constexpr double kFarthest = 1e5;  // mm or degrees: nothing that an arm can mean is larger

/// G words that a milling program may hold, with their groups (SINUMERIK ONE, Programming Manual, tables:
/// G commands). Settable frames are G54 to G57 and G505 to G599.
const std::map<std::string, int>& Groups() {
  static const std::map<std::string, int> groups = {
      {"G0", 1},      {"G1", 1},       {"G4", 2},        {"G17", 6},     {"G40", 7},
      {"SUPA", 9},    {"G642", 10},    {"G9", 11},       {"G710", 13},   {"G90", 14},
      {"G94", 15},    {"ORIWKS", 25},  {"COMPOF", 30},   {"PTP", 49},    {"CP", 49},
      {"ORIRPY", 50}, {"ORIRPY2", 50}, {"ORIEULER", 50}, {"ORIVECT", 51}};
  return groups;
}

bool IsFrame(const std::string& word) {
  const double code = word.starts_with('G') ? ParseNumber(word.substr(1)).value_or(0) : 0;
  return (code >= 54 && code <= 57) || (code >= 500 && code <= 599);
}

}  // namespace

int SinumerikBlock::GroupOf(const std::string& word) {
  const auto found = Groups().find(word);
  if (found != Groups().end()) return found->second;
  return IsFrame(word) ? kFrameGroup : 0;
}

bool SinumerikBlock::IsAddress(const std::string& name) {
  static const std::vector<std::string> addresses = {"A", "B", "C", "D", "F",  "G",    "M",    "N",   "S",
                                                     "T", "X", "Y", "Z", "TU", "STAT", "CTOL", "OTOL"};
  return GroupOf(name) != 0 ||
         std::ranges::any_of(addresses, [&](const auto& address) { return SameWords(address, name); });
}

bool SinumerikBlock::Accept(LineScanner& scan) {
  return AcceptG(scan) || AcceptM(scan) || AcceptAddress(scan);
}

void SinumerikBlock::StandsAlone(LineScanner& scan, size_t start) const {
  if (!IsEmpty() || !scan.AtEnd()) scan.FailFrom(start, "a block of its own expected");
}

bool SinumerikBlock::AcceptG(LineScanner& scan) {
  const size_t start = scan.Next();
  for (const auto& [word, group] : Groups()) {
    if (word[0] == 'G' || !scan.Accept(word)) continue;
    AddG(scan, start, word);
    return true;
  }
  if (!scan.AcceptAddress('G', kBlanks)) return false;
  const std::string word = fmt::format("G{}", scan.ExpectDecimal());
  if (GroupOf(word) == 0)
    scan.FailFrom(start, "G0, G1, G4, G9, G17, G40, G90, G94, G505 to G599, G642 or G710 expected");
  AddG(scan, start, word);
  return true;
}

void SinumerikBlock::AddG(const LineScanner& scan, size_t start, const std::string& word) {
  for (const std::string& other : g_words_) {
    if (GroupOf(other) == GroupOf(word))
      scan.FailFrom(start, fmt::format("one of {} and {} in a block expected", other, word));
  }
  g_words_.push_back(word);
}

bool SinumerikBlock::AcceptM(LineScanner& scan) {
  const size_t start = scan.Next();
  if (!scan.AcceptAddress('M', kBlanks)) return false;
  scan.Accept("=");
  const double code = scan.ExpectDecimal();
  const int m = static_cast<int>(code);
  if (m != code || code < 0 || code > 1000) scan.FailFrom(start, "a whole number after M expected");
  if (std::ranges::find(m_codes_, m) != m_codes_.end())
    scan.FailFrom(start, fmt::format("M{} once in a block expected", m));
  m_codes_.push_back(m);
  return true;
}

bool SinumerikBlock::AcceptAddress(LineScanner& scan) {
  const size_t start = scan.Next();
  if (scan.Accept("T")) {
    scan.Expect("=");
    scan.Expect("\"");
    const std::string name = scan.TakeUntil('"');
    scan.Expect("\"");
    if (tool_ || name.empty()) scan.FailFrom(start, "one tool with a name in a block expected");
    tool_ = name;
    return true;
  }
  for (const char* address : {"STAT", "TU"}) {
    if (!scan.Accept(address)) continue;
    scan.Expect("=");
    Add(scan, start, address, scan.ExpectBits());
    return true;
  }
  std::vector<std::string> named(axis_names_.begin(), axis_names_.end());
  for (const std::string& word : orientation_)
    if (word.size() > 1) named.push_back(word);
  named.insert(named.end(), external_.begin(), external_.end());
  named.insert(named.end(), {"CTOL", "OTOL"});
  for (const std::string& address : named) {
    if (!scan.Accept(address)) continue;
    scan.Expect("=");
    Add(scan, start, address, scan.ExpectDecimal());
    return true;
  }
  std::string letters = "XYZFD";
  for (const std::string& word : orientation_)
    if (word.size() == 1) letters += word;
  for (const char letter : letters) {
    if (!scan.AcceptAddress(letter, kBlanks)) continue;
    scan.Accept("=");
    Add(scan, start, std::string(1, letter), scan.ExpectDecimal());
    return true;
  }
  return false;
}

void SinumerikBlock::Add(const LineScanner& scan, size_t start, const std::string& address, double value) {
  if (std::abs(value) > kFarthest)
    scan.FailFrom(start, fmt::format("a number from {} to {} expected", -kFarthest, kFarthest));
  if (!words_.emplace(address, value).second)
    scan.FailFrom(start, fmt::format("one {} in a block expected", address));
}

bool SinumerikBlock::Has(const std::string& g_word) const {
  return std::ranges::find(g_words_, g_word) != g_words_.end();
}

std::optional<double> SinumerikBlock::Word(const std::string& address) const {
  const auto found = words_.find(address);
  return found == words_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<int> SinumerikBlock::bits(const std::string& address) const {
  const auto word = Word(address);
  return word ? std::optional(static_cast<int>(*word)) : std::nullopt;
}

std::string SinumerikBlock::PoseWord(int i) const {
  return i < 3 ? std::string(1, "XYZ"[i]) : orientation_[static_cast<size_t>(i - 3)];
}

std::optional<double> SinumerikBlock::pose(int i) const { return Word(PoseWord(i)); }

std::optional<double> SinumerikBlock::axis(int i) const { return Word(axis_names_[static_cast<size_t>(i)]); }

bool SinumerikBlock::HasPose() const {
  for (int i = 0; i < 6; ++i) {
    if (pose(i)) return true;
  }
  return false;
}

bool SinumerikBlock::HasRobotAxes() const {
  for (int i = 0; i < 6; ++i) {
    if (axis(i)) return true;
  }
  return false;
}

bool SinumerikBlock::HasAxes() const {
  return HasRobotAxes() ||
         std::ranges::any_of(external_, [&](const std::string& name) { return Word(name).has_value(); });
}

}  // namespace millpose
