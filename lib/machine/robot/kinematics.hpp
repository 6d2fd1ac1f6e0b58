// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "machine/robot/arm.hpp"

namespace millpose {

/// X_BF for the joint angles `q` (the formula at Arm).
Pose ForwardFlange(const Arm& arm, const Joints& q);

/// The flange is no further from the shoulder column's top, mm.
double ArmLength(const Arm& arm);

/// Frames in B that the bodies of a cell hang on: 0 base, 1..6 after joint i (1 at the shoulder column's top,
/// 2 at axis 2, 3 at axis 3, 4 at axis 4, 5 at the wrist centre, 6 = flange F). A joint's axis is z, y, y, x,
/// y, z of the frame after it, whatever the family.
using LinkPoses = std::array<Pose, 7>;
LinkPoses LinkFrames(const Arm& arm, const Joints& q);

/// 6×6 geometric Jacobian in B at the tool tip `p_FT` (mm, in F): rows 0..2 mm/rad, rows 3..5 rad/rad; column
/// i is [z_i × (p_tip − p_i); z_i] with z_i including the axis sign (Chen 2021 eq. 1, 2).
Matrix6 Jacobian(const Arm& arm, const Joints& q, const Eigen::Vector3d& p_FT);
/// The same where the LinkFrames() of the pose are known.
Matrix6 Jacobian(const Arm& arm, const LinkPoses& frames, const Eigen::Vector3d& p_FT);

enum class ReachStatus : uint8_t {
  kReached,      ///< the pose has solutions
  kUnreachable,  ///< no solution: the wrist centre is too near or too far
  kSingular,  ///< solutions exist but a whole family does: shoulder, elbow or wrist, see SingularityDistance
};

/// One closed-form solution, angles principal: each in (−π, π].
struct ArmSolution {
  Joints q;
  int branch = 0;  ///< status bits S as KUKA counts them, see Status()
};

struct InverseResult {
  ReachStatus status = ReachStatus::kUnreachable;
  int count = 0;                         ///< how many of `solutions` hold, 0..8
  std::array<ArmSolution, 8> solutions;  ///< in ascending branch order
};

/// All closed-form solutions of ForwardFlange(arm, q) = X_BF, limits not looked at. Never NaN.
InverseResult Inverse(const Arm& arm, const Pose& X_BF);

/// The solution on one branch that lies nearest to `near` (full revolutions added where that brings a joint
/// nearer); empty when that branch has none.
std::optional<Joints> InverseNear(const Arm& arm, const Pose& X_BF, int branch, const Joints& near);

/// All vectors equal to `q` up to full revolutions of single joints that lie within [lower, upper].
std::vector<Joints> FullRevolutions(const Joints& q, const Joints& lower, const Joints& upper);
/// How many these are.
double CountRevolutions(const Joints& q, const Joints& lower, const Joints& upper);

/// The branch's number, status S: bit 0 = wrist centre behind axis 1 (overhead), bit 1 = A3 ≥ atan2(dz, d4)
/// (elbow), bit 2 = A5 < 0, each on the arm's inner angles. For a KUKA arm that is the controller's S; arms
/// with parallel axes have the same three choices, and no controller's number for them.
int Status(const Arm& arm, const Joints& q);

/// Turn T: bit i−1 = A_i < 0 in the arm's own convention.
int Turn(const Joints& q);

/// Distances to the three singularities of an arm.
struct SingularityDistance {
  double wrist;     ///< |sin q5|, 0..1: axis 6 in line with axis 4 (parallel axes: parallel to it)
  double elbow;     ///< |sin of the angle between upper arm and forearm|, 0..1
  double shoulder;  ///< distance of the wrist centre from the plane through axis 1 along axis 2, mm; where
                    ///< dy = 0 that is the one from axis 1
};
SingularityDistance DistanceToSingularity(const Arm& arm, const Joints& q);

}  // namespace millpose
