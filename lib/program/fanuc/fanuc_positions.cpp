// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/fanuc/fanuc_positions.hpp"

#include <set>

#include "base/text.hpp"
#include "program/controller_axes.hpp"
#include "program/fanuc/fanuc_words.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

constexpr std::array<const char*, 6> kPoseWords = {"X", "Y", "Z", "W", "P", "R"};
constexpr std::array<const char*, 6> kJointWords = {"J1", "J2", "J3", "J4", "J5", "J6"};
constexpr double kConstantSlack = 1e-3;  // mm or degrees
constexpr int kMostTurns = 127;          // a byte in the controller
constexpr double kLargest = 1e6;         // mm or degrees

/// A cursor over several lines.
class Records {
 public:
  Records(const std::string& file, const std::vector<std::string_view>& lines, size_t first, size_t last)
      : lines_(lines), file_(file), line_(first), last_(last), scan_(Scan()) {}

  bool AtEnd() {
    while (line_ < last_ && scan_.AtEnd()) Next();
    return line_ >= last_;
  }
  bool Accept(std::string_view word) { return !AtEnd() && scan_.Accept(word); }
  void Expect(std::string_view word) {
    if (!Accept(word)) Fail(fmt::format("'{}' expected", word));
  }
  LineScanner& scan() {
    AtEnd();
    return scan_;
  }
  [[noreturn]] void Fail(const std::string& message) {
    if (line_ >= last_)
      throw InputError({file_, static_cast<int>(last_), 0, -1}, message + ", but /POS ends");
    scan_.Fail(message);
  }
  int number() const { return static_cast<int>(line_) + 1; }
  /// Goes on behind the record that is being read.
  void SkipRecord() {
    while (line_ < last_ && lines_[line_].find('}') == std::string_view::npos) Next();
    if (line_ < last_) Next();
  }

 private:
  LineScanner Scan() const {
    return {line_ < last_ ? lines_[line_] : std::string_view(), file_, static_cast<int>(line_) + 1};
  }
  void Next() {
    ++line_;
    scan_ = Scan();
  }

  const std::vector<std::string_view>& lines_;
  const std::string& file_;
  size_t line_, last_;
  LineScanner scan_;
};

class PositionReader {
 public:
  PositionReader(Records& records, const PostSettings& settings, const FanucOptions& options)
      : records_(records), options_(options), axes_(FanucAxes(settings)) {}

  /// P[3]{ … }; with the number taken.
  FanucPosition Read() {
    position_.line = records_.number();
    records_.Expect("{");
    records_.Expect("GP1");
    records_.Expect(":");
    ReadFrames();
    position_.joints = !records_.Accept("CONFIG");
    if (!position_.joints) ReadConfig();
    ReadNumbers();
    ReadExternal(1);
    if (std::ranges::any_of(axes_, [](const FanucAxis& axis) { return axis.group == 2; })) ReadSecondGroup();
    records_.Expect("}");
    records_.Expect(";");
    return position_;
  }

 private:
  void ReadFrames() {
    for (const auto& [word, wanted] :
         {std::pair("UF", options_.user_frame), std::pair("UT", options_.tool_frame)}) {
      records_.Expect(word);
      records_.Expect(":");
      LineScanner& scan = records_.scan();
      const size_t start = scan.Next();
      if (scan.AcceptName() || fanuc::ReadWhole(scan, 0, 100) != wanted)
        scan.FailFrom(start, fmt::format("{} {} expected, as the cell's {} says and {}_NUM selects", word,
                                         wanted, word == std::string("UF") ? "user_frame" : "tool_frame",
                                         word == std::string("UF") ? "UFRAME" : "UTOOL"));
      records_.Expect(",");
    }
  }

  void ReadConfig() {
    records_.Expect(":");
    LineScanner& scan = records_.scan();
    scan.Expect("'");
    FanucConfig& config = position_.config;
    config.status |= ReadLetter(scan, "F", "N") ? 4 : 0;
    config.status |= ReadLetter(scan, "U", "D") ? 2 : 0;
    config.status |= ReadLetter(scan, "B", "T") ? 1 : 0;
    for (int& turn : config.turns) {
      scan.Expect(",");
      turn = fanuc::ReadWhole(scan, -kMostTurns, kMostTurns);
    }
    scan.Expect("'");
    records_.Expect(",");
  }

  static bool ReadLetter(LineScanner& scan, const char* set, const char* otherwise) {
    const bool is_set = scan.Accept(set);
    if (!is_set && !scan.Accept(otherwise)) scan.Fail(fmt::format("{} or {} expected", set, otherwise));
    return is_set;
  }

