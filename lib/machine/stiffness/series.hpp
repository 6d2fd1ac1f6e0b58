// SPDX-License-Identifier: GPL-3.0-or-later
// Compliances beside the joints' (platform, base, links, flange, spindle, tool) and what weight does.
#pragma once

#include <string>
#include <vector>

#include "machine/robot/kinematics.hpp"
#include "machine/robot/mechanism.hpp"

namespace millpose {

/// An elastic element in series with the joints, as a compliance at a frame K that hangs on a link. The twist
/// of what lies outwards of K against what lies inwards is C·wrench, both in K: [d; δ] = C·[f; m].
struct SeriesCompliance {
  std::string name;
  int link = 0;  ///< index of LinkFrames(): 0 platform or base, 1..5 links, 6 flange, spindle, tool
  Pose X_LK = Pose::Identity();  ///< frame of C in the link's frame, mm
  Matrix6 C = Matrix6::Zero();   ///< blocks mm/N, 1/N, 1/N, rad/(N·mm); symmetric, positive semidefinite
};

/// What external axes that stand still at `external` add, as elements on the base: whatever an axis carries,
/// a force between tool and part twists it by its compliance about or along its line. `X_WB`: where the base
/// stands then. Axes without a compliance add nothing.
std::vector<SeriesCompliance> ExternalCompliances(const Mechanism& mechanism,
                                                  const ExternalPosition& external, const Pose& X_WB);

/// The compliance that the elements add at the point `p_FT`, in B, same blocks: Σ Ad·C·Adᵀ with Ad the
/// adjoint from K to the point (Ad = [R, −[r]×·R; 0, R], r from K's origin to the point), so that twists and
/// wrenches are transported alike.
Matrix6 SeriesComplianceAt(const Arm& arm, const Joints& q, const Eigen::Vector3d& p_FT,
                           const std::vector<SeriesCompliance>& elements);
/// The same where the LinkFrames() of the pose are known.
Matrix6 SeriesComplianceAt(const LinkPoses& frames, const Eigen::Vector3d& p_FT,
                           const std::vector<SeriesCompliance>& elements);

/// The compliance of one element at `point`, both in the frame of the link that it hangs on: Ad·C·Adᵀ as
/// above.
Matrix6 ComplianceAt(const SeriesCompliance& element, const Eigen::Vector3d& point);

/// A mass that hangs on a link.
struct LinkMass {
  std::string name;
  int link = 0;                                      ///< as in SeriesCompliance
  double mass = 0;                                   ///< kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of gravity, in the link's frame, mm
};

/// A device that carries part of the arm's weight: its torque about axis 2 on the inner angle q2, N·mm, is
/// −torque·sin(q2 − zero): it lifts an arm that leans forward of `zero`.
struct Counterbalance {
  double torque = 0;  ///< N·mm
  double zero = 0;    ///< rad, inner angle; where it gives nothing
};

/// Torques of weight about the joints, N·mm, in the arm's own signs: positive where weight turns a joint in
/// its positive sense. `gravity` is the acceleration in B, mm/s² (so that kg·mm/s² = 1e-3 N).
Joints GravityTorques(const Arm& arm, const Joints& q, const std::vector<LinkMass>& masses,
                      const Counterbalance& counterbalance, const Eigen::Vector3d& gravity);
/// The same where the LinkFrames() of the pose are known.
Joints GravityTorques(const Arm& arm, const Joints& q, const LinkPoses& frames,
                      const std::vector<LinkMass>& masses, const Counterbalance& counterbalance,
                      const Eigen::Vector3d& gravity);

/// How far weight moves the point `p_FT` (mm, in B) in pose `q`, beyond what a controller hides that was
/// calibrated in pose `reference`: J(q)·(τ(q) − τ(reference))/k.
Eigen::Vector3d GravityDeflection(const Arm& arm, const Joints& q, const Joints& reference,
                                  const Eigen::Vector3d& p_FT, const std::vector<LinkMass>& masses,
                                  const Counterbalance& counterbalance, const Eigen::Vector3d& gravity);

}  // namespace millpose
