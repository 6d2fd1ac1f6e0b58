// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/rapid/rapid_data.hpp"

#include "base/text.hpp"
#include "program/controller_axes.hpp"

namespace millpose::rapid {
namespace {

constexpr int kLengthDecimals = 4;
constexpr int kQuaternionDecimals = 8;
constexpr int kSpeedDecimals = 5;  // of mm/s
constexpr int kLoadDecimals = 4;
constexpr double kNormWithin = 1e-5;
constexpr double kSameNumber = 1e-6;  // of what the cell says and a num can hold; relative

double RoundedToNum(double value) { return static_cast<double>(static_cast<float>(value)); }

std::string Triple(const Eigen::Vector3d& v, int decimals) {
  return fmt::format("[{},{},{}]", NumText(v.x(), decimals), NumText(v.y(), decimals),
                     NumText(v.z(), decimals));
}

bool ReadTruth(LineScanner& scan) {
  const bool truth = scan.Accept("TRUE");
  if (!truth && !scan.Accept("FALSE")) scan.Fail("TRUE or FALSE expected");
  return truth;
}

bool Same(double given, double wanted) {
  const double text = Rounded(wanted, kLoadDecimals);
  return std::abs(given - text) <= kSameNumber * std::max(1.0, std::abs(text));
}

/// Numbers that must be these.
template <size_t N>
void ExpectNums(LineScanner& scan, const std::array<double, N>& wanted, const char* what) {
  const size_t start = scan.Next();
  const std::array<double, N> given = ReadNums<N>(scan);
  for (size_t i = 0; i < N; ++i)
    if (!Same(given[i], wanted[i])) scan.FailFrom(start, what);
}

void ExpectNum(LineScanner& scan, double wanted, const std::string& what) {
  const size_t start = scan.Next();
  if (!Same(ReadNum(scan), wanted))
    scan.FailFrom(start, fmt::format("{} expected ({})", NumText(wanted, kLoadDecimals), what));
}

}  // namespace

std::string NumText(double value, int decimals) { return Short(RoundedToNum(value), decimals); }

Eigen::Vector4d QuaternionOf(const Eigen::Matrix3d& R, const Eigen::Vector4d& near) {
  const Eigen::Quaterniond q(R);
  const Eigen::Vector4d parts(q.w(), q.x(), q.y(), q.z());
  double side = parts.dot(near);
  constexpr double kNeither = 1e-6;  // where rounding would decide, the first component that is not 0 does
  for (int i = 0; i < 4 && std::abs(side) < kNeither; ++i) side = parts[i];
  return side < 0 ? Eigen::Vector4d(-parts) : parts;
}

// Rounding leaves the norm a little off 1, and a reader scales that back: again until it changes nothing.
std::string QuaternionText(Eigen::Vector4d q) {
  constexpr int kMostTimes = 8;
  std::string text;
  for (int time = 0; time < kMostTimes; ++time) {
    std::string next;
    for (int i = 0; i < 4; ++i) {
      const std::string part = NumText(q[i], kQuaternionDecimals);
      next += (i > 0 ? "," : "[") + part;
      q[i] = RoundedToNum(ParseNumber(part).value());
    }
    if (next == text) break;
    text = next;
    q /= std::sqrt(q.squaredNorm());
  }
  return text + "]";
}

std::string PoseAggregate(const Pose& pose) {
  return fmt::format("[{},{}]", Triple(pose.translation(), kLengthDecimals),
                     QuaternionText(QuaternionOf(pose.linear(), Eigen::Vector4d::UnitX())));
}

std::string ToolText(const Pose& X_FC, const ToolLoad& load) {
  const Eigen::Vector3d& i = load.inertia;
  return fmt::format("[TRUE,{},[{},{},[1,0,0,0],{},{},{}]]", PoseAggregate(X_FC),
                     NumText(load.mass, kLoadDecimals), Triple(load.centre, kLoadDecimals),
                     NumText(i.x(), kLoadDecimals), NumText(i.y(), kLoadDecimals),
                     NumText(i.z(), kLoadDecimals));
}

std::string WorkObjectText(const WorkObject& object) {
  const std::string none = "[[0,0,0],[1,0,0,0]]", frame = PoseAggregate(object.frame);
  return object.unit.empty() ? fmt::format("[FALSE,TRUE,\"\",{},{}]", frame, none)
                             : fmt::format("[FALSE,FALSE,\"{}\",{},{}]", object.unit, none, frame);
}

std::string SpeedText(const Speed& speed) {
  return fmt::format("[{},{},{},{}]", NumText(speed.tip, kSpeedDecimals),
                     NumText(speed.turn * kDegPerRad, kLoadDecimals), NumText(kLinearAxisSpeed, 0),
                     NumText(kRotaryAxisSpeed, 0));
}

std::string ZoneText(double distance) {
  const std::string d = NumText(distance, kLengthDecimals);
  return fmt::format("[FALSE,{0},{0},{0},{1},{2},{3}]", d, NumText(kWideZones[0], 0),
                     NumText(kWideZones[1], 0), NumText(kWideZones[2], 0));
}

double ReadNum(LineScanner& scan) { return RoundedToNum(scan.ExpectNumber()); }

Eigen::Matrix3d ReadOrient(LineScanner& scan) {
  const size_t start = scan.Next();
  const std::array<double, 4> q = ReadNums<4>(scan);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(norm - 1) <= kNormWithin))
    scan.FailFrom(start, fmt::format("a quaternion of norm 1 (within 1e-5) expected; it has {:.7f}", norm));
  return Eigen::Quaterniond(q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm).toRotationMatrix();
}

