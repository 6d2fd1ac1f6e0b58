// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/urdf.hpp"

namespace millpose {

/// Six joints in a row as a URDF gives them, fixed joints between them merged: the base link's frame S, the
/// frame of every moving link, and the flange link's frame E.
struct JointChain {
  struct Joint {
    std::string name;
    Pose X_PJ = Pose::Identity();  ///< in the link before at angle 0, mm
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    double lower = 0, upper = 0;  ///< rad
    double speed = 0;             ///< rad/s; 0: not given
    bool limited = true;          ///< false: a continuous joint, without limits
  };
  std::array<Joint, 6> joints;
  Pose X_LE = Pose::Identity();  ///< E in the last moving link, mm
};

/// A URDF link and what moves it.
struct AttachedLink {
  UrdfLink link;
  int moves_with = 0;            ///< 0: stands still; 1..6: behind that joint of the chain
  Pose X_ML = Pose::Identity();  ///< the link in S, or in the moving link that it is fixed to, mm
};

struct ChainOfLinks {
  JointChain chain;
  std::vector<AttachedLink> links;  ///< every link of the model, in its order
  /// One sentence for each joint that moves a link beside the chain (counterbalance cylinders, parallel
  /// links, grippers): the link is taken as fixed to its parent, with the joint at 0 or at the limit nearest
  /// to it.
  std::vector<std::string> warnings;
};

/// The chain from `base` to `flange`. Throws InputError at `model.file` when one of these is not a link,
/// or there are not six revolute or continuous joints between them that move by themselves.
ChainOfLinks FindChain(const UrdfModel& model, const std::string& base, const std::string& flange);

/// Frames of the chain in S: index 0 is S, 1..6 the moving links, 7 the flange link E; mm.
std::array<Pose, 8> ChainFrames(const JointChain& chain, const Joints& angles);

/// An arm of closed form that moves as a chain does.
struct DerivedArm {
  Arm arm;                       ///< name, accelerations and stiffness left empty
  Pose X_SB = Pose::Identity();  ///< the arm's base B in S, mm
  Pose X_FE = Pose::Identity();  ///< E in the arm's flange F, mm
  double deviation = 0;          ///< largest seen between chain and arm over random poses, mm at E
};

/// Finds lengths, signs and offsets such that X_SE = X_SB · X_BF(angles) · X_FE, and proves it on random
/// poses. The family is that of parallel axes where axis 4 is parallel to axis 3. Throws InputError (file
/// `file`) with what keeps the chain from a closed form: axes that do not meet (by how many mm), axes not at
/// right angles or not parallel (by how many degrees), or a deviation above `tolerance` (mm), which
/// `key` of the cell gives. Lengths are
/// rounded to 1e-11 mm and offsets to 1e-12 degrees. Derivation: docs/urdf.md.
DerivedArm DeriveArm(const JointChain& chain, double tolerance, const std::string& file,
                     const std::string& key = "arm.urdf.tolerance_mm");

}  // namespace millpose
