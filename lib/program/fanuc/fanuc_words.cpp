// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/fanuc/fanuc_words.hpp"

#include <fmt/format.h>

#include <cmath>

namespace millpose::fanuc {
namespace {

constexpr int kMostIndex = 10000, kMostSpeed = 12000;

/// A signal of a condition.
void ReadSignal(LineScanner& scan) {
  scan.Accept("!");
  for (const char* name : {"DI", "DO", "RI", "RO", "UI", "UO", "SI", "SO", "F", "M"}) {
    if (!scan.Accept(name)) continue;
    ReadIndex(scan);
    if (scan.Accept("=") || scan.Accept("<>")) ReadOnOff(scan);
    return;
  }
  scan.Fail(
      "a signal to wait for expected: DI[n], DO[n], RI[n], RO[n], UI[n], UO[n], SI[n], SO[n], F[n] or M[n]");
}

}  // namespace

int ReadWhole(LineScanner& scan, int least, int most) {
  const size_t start = scan.Next();
  return scan.WholeFrom(start, scan.ExpectDecimal(), least, most);
}

double ReadConstant(LineScanner& scan) {
  const bool brackets = scan.Accept("(");
  const size_t start = scan.Next();
  const double number = scan.ExpectDecimal();
  if (number < 0 && !brackets) scan.FailFrom(start, "a negative number in brackets expected");
  if (brackets) scan.Expect(")");
  return number;
}

int ReadIndex(LineScanner& scan) {
  scan.Expect("[");
  const int number = ReadWhole(scan, 1, kMostIndex);
  if (scan.Accept(":")) scan.TakeUntil(']');
  scan.Expect("]");
  return number;
}

bool ReadOnOff(LineScanner& scan) {
  const bool brackets = scan.Accept("("), on = scan.Accept("ON");
  if (!on && !scan.Accept("OFF")) scan.Fail("ON or OFF expected");
  if (brackets) scan.Expect(")");
  return on;
}

double ReadFeed(LineScanner& scan) {
  const size_t start = scan.Next();
  if (scan.Accept("R")) scan.FailFrom(start, "a number expected: what a register holds is not known");
  const int number = ReadWhole(scan, 1, kMostSpeed);
  if (scan.Accept("mm/sec")) {
    if (number > 2000) scan.FailFrom(start, "at most 2000mm/sec expected");
    return number;
  }
  if (!scan.Accept("cm/min")) scan.Fail("mm/sec or cm/min expected");
  return number / 6.0;
}

std::optional<double> ReadSeconds(LineScanner& scan) {
  const char next = scan.Peek();
  if (next != '.' && (next < '0' || next > '9')) return std::nullopt;
  const double seconds = scan.ExpectDecimal();
  scan.Expect("(");
  scan.Expect("sec");
  scan.Expect(")");
  return seconds;
}

void ReadCondition(LineScanner& scan) {
  const bool brackets = scan.Accept("(");
  ReadSignal(scan);
  if (scan.Accept("AND")) {
    do ReadSignal(scan);
    while (scan.Accept("AND"));
  } else if (scan.Accept("OR")) {
    do ReadSignal(scan);
    while (scan.Accept("OR"));
  }
  if (brackets) scan.Expect(")");
}

bool ReadTextWord(LineScanner& scan) {
  if (scan.Accept("DO") || scan.Accept("RO")) {
    ReadIndex(scan);
    scan.Expect("=");
    if (!scan.Accept("PULSE")) {
      ReadOnOff(scan);
    } else if (scan.Accept(",")) {
      scan.ExpectDecimal();
      scan.Expect("sec");
    }
    return true;
  }
  if (scan.Accept("PAYLOAD")) {
    ReadIndex(scan);
    return true;
  }
  if (!scan.Accept("GO") && !scan.Accept("AO") && !scan.Accept("R")) return false;
  ReadIndex(scan);
  scan.Expect("=");
  ReadConstant(scan);
  return true;
}

}  // namespace millpose::fanuc
