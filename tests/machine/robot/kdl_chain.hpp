// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <kdl/chain.hpp>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {

/// The formula at Arm as a chain of Orocos KDL.
inline KDL::Chain KdlChain(const Arm& arm, const Eigen::Vector3d& p_FT) {
  using KDL::Joint;
  using KDL::Rotation;
  const std::array<Joint::JointType, 6> axis{Joint::RotZ, Joint::RotY, Joint::RotY,
                                             Joint::RotX, Joint::RotY, Joint::RotX};
  const Rotation turn =
      arm.family == ArmFamily::kParallelAxes ? Rotation::RotZ(kPi / 2) : Rotation::Identity();
  const std::array<KDL::Frame, 6> link{KDL::Frame(KDL::Vector(arm.a1, arm.dy, 0)),
                                       KDL::Frame(KDL::Vector(arm.a2, 0, 0)),
                                       KDL::Frame(turn, KDL::Vector(arm.d4, 0, arm.dz)),
                                       KDL::Frame(KDL::Vector(0, -arm.d5, 0)),
                                       KDL::Frame::Identity(),
                                       KDL::Frame(KDL::Vector(arm.d6, 0, 0))};
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(Joint(Joint::None), KDL::Frame(KDL::Vector(0, 0, arm.d1))));
  for (int i = 0; i < 6; ++i) {
    const double offset = arm.offset[i];
    const Rotation zero = i == 0                   ? Rotation::RotZ(offset)
                          : axis[i] == Joint::RotY ? Rotation::RotY(offset)
                                                   : Rotation::RotX(offset);
    chain.addSegment(KDL::Segment(Joint(axis[i], arm.sign[i]), KDL::Frame(zero) * link[i]));
  }
  chain.addSegment(KDL::Segment(Joint(Joint::None), KDL::Frame(Rotation::RotY(kPi / 2)) *
                                                        KDL::Frame(KDL::Vector(p_FT[0], p_FT[1], p_FT[2]))));
  return chain;
}

}  // namespace millpose
