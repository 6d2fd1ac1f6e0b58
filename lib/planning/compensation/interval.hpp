// SPDX-License-Identifier: GPL-3.0-or-later
// Between which values a deflection lies when force and stiffness are known within bounds alone
// (docs/compensation.md).
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "machine/stiffness/force_cone.hpp"
#include "machine/stiffness/series.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// How sure stiffness is: each lies within this share of the stated one, 0 to below 1.
struct StiffnessBounds {
  Joints joints = Joints::Constant(0.1);
  double beside = 0.1;  ///< of all compliances beside the joints, alike
};

/// The linear compliance at a point of the arm as the sum of what each joint and the elements beside them
/// give.
class ComplianceParts {
 public:
  static constexpr size_t kParts = 7;  ///< six joints, and what is beside them

  /// At the point `p_FT` (mm, in F) in pose `q`; all in B.
  ComplianceParts(const Arm& arm, const Joints& q, const Eigen::Vector3d& p_FT,
                  const std::vector<SeriesCompliance>& elements);

  const Eigen::Matrix3d& sum() const { return sum_; }  ///< mm/N

  /// What each part moves the point by along `direction` (unit, in B) per newton along x, y and z, mm/N.
  std::array<Eigen::Vector3d, kParts> Towards(const Eigen::Vector3d& direction) const;

  /// What `force` (N, in B) moves the point by along `direction` (unit, in B), and between which values that
  /// lies for any force and any stiffness within the bounds. Exact: over stiffness the extremes lie at the
  /// corners of the bounds, over the force each of them has a closed form. Nothing is taken out yet.
  Compensation::Along Along(const Eigen::Vector3d& direction, const Eigen::Vector3d& force,
                            const ForceBounds& forces, const StiffnessBounds& stiffness) const;

 private:
  std::array<Eigen::Matrix3d, kParts> parts_;
  Eigen::Matrix3d sum_;
  bool beside_ = false;
};

}  // namespace millpose
