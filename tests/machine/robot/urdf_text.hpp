// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "machine/robot/joint_chain.hpp"
#include "machine/robot/urdf.hpp"

namespace millpose {

/// A joint as the text of a URDF has it: metres, rad.
struct SpecJoint {
  Eigen::Vector3d xyz, rpy, axis;
};
/// Six joints and the flange behind them.
struct Spec {
  std::array<SpecJoint, 6> joints;
  Eigen::Vector3d flange_xyz = Eigen::Vector3d::Zero(), flange_rpy = Eigen::Vector3d::Zero();
};

/// The URDF of these joints between links l0 and l7.
std::string UrdfOf(const Spec& spec);
/// The arm of such a text; misfits up to `tolerance` (mm).
DerivedArm Derive(const std::string& urdf, double tolerance = 1e-6);

}  // namespace millpose
