// SPDX-License-Identifier: GPL-3.0-or-later
// Joint stiffness from measured deflections (Chen 2021 section 3, eq. 9-13).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "machine/robot/kinematics.hpp"

namespace millpose {

/// One load in one pose and what it moved, against the same pose unloaded. Vectors in B.
struct LoadCase {
  Joints q = Joints::Zero();
  Eigen::Vector3d force = Eigen::Vector3d::Zero();           ///< N
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();          ///< N·mm
  Eigen::Vector3d load_point = Eigen::Vector3d::Zero();      ///< where the wrench acts, in F, mm
  Eigen::Vector3d measured_point = Eigen::Vector3d::Zero();  ///< whose displacement was measured, in F, mm
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();    ///< mm
  std::optional<Eigen::Vector3d> rotation;                   ///< rotation vector, rad
};

/// What gives way beside a joint's spring: a link that tilts about, or a base that moves along, an axis of a
/// link's frame (LinkFrames), which turns with it; or a joint that goes the same small way to the side to
/// which it is loaded, however small the load: it takes up its gap.
struct Give {
  enum class Kind { kTilts, kMoves, kTakesUp };

  int link = 0;  ///< 0 base, 1..6
  int axis = 0;  ///< 0 x, 1 y, 2 z; of a joint its own
  Kind kind = Kind::kTilts;

  bool operator==(const Give&) const = default;
};

/// The two axes across its joint's own about which link 1..6 can tilt.
std::vector<Give> TiltingOf(int link);
/// What joint 1..6 takes up.
Give TakingUpOf(int joint);

struct IdentifyOptions {
  double displacement_deviation =
      0.01;  ///< standard deviation of a displacement's component, mm: only its ratio to
             ///< the next matters, the level is estimated from the residuals
  double rotation_deviation = 1e-5;  ///< of a rotation's component, rad
  bool robust = false;               ///< Huber's weights, k = 1.345, by iterated least squares
  std::vector<Give> beside = {};     ///< what gives way beside the joints
  bool payload = false;              ///< a weight that nobody stated acts with each load, where the load does
  Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();  ///< to where it acts, unit, in B
};

/// What the measurements say about one joint.
struct JointEstimate {
  bool determined = false;
  std::string reason;    ///< when not: why no number is given
  double stiffness = 0;  ///< N·mm/rad
  double deviation = 0;  ///< standard deviation of it, first order, N·mm/rad
  double lower = 0;  ///< 95 % interval; `lower` also holds where the data only bound the stiffness from below
  double upper = 0;  ///< +inf where the compliance's interval reaches 0
  double largest_change = 0;    ///< largest relative change when one pose is left out
  size_t most_influential = 0;  ///< the pose that changes it most
};

/// What they say about something beside the joints.
struct GiveEstimate {
  Give give;
  bool determined = false;
  std::string reason;           ///< when not: why no number is given
  double compliance = 0;        ///< rad/(N·mm) or mm/N, of a joint's gap rad; 0 where it is not determined
  double lower = 0, upper = 0;  ///< 95 % interval
};

/// A weight that acts with each load and that nobody stated, such as that of the hook; N.
struct PayloadEstimate {
  bool determined = false;
  std::string reason;                       ///< when not: why no number is given
  double weight = 0, lower = 0, upper = 0;  ///< below 0: the loads are stated too large
};

struct Identification {
  std::array<JointEstimate, 6> joints;
  std::vector<GiveEstimate> beside;        ///< of IdentifyOptions::beside
  std::optional<PayloadEstimate> payload;  ///< of IdentifyOptions::payload
  double condition = 0;  ///< of the weighted L with columns scaled to 1, observable joints only
  double level = 0;  ///< standard deviation of a weighted residual: 1 where the stated deviations are right
  double rms = 0;    ///< of the displacements' residuals, per case, mm
  std::vector<double> residuals;     ///< length of each case's displacement residual, mm; empty when nothing
                                     ///< could be determined
  std::vector<size_t> pose_of_case;  ///< cases with equal joint angles that follow each other are one pose
  size_t poses = 0;
};

/// Weighted least squares for the compliances c_j = 1/k_j ≥ 0 of the six joints, and of what is to give way
/// beside them, in x = L·c (eq. 10-13), exact in which of them are 0. A joint without a number: one that
/// carries no load in any case, one whose effect equals a combination of others', or one whose compliance the
/// data put at 0. With fewer rows than unknowns + 1 none is determined. With a payload L·c is no longer
/// linear in the unknowns: Gauss-Newton, and what is said of it holds to first order.
Identification IdentifyJointStiffness(const Arm& arm, const std::vector<LoadCase>& cases,
                                      const IdentifyOptions& options);

/// The `count` candidates with the largest det(LᵀL) (D-optimal): greedy, then exchanges until none improves.
/// With count 0 the fewest that make as many joints observable as all candidates together. Indices ascending.
std::vector<size_t> ProposeLoadCases(const Arm& arm, const std::vector<LoadCase>& candidates, size_t count,
                                     const IdentifyOptions& options);

}  // namespace millpose
