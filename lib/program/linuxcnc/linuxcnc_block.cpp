// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/linuxcnc/linuxcnc_block.hpp"

#include "base/text.hpp"

namespace millpose {
namespace {

constexpr double kWholeSlack = 0.99e-4;  // of the interpreter's 0.0001
constexpr double kFarthest = 1e5;        // mm or degrees: nothing that an arm can mean is larger

/// A number of a code, in parts of `parts`: the interpreter takes what is off by up to 0.0001 for it.
double Whole(double value, double parts) {
  const double whole = std::round(value * parts) / parts;
  return std::abs(value - whole) < kWholeSlack ? whole : value;
}

/// The modal group of a G code that this reader knows; 0 for one that it does not. LinuxCNC, G-code overview.
int GroupOf(double g) {
  static const std::map<double, int> groups = {{0, 2},  {1, 2},    {4, 1},     {10, 1},  {17, 3},    {21, 7},
                                               {40, 8}, {49, 9},   {59.3, 13}, {61, 14}, {61.1, 14}, {64, 14},
                                               {90, 4}, {92.1, 1}, {93, 6},    {94, 6}};
  const auto found = groups.find(g);
  return found == groups.end() ? 0 : found->second;
}

}  // namespace

void LinuxCncBlock::AddG(const LineScanner& scan, size_t start, double code) {
  code = Whole(code, 10);
  const int group = GroupOf(code);
  if (group == 0)
    scan.FailFrom(
        start,
        "G0, G1, G4, G10, G17, G21, G40, G49, G59.3, G61, G61.1, G64, G90, G92.1, G93 or G94 expected");
  for (const double other : g) {
    if (GroupOf(other) == group)
      scan.FailFrom(start, fmt::format("one of G{} and G{} in a block expected", other, code));
  }
  g.push_back(code);
}

void LinuxCncBlock::AddM(const LineScanner& scan, size_t start, double code) {
  code = Whole(code, 1);
  if (code != 0 && code != 1 && code != 2 && code != 30 && code != 62 && code != 63)
    scan.FailFrom(start, "M0, M1, M2, M30, M62 or M63 expected (spindle and coolant: the cell's texts)");
  if (!m.empty()) scan.FailFrom(start, fmt::format("one of M{} and M{} in a block expected", m[0], code));
  m.push_back(code);
}

bool LinuxCncBlock::AcceptWord(LineScanner& scan, std::string_view letters) {
  const size_t start = scan.Next();
  for (const char letter : letters) {
    if (!scan.AcceptAddress(letter)) continue;
    const double value = scan.ExpectDecimal(kLinuxCncBlanks);
    if (letter != 'F' && std::abs(value) > kFarthest)  // F may be 1/min of a short block
      scan.FailFrom(start, fmt::format("a number from {0} to {1} expected", -kFarthest, kFarthest));
    if (!words.emplace(letter, value).second)
      scan.FailFrom(start, fmt::format("one {} in a block expected", letter));
    return true;
  }
  return false;
}

std::optional<std::string> AcceptLinuxCncCall(LineScanner& scan, std::string& arguments) {
  if (scan.Accept("O<")) {
    auto name = scan.AcceptName();
    if (!name) scan.Fail("the name of a program expected");
    scan.Expect(">");
    scan.Expect("CALL");
    while (scan.Accept("[")) {
      arguments += (arguments.empty() ? "" : ",") + ShortestNumber(scan.ExpectNumber());
      scan.Expect("]");
    }
    return name;
  }
  if (const char first = scan.Peek(); first != 'M' && first != 'm') return std::nullopt;
  for (int code = 100; code < 200; ++code) {
    const std::string word = fmt::format("M{}", code);
    if (scan.Accept(word)) return word;
  }
  return std::nullopt;
}

}  // namespace millpose
