// SPDX-License-Identifier: GPL-3.0-or-later
// Values of RAPID's data types as texts and back. `num` has 24 bits: what is read is rounded to them.
#pragma once

#include <array>

#include "program/rapid/rapid_options.hpp"
#include "program/scanner.hpp"

namespace millpose::rapid {

/// Of linear and rotary external axes in every speeddata: never what bounds a motion of ours.
inline constexpr double kLinearAxisSpeed = 5000, kRotaryAxisSpeed = 1000;  // mm/s, deg/s
/// zone_ori, zone_leax, zone_reax of every zonedata: so large that they never make a zone smaller.
inline constexpr std::array<double, 3> kWideZones = {90, 1000, 90};  // deg, mm, deg

/// speeddata.
struct Speed {
  double tip = 0;   ///< mm/s
  double turn = 0;  ///< rad/s
};

/// wobjdata with the robot not holding the part.
struct WorkObject {
  std::string unit = {};          ///< mechanical unit that carries it; empty: it stands
  Pose frame = Pose::Identity();  ///< uframe · oframe: in the world, or, with a unit, in the unit's frame
};

/// `value` as a num with at most so many decimals.
std::string NumText(double value, int decimals);

/// A quaternion [q1,q2,q3,q4], q1 real, of the two that mean R the one nearer to `near`.
Eigen::Vector4d QuaternionOf(const Eigen::Matrix3d& R, const Eigen::Vector4d& near);

/// "[1,0,0,0]", components with eight decimals, which read back as a quaternion that is written alike.
std::string QuaternionText(Eigen::Vector4d q);
/// "[[1950,0,1100],[1,0,0,0]]".
std::string PoseAggregate(const Pose& pose);
/// tooldata of a tool frame in the flange and what hangs on it.
std::string ToolText(const Pose& X_FC, const ToolLoad& load);
std::string WorkObjectText(const WorkObject& object);
std::string SpeedText(const Speed& speed);
/// zonedata of corners that are rounded from `distance` mm on, orientation and external axes as the tip.
std::string ZoneText(double distance);

/// A num: decimal, rounded to 24 bits.
double ReadNum(LineScanner& scan);
/// "[1,2,3]".
template <size_t N>
std::array<double, N> ReadNums(LineScanner& scan) {
  std::array<double, N> values{};
  scan.Expect("[");
  for (size_t i = 0; i < N; ++i) {
    if (i > 0) scan.Expect(",");
    values[i] = ReadNum(scan);
  }
  scan.Expect("]");
  return values;
}
/// An orient, whose norm must be 1 (within 1e-5); exactly normalised.
Eigen::Matrix3d ReadOrient(LineScanner& scan);
/// A pose [[x,y,z],[q1,q2,q3,q4]].
Pose ReadPose(LineScanner& scan);
/// tooldata on the robot with the load `load`: its frame. Fails for another load.
Pose ReadTool(LineScanner& scan, const ToolLoad& load);
/// wobjdata on `unit` (empty: standing). Fails for another unit, and where the robot holds it.
WorkObject ReadWorkObject(LineScanner& scan, const std::string& unit);
Speed ReadSpeed(LineScanner& scan);
/// Of a fly-by zone whose parts are as ZoneText() has them: mm.
double ReadZone(LineScanner& scan);

}  // namespace millpose::rapid