  void ReadNumbers() {
    const auto& words = position_.joints ? kJointWords : kPoseWords;
    for (size_t i = 0; i < 6; ++i) {
      if (i > 0) records_.Expect(",");
      records_.Expect(words[i]);
      position_.numbers[i] = ReadValue(position_.joints || i > 2);
    }
  }

  double ReadValue(bool degrees) {
    records_.Expect("=");
    LineScanner& scan = records_.scan();
    const size_t start = scan.Next();
    const double value = scan.ExpectDecimal();
    if (std::abs(value) > kLargest) scan.FailFrom(start, "a number up to 1e6 expected");
    scan.Expect(degrees ? "deg" : "mm");
    return value;
  }

  /// E1 = 100.000 mm: behind the six of group 1, or J1 of group 2.
  void ReadExternal(int group) {
    bool first = group == 2;
    for (const FanucAxis& axis : axes_) {
      if (axis.group != group) continue;
      if (!std::exchange(first, false)) records_.Expect(",");
      records_.Expect(axis.word);
      LineScanner& scan = records_.scan();
      const size_t start = scan.Next();
      const double value = ReadValue(axis.rotary);
      if (axis.axis->axis.empty() && std::abs(value - axis.axis->constant) > kConstantSlack)
        scan.FailFrom(start, fmt::format("{} stays at {} in this program; that value expected",
                                         axis.axis->name, axis.axis->constant));
      position_.external[axis.axis->name] = value;
    }
  }

  void ReadSecondGroup() {
    records_.Expect("GP2");
    records_.Expect(":");
    ReadFrames();
    ReadExternal(2);
  }

  Records& records_;
  const FanucOptions& options_;
  const std::vector<FanucAxis> axes_;
  FanucPosition position_;
};

/// "P[3]" or "P[3:"name"]": its number.
int ReadPositionNumber(Records& records) {
  records.Expect("P");
  records.Expect("[");
  LineScanner& scan = records.scan();
  const int number = fanuc::ReadWhole(scan, 1, 1000000);
  if (scan.Accept(":")) scan.TakeUntil(']');
  scan.Expect("]");
  return number;
}

}  // namespace

FanucPositions ReadFanucPositions(const std::string& file, const std::vector<std::string_view>& lines,
                                  size_t first, size_t last, const PostSettings& settings,
                                  const FanucOptions& options, std::vector<Problem>& problems) {
  FanucPositions positions;
  Records records(file, lines, first, last);
  while (!records.AtEnd()) {
    try {
      LineScanner& scan = records.scan();
      const size_t start = scan.Next();
      const int line = records.number(), number = ReadPositionNumber(records);
      if (const auto known = positions.find(number); known != positions.end())
        scan.FailFrom(start,
                      fmt::format("a number that no other position has expected: P[{}] is at line {} too",
                                  number, known->second.line));
      FanucPosition position = PositionReader(records, settings, options).Read();
      position.line = line;
      positions.emplace(number, std::move(position));
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
      records.SkipRecord();
    }
  }
  return positions;
}

std::string FanucPositionText(int number, const FanucPosition& position, const PostSettings& settings,
                              const FanucOptions& options) {
  const std::string frames = fmt::format("    UF : {}, UT : {},", options.user_frame, options.tool_frame);
  std::string text = fmt::format("P[{}]{{\n   GP1:\n{}", number, frames);
  text += position.joints ? "\n" : fmt::format("  CONFIG : '{}',\n", FanucConfigText(position.config));
  const auto value = [](const std::string& word, double amount, bool degrees) {
    return fmt::format("{} = {} {}", word, Fixed(amount, kFanucDecimals), degrees ? "deg" : "mm");
  };
  const auto& words = position.joints ? kJointWords : kPoseWords;
  for (size_t i = 0; i < 6; ++i)
    text += fmt::format("{}{}",
                        i == 0   ? "    "
                        : i == 3 ? ",\n    "
                                 : ", ",
                        value(words[i], position.numbers[i], position.joints || i > 2));
  std::string second;
  for (const FanucAxis& axis : FanucAxes(settings)) {
    const std::string external = value(axis.word, position.external.at(axis.axis->name), axis.rotary);
    if (axis.group == 1)
      text += ",\n    " + external;
    else
      second.append(second.empty() ? "\n   GP2:\n" + frames + "\n    " : ", ").append(external);
  }
  return text + second + "\n};\n";
}

}  // namespace millpose
