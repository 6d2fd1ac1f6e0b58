// SPDX-License-Identifier: GPL-3.0-or-later
// Series compliances of a block of poses, one per lane, as compliance_block.hpp has the joints'.
#pragma once

#include "machine/stiffness/compliance_block.hpp"
#include "machine/stiffness/series.hpp"

namespace millpose {

/// Elements in series with the joints, prepared for one point of the flange. All that hangs on one link is
/// one 6×6 compliance in that link's frame, since their twists add; of the flange's only the 3×3 at the point
/// is left, as the point does not move in F. So a pose costs the same for one element as for many on its
/// link.
class SeriesBlock {
 public:
  SeriesBlock() = default;

  /// `p_FT`: where the compliance is wanted, mm, in F.
  SeriesBlock(const Arm& arm, const std::vector<SeriesCompliance>& elements, const Eigen::Vector3d& p_FT);

  bool empty() const { return links_ == 0; }

  /// Whether a flip of the wrist may change what the elements give: some hang on links 4 or 5.
  bool TurnsWithWrist() const { return (links_ & (1u << 4 | 1u << 5)) != 0; }

  /// Adds to `c` (mm/N, base frame) what SeriesComplianceAt() gives at the point, in its top left block.
  /// `flipped`: of the wrist that `branch` stands for beside its own. Finite; without meaning where the
  /// branch is not reached.
  void AddTo(const FlangeBlock& flange, const ArmBranchBlock& branch, bool flipped, ComplianceBlock& c,
             InstructionSet set = WidestInstructionSet()) const;

 private:
  Arm arm_;
  Eigen::Vector3d p_FT_ = Eigen::Vector3d::Zero();
  unsigned links_ = 0;                                   ///< bit i: elements hang on link i
  std::array<Matrix6, 6> on_{};                          ///< per link, at the origin of its frame
  Eigen::Matrix3d on_flange_ = Eigen::Matrix3d::Zero();  ///< at the point, in F
};

}  // namespace millpose
