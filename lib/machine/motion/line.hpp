// SPDX-License-Identifier: GPL-3.0-or-later
// Straight motion of the tool (LIN, G1): the tip on a line, the orientation about one fixed axis, both in
// proportion to the way done.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "machine/motion/coordinated_motion.hpp"

namespace millpose {

/// A straight motion of a frame, the shorter way round.
class PoseLine {
 public:
  PoseLine(const Pose& from, const Pose& to);

  Pose At(double share) const;                            ///< 0..1 of the way
  double length() const { return (to_ - from_).norm(); }  ///< mm
  double angle() const { return angle_; }                 ///< rad, 0..π
  const Eigen::Vector3d& from() const { return from_; }
  const Eigen::Vector3d& to() const { return to_; }

 private:
  Eigen::Vector3d from_, to_;
  Eigen::Matrix3d R_;                                // at the start
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();  // unit, in the frame's start
  double angle_ = 0;
};

/// Angle of the rotation between two orientations, rad, 0..π; good for small ones too.
double AngleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// What carries the tool: the arm in its place, and the tool on its flange.
struct Carrier {
  Arm arm;
  Pose X_WB = Pose::Identity(), X_FT = Pose::Identity();
  /// Where external axes move along a straight motion: how the base moves, once from its start to its end.
  /// The motion is straight in the part's frame P, which then stands for W in all that follows; X_WB is not
  /// read.
  std::shared_ptr<const CoordinatedMotion> ride = nullptr;

  // `share`: of the ride, 0..1.
  Pose BasePose(double share = 0) const { return ride ? ride->BaseInPart(share) : X_WB; }  ///< X_WB
  Pose ToolPose(const Joints& q, double share = 0) const;                                  ///< X_WT
  Pose FlangePose(const Pose& X_WT, double share = 0) const;  ///< X_BF for a tool pose
};

/// How finely a straight motion is followed.
struct LineSteps {
  double distance = 5;      ///< mm of the tip between samples, at most
  double angle = 0.02;      ///< rad of the tool between samples, at most
  double joint_jump = 0.2;  ///< rad that a joint may turn between samples; more is a singularity passed
};

/// A straight motion in joint space, sampled.
struct LineMotion {
  std::vector<Joints> joints;  ///< from the start on; the whole motion when `problem` is empty
  std::string problem;         ///< why it ends early: where, which joint, by how much
};

/// Follows the straight motion from joint angles `q` to the tool pose `X_WT_end` on q's branch, within
/// [lower, upper] (rad).
LineMotion FollowLine(const Carrier& carrier, const Joints& q, const Pose& X_WT_end, const Joints& lower,
                      const Joints& upper, const LineSteps& steps = {});

/// Joint angles at `share` (0..1) of the straight motion between the tool poses of q0 and q1, on q0's branch;
/// empty where that branch has none.
std::optional<Joints> OnLine(const Carrier& carrier, const Joints& q0, const Joints& q1, double share);

/// How far, joint by joint (rad), the straight motion between two tool poses leaves the motion in which the
/// joints turn evenly from q0 to q1: the largest of ¼, ½ and ¾ of the way and a quarter of it for what lies
/// between, which covers terms up to the third order in the turn. Empty where the straight motion leaves q0's
/// branch.
std::optional<Joints> JointDeviation(const Carrier& carrier, const Joints& q0, const Joints& q1);

/// How far the tool is from a commanded straight motion half-way when the joints turn evenly instead.
struct Deviation {
  double position = 0;  ///< mm, of the tip
  double axis = 0;      ///< rad, of the tool axis
};
Deviation HalfwayDeviation(const Carrier& carrier, const Joints& q0, const Joints& q1);

}  // namespace millpose
