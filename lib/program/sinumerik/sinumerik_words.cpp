// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/sinumerik/sinumerik_words.hpp"

#include "base/angles.hpp"
#include "base/units.hpp"

namespace millpose::sinumerik {
namespace {

constexpr int kMostOutputs = 1024;  // $A_OUT[n]

int ReadWhole(LineScanner& scan, int least, int most) {
  const size_t start = scan.Next();
  return scan.WholeFrom(start, scan.ExpectDecimal(), least, most);
}

Eigen::Vector3d ReadTriple(LineScanner& scan, std::string_view function) {
  scan.Expect(function);
  scan.Expect("(");
  Eigen::Vector3d values;
  for (int i = 0; i < 3; ++i) {
    if (i) scan.Expect(",");
    scan.Expect(std::string(1, "XYZ"[i]));
    scan.Expect(",");
    values[i] = scan.ExpectDecimal();
  }
  scan.Expect(")");
  return values;
}

}  // namespace

Tolerances ReadTolerances(LineScanner& scan) {
  scan.Expect("(");
  const size_t start = scan.Next();
  const double position = scan.ExpectDecimal();
  scan.Expect(",");
  const bool off = scan.Accept("_OFF"), both = !off && scan.Accept("_ORI_FINISH");
  if (!off && !both) scan.Expect("_FINISH");
  scan.Expect(",");
  const double orientation = scan.ExpectDecimal() * kRadPerDeg;
  scan.Expect(")");
  if ((!off && position <= 0) || (both && orientation <= 0))
    scan.FailFrom(start, "tolerances above 0 expected");
  Tolerances tolerances;
  if (!off) tolerances.position = position;
  if (both) tolerances.orientation = orientation;
  return tolerances;
}

PathOutput ReadOutput(LineScanner& scan) {
  PathOutput output;
  scan.Expect("$A_OUT");
  scan.Expect("[");
  output.number = ReadWhole(scan, 1, kMostOutputs);
  scan.Expect("]");
  scan.Expect("=");
  output.on = ReadWhole(scan, 0, 1) == 1;
  return output;
}

Pose ReadFrame(LineScanner& scan) {
  Pose X = Pose::Identity();
  X.translation() = ReadTriple(scan, "CTRANS");
  scan.Expect(":");
  X.linear() = FromAnglesZyx(ReadTriple(scan, "CROT").reverse() * kRadPerDeg);
  return X;
}

}  // namespace millpose::sinumerik
