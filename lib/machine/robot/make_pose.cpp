// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/make_pose.hpp"

#include "base/angles.hpp"

namespace millpose {

Pose MakePose(const PoseSettings& settings) {
  Pose pose = Pose::Identity();
  pose.linear() = FromAnglesZyx(settings.abc);
  pose.translation() = settings.position;
  return pose;
}

}  // namespace millpose
