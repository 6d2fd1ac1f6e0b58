// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/urscript/urscript_words.hpp"

#include "machine/motion/rotation_vector.hpp"

namespace millpose::urscript {
namespace {

struct Output {
  std::string_view name;
  int numbers;
};
constexpr std::array<Output, 3> kDigital = {
    {{"set_standard_digital_out", 8}, {"set_configurable_digital_out", 8}, {"set_tool_digital_out", 2}}};
constexpr std::array<Output, 3> kInputs = {
    {{"get_standard_digital_in", 8}, {"get_configurable_digital_in", 8}, {"get_tool_digital_in", 2}}};
constexpr int kAnalogue = 2;

void ReadOutput(LineScanner& scan, const Output& output) {
  scan.Expect("(");
  ReadWhole(scan, 0, output.numbers - 1);
  scan.Expect(",");
  ReadTruth(scan);
  scan.Expect(")");
}

/// Of its full scale, as a number or a quotient such as 12000/24000.
void ReadAnalogue(LineScanner& scan) {
  scan.Expect("(");
  ReadWhole(scan, 0, kAnalogue - 1);
  scan.Expect(",");
  do {
    ReadNumber(scan);
  } while (scan.Accept("*") || scan.Accept("/"));
  scan.Expect(")");
}

/// while get_standard_digital_in(0) == False:
void ReadWhile(LineScanner& scan) {
  for (const Output& input : kInputs) {
    if (!Word(scan, input.name)) continue;
    scan.Expect("(");
    ReadWhole(scan, 0, input.numbers - 1);
    scan.Expect(")");
    scan.Expect("==");
    ReadTruth(scan);
    return scan.Expect(":");
  }
  scan.Fail("an input to wait for expected, such as get_standard_digital_in(0) == False");
}

}  // namespace

bool Word(LineScanner& scan, std::string_view word) {
  LineScanner ahead = scan;
  const size_t start = ahead.Next();
  if (!ahead.Accept(word) || ahead.TakenFrom(start) != word) return false;
  scan = ahead;
  return true;
}

double ReadNumber(LineScanner& scan) {
  const char first = scan.Peek();
  if (first != '-' && (first < '0' || first > '9')) scan.Fail("a number expected");
  const size_t start = scan.Next();
  const double number = scan.ExpectDecimal();
  const std::string text = scan.TakenFrom(start);
  if (text.starts_with("-.") || text.ends_with('.')) scan.FailFrom(start, "digits round the point expected");
  return number;
}

int ReadWhole(LineScanner& scan, int least, int most) {
  const size_t start = scan.Next();
  return scan.WholeFrom(start, ReadNumber(scan), least, most);
}

bool ReadTruth(LineScanner& scan) {
  const bool truth = Word(scan, "True");
  if (!truth && !Word(scan, "False")) scan.Fail("True or False expected");
  return truth;
}

std::string ReadString(LineScanner& scan) {
  scan.Expect("\"");
  std::string text = scan.TakeUntil('"');
  scan.Expect("\"");
  return text;
}

std::vector<double> ReadList(LineScanner& scan, size_t count) {
  std::vector<double> numbers;
  scan.Expect("[");
  for (size_t i = 0; i < count; ++i) {
    if (i > 0) scan.Expect(",");
    numbers.push_back(ReadNumber(scan));
  }
  scan.Expect("]");
  return numbers;
}

Pose ReadPose(LineScanner& scan) {
  if (!Word(scan, "p") || scan.Peek() != '[') scan.Fail("a pose p[x, y, z, rx, ry, rz] expected");
  const std::vector<double> numbers = ReadList(scan, 6);
  Pose pose = Pose::Identity();
  pose.translation() = 1000 * Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  pose.linear() = FromRotationVector({numbers[3], numbers[4], numbers[5]});
  return pose;
}

std::map<std::string, double> ReadNamed(LineScanner& scan, const std::vector<std::string>& allowed) {
  std::map<std::string, double> named;
  while (scan.Accept(",")) {
    const size_t start = scan.Next();
    const auto name = std::ranges::find_if(allowed, [&](const auto& word) { return Word(scan, word); });
    if (name == allowed.end()) scan.Fail(fmt::format("one of {} by name expected", fmt::join(allowed, ", ")));
    scan.Expect("=");
    if (!named.emplace(*name, ReadNumber(scan)).second)
      scan.FailFrom(start, fmt::format("{} once expected", *name));
  }
  return named;
}

bool ReadPopup(LineScanner& scan) {
  scan.Expect("(");
  ReadString(scan);
  bool blocking = false;
  while (scan.Accept(",")) {
    if (Word(scan, "title")) {
      scan.Expect("=");
      ReadString(scan);
      continue;
    }
    const bool blocks = Word(scan, "blocking");
    if (!blocks && !Word(scan, "warning") && !Word(scan, "error"))
      scan.Fail("title, warning, error or blocking by name expected");
    scan.Expect("=");
    const bool truth = ReadTruth(scan);
    if (blocks) blocking = truth;
  }
  scan.Expect(")");
  return blocking;
}

bool ReadTextStatement(LineScanner& scan, int& loops) {
  for (const Output& output : kDigital)
    if (Word(scan, output.name)) {
      ReadOutput(scan, output);
      return true;
    }
  if (Word(scan, "set_standard_analog_out")) {
    ReadAnalogue(scan);
  } else if (Word(scan, "popup")) {
    ReadPopup(scan);
  } else if (Word(scan, "textmsg")) {
    scan.Expect("(");
    ReadString(scan);
    scan.Expect(")");
  } else if (Word(scan, "sync")) {
    scan.Expect("(");
    scan.Expect(")");
  } else if (Word(scan, "while")) {
    ReadWhile(scan);
    ++loops;
  } else if (loops > 0 && Word(scan, "end")) {
    --loops;
  } else {
    return false;
  }
  return true;
}

}  // namespace millpose::urscript
