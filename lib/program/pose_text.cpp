// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/pose_text.hpp"

#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/scanner.hpp"

namespace millpose {

std::string PoseText(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation(), abc = AnglesZyx(pose.linear()) * kDegPerRad;
  return fmt::format("X {} Y {} Z {}, A {} B {} C {} (Z Y' X'')", Fixed(p.x(), 3), Fixed(p.y(), 3),
                     Fixed(p.z(), 3), Fixed(abc[0], 4), Fixed(abc[1], 4), Fixed(abc[2], 4));
}

std::optional<Pose> ReadPoseText(const std::string& text) {
  LineScanner scan(text, "", 0);
  std::array<double, 6> values{};
  try {
    for (size_t i = 0; i < 6; ++i) {
      if (i == 3) scan.Expect(",");
      scan.Expect(std::string(1, "XYZABC"[i]));
      values[i] = scan.ExpectNumber();
    }
    scan.Expect("(Z Y' X'')");
    scan.ExpectEnd();
  } catch (const InputError&) {
    return std::nullopt;
  }
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(values[0], values[1], values[2]);
  pose.linear() = FromAnglesZyx(Eigen::Vector3d(values[3], values[4], values[5]) * kRadPerDeg);
  return pose;
}

}  // namespace millpose