Pose ReadPose(LineScanner& scan) {
  Pose pose = Pose::Identity();
  scan.Expect("[");
  const std::array<double, 3> p = ReadNums<3>(scan);
  pose.translation() = Eigen::Vector3d(p[0], p[1], p[2]);
  scan.Expect(",");
  pose.linear() = ReadOrient(scan);
  scan.Expect("]");
  return pose;
}

Pose ReadTool(LineScanner& scan, const ToolLoad& load) {
  scan.Expect("[");
  const size_t start = scan.Next();
  if (!ReadTruth(scan)) scan.FailFrom(start, "TRUE expected: the robot holds the tool");
  scan.Expect(",");
  Pose frame = ReadPose(scan);
  scan.Expect(",");
  scan.Expect("[");
  ExpectNum(scan, load.mass, "kg, the cell's tool.load");
  scan.Expect(",");
  const Eigen::Vector3d &c = load.centre, &i = load.inertia;
  ExpectNums<3>(scan, {c.x(), c.y(), c.z()}, "the centre of the cell's tool.load expected");
  scan.Expect(",");
  ExpectNums<4>(scan, {1, 0, 0, 0}, "[1,0,0,0] expected: moments along tool0's axes");
  for (const double moment : {i.x(), i.y(), i.z()}) {
    scan.Expect(",");
    ExpectNum(scan, moment, "kg m2, the cell's tool.load");
  }
  scan.Expect("]");
  scan.Expect("]");
  return frame;
}

WorkObject ReadWorkObject(LineScanner& scan, const std::string& unit) {
  scan.Expect("[");
  const size_t start = scan.Next();
  if (ReadTruth(scan)) scan.FailFrom(start, "FALSE expected: the robot holds the tool, not the part");
  scan.Expect(",");
  const size_t fixed = scan.Next();
  if (ReadTruth(scan) != unit.empty())
    scan.FailFrom(fixed, unit.empty() ? "TRUE expected: the cell has no work_unit"
                                      : "FALSE expected: the cell's work_unit carries the part");
  scan.Expect(",");
  const size_t name = scan.Next();
  scan.Expect("\"");
  const std::string given = scan.TakeUntil('"');
  scan.Expect("\"");
  if (!SameWords(given, unit)) scan.FailFrom(name, fmt::format("\"{}\" expected", unit));
  scan.Expect(",");
  const Pose user = ReadPose(scan);
  scan.Expect(",");
  const size_t frame = scan.Next();
  const Pose object = ReadPose(scan);
  // With a unit the controller takes the unit's frame, whatever uframe says.
  if (!unit.empty() && !user.matrix().isIdentity(1e-9))
    scan.FailFrom(frame, fmt::format("[[0,0,0],[1,0,0,0]] before it expected: {} is the user frame", unit));
  scan.Expect("]");
  return {unit, user * object};
}

Speed ReadSpeed(LineScanner& scan) {
  const size_t start = scan.Next();
  const std::array<double, 4> v = ReadNums<4>(scan);
  if (!(v[0] > 0) || !(v[1] > 0)) scan.FailFrom(start, "speeds above 0 expected");
  if (v[2] != kLinearAxisSpeed || v[3] != kRotaryAxisSpeed)
    scan.FailFrom(start, fmt::format("v_leax {} and v_reax {} expected", kLinearAxisSpeed, kRotaryAxisSpeed));
  return {v[0], v[1] * kRadPerDeg};
}

double ReadZone(LineScanner& scan) {
  const size_t start = scan.Next();
  scan.Expect("[");
  if (ReadTruth(scan)) scan.FailFrom(start, "FALSE expected; a stop is fine");
  std::array<double, 6> zone{};
  for (double& part : zone) {
    scan.Expect(",");
    part = ReadNum(scan);
  }
  scan.Expect("]");
  if (!(zone[0] > 0)) scan.FailFrom(start, "a zone above 0 expected; a stop is fine");
  if (zone[1] < 0 || zone[2] < 0) scan.FailFrom(start, "pzone_ori and pzone_eax of 0 or more expected");
  if (zone[1] > zone[0] || zone[2] > zone[0])
    scan.FailFrom(start,
                  "pzone_ori and pzone_eax no larger than pzone_tcp expected: of larger ones nobody says "
                  "how far the orientation leaves its corner");
  for (size_t i = 0; i < kWideZones.size(); ++i)
    if (zone[i + 3] != kWideZones[i])
      scan.FailFrom(start, fmt::format("zone_ori {}, zone_leax {} and zone_reax {} expected", kWideZones[0],
                                       kWideZones[1], kWideZones[2]));
  return zone[0];
}

}  // namespace millpose::rapid
