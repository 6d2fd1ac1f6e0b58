// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl/krl_words.hpp"

#include "base/angles.hpp"
#include "base/units.hpp"

namespace millpose::krl {
namespace {

constexpr int kDeepestBrackets = 16;
constexpr int kMostBits = 63, kLongestDelay = 10000;  // of S and T; ms

int ReadBits(LineScanner& scan) {
  return scan.Peek() == '\'' ? scan.ExpectBits() : ReadWhole(scan, 0, kMostBits);
}

int ReadIndex(LineScanner& scan) {
  scan.Expect("[");
  const int number = ReadWhole(scan, 1, 8192);
  scan.Expect("]");
  return number;
}

void ReadOperand(LineScanner& scan, int depth) {
  while (scan.Accept("NOT")) {
  }
  if (scan.Accept("(")) {
    if (depth == kDeepestBrackets) scan.Fail("fewer brackets expected");
    do {
      ReadOperand(scan, depth + 1);
    } while (scan.Accept("AND") || scan.Accept("OR") || scan.Accept("EXOR"));
    scan.Expect(")");
  } else if (scan.Accept("$IN") || scan.Accept("$OUT") || scan.Accept("$FLAG")) {
    ReadIndex(scan);
    if (scan.Accept("==")) ReadTruth(scan);
  } else {
    scan.Fail("what to wait for expected: $IN[n], $OUT[n] or $FLAG[n] with NOT, AND, OR, EXOR");
  }
}

}  // namespace

int ReadWhole(LineScanner& scan, int least, int most) {
  const size_t start = scan.Next();
  return scan.WholeFrom(start, scan.ExpectNumber(), least, most);
}

bool ReadTruth(LineScanner& scan) {
  const bool truth = scan.Accept("TRUE");
  if (!truth && !scan.Accept("FALSE")) scan.Fail("TRUE or FALSE expected");
  return truth;
}

Fields ReadFields(LineScanner& scan, const std::vector<std::string>& types,
                  const std::vector<std::string>& allowed) {
  Fields fields;
  scan.Expect("{");
  for (const std::string& type : types) {
    if (!scan.Accept(type)) continue;
    scan.Expect(":");
    break;
  }
  do {
    const std::string* field = nullptr;
    for (const std::string& name : allowed) {
      if (scan.Accept(name)) field = &name;
      if (field) break;
    }
    if (!field) scan.Fail(fmt::format("one of the fields {} expected", fmt::join(allowed, ", ")));
    if (fields.contains(*field)) scan.Fail(fmt::format("field {} is given twice", *field));
    fields[*field] = *field == "S" || *field == "T" ? ReadBits(scan) : scan.ExpectNumber();
  } while (scan.Accept(","));
  scan.Expect("}");
  return fields;
}

void ExpectAll(LineScanner& scan, const Fields& fields, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (!fields.contains(name)) scan.Fail(fmt::format("field {} is missing", name));
  }
}

Pose PoseOf(const Fields& fields) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(fields.at("X"), fields.at("Y"), fields.at("Z"));
  pose.linear() = FromAnglesZyx(Eigen::Vector3d(fields.at("A"), fields.at("B"), fields.at("C")) * kRadPerDeg);
  return pose;
}

Pose ReadFrame(LineScanner& scan) {
  const std::vector<std::string> names = {"X", "Y", "Z", "A", "B", "C"};
  const Fields fields = ReadFields(scan, {"FRAME"}, names);
  ExpectAll(scan, fields, names);
  return PoseOf(fields);
}

Pose ReadTableBase(LineScanner& scan, int machine_def) {
  scan.Expect("=");
  scan.Expect("EK");
  scan.Expect("(");
  for (const char* part : {".ROOT", ".MECH_TYPE"}) {
    const size_t start = scan.Next();
    scan.Expect("MACHINE_DEF");
    if (ReadIndex(scan) != machine_def)
      scan.FailFrom(start, fmt::format("MACHINE_DEF[{}] expected, as in the cell", machine_def));
    scan.Expect(part);
    scan.Expect(",");
  }
  Pose frame = ReadFrame(scan);
  scan.Expect(")");
  return frame;
}

double ReadPositive(LineScanner& scan) {
  scan.Expect("=");
  return ReadAboveZero(scan);
}

double ReadAboveZero(LineScanner& scan) {
  const size_t start = scan.Next();
  const double value = scan.ExpectNumber();
  if (!(value > 0)) scan.FailFrom(start, "a number above 0 expected");
  return value;
}

PathOutput ReadTrigger(LineScanner& scan) {
  scan.Expect("DISTANCE");
  scan.Expect("=");
  const size_t start = scan.Next();
  if (scan.ExpectNumber() != 0) scan.FailFrom(start, "0 expected (switching where the next motion begins)");
  PathOutput output;
  scan.Expect("DELAY");
  scan.Expect("=");
  output.delay = ReadWhole(scan, -kLongestDelay, kLongestDelay) / 1000.0;
  scan.Expect("DO");
  scan.Expect("$OUT");
  output.number = ReadIndex(scan);
  scan.Expect("=");
  output.on = ReadTruth(scan);
  return output;
}

bool ReadOutput(LineScanner& scan) {
  if (scan.Accept("PULSE")) {
    scan.Expect("(");
    scan.Expect("$OUT");
    ReadIndex(scan);
    scan.Expect(",");
    ReadTruth(scan);
    scan.Expect(",");
    scan.ExpectNumber();
    scan.Expect(")");
  } else if (scan.Accept("$OUT")) {
    ReadIndex(scan);
    scan.Expect("=");
    ReadTruth(scan);
  } else if (scan.Accept("$ANOUT")) {
    ReadIndex(scan);
    scan.Expect("=");
    do {
      scan.ExpectNumber();
    } while (scan.Accept("*") || scan.Accept("/"));
  } else {
    return false;
  }
  return true;
}

void ReadCondition(LineScanner& scan) {
  do {
    ReadOperand(scan, 0);
  } while (scan.Accept("AND") || scan.Accept("OR") || scan.Accept("EXOR"));
}

}  // namespace millpose::krl
