// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/denavit_hartenberg.hpp"

#include "base/rotation.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// A rotation about an axis of the frame, then a way along it.
Pose Screw(const Vector3d& axis, double angle, double way) {
  Pose X = Pose::Identity();
  X.linear() = RotationAbout(axis, angle);
  X.translation() = way * axis;
  return X;
}

}  // namespace

JointChain ChainOf(const std::array<DhRow, 6>& rows, DhConvention convention) {
  JointChain chain;
  Pose rest = Pose::Identity();  // from the frame before up to the joint
  for (size_t i = 0; i < 6; ++i) {
    const DhRow& row = rows[i];
    const Pose link = Screw(Vector3d::UnitX(), row.alpha, row.a);
    const Pose joint = Screw(Vector3d::UnitZ(), row.theta, row.d);  // both turn about and run along z
    if (convention == DhConvention::kModified) rest = rest * link;
    chain.joints[i].name = fmt::format("row {}", i + 1);
    chain.joints[i].X_PJ = rest;
    chain.joints[i].axis = row.sign * Vector3d::UnitZ();
    chain.joints[i].limited = false;
    rest = convention == DhConvention::kStandard ? joint * link : joint;
  }
  chain.X_LE = rest;
  return chain;
}

}  // namespace millpose
