// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/lean_law.hpp"

#include "base/rotation.hpp"
#include "toolpath/strategies/scallop.hpp"

namespace millpose {

Leans LeansOf(const Eigen::Vector3d& axis, const Eigen::Vector3d& normal, const Eigen::Vector3d& feed) {
  return {Asin(std::clamp(axis.dot(feed), -1.0, 1.0)), Atan2(axis.dot(feed.cross(normal)), axis.dot(normal))};
}

Eigen::Vector3d AxisOf(const Leans& leans, const Eigen::Vector3d& normal, const Eigen::Vector3d& feed) {
  const SineCosine lead = SinCos(leans.lead);
  return RotationAbout(feed, leans.tilt) * (lead.cos * normal + lead.sin * feed);
}

LeanBound::LeanBound(const LeanRules& rules, const Eigen::Vector3d& contact, const Eigen::Vector3d& normal,
                     const Eigen::Vector3d& feed)
    : rules_(&rules), normal_(normal), feed_(feed) {
  constexpr double kRounding = 1 - 1e-9;
  if (rules.cutter.IsBall())
    least_radius_ = kRounding * rules.min_speed_share *
                    ContactRadius(rules.cutter, normal, AxisOf({rules.lead, rules.tilt}, normal, feed));
  if (rules.scallop == 0) return;
  if (rules.surface) bend_ = rules.surface->Bend(contact, normal, feed);
  const Scallops scallops(rules.cutter, rules.lead, rules.tilt, rules.back_and_forth);
  const auto [left, right] = scallops.Reaches(rules.scallop, bend_);
  const double reach = left + right;
  // Passes are no farther apart than the nominal lean reaches only where they were laid so.
  const double apart = rules.by_scallop ? std::min(rules.stepover, reach) : rules.stepover;
  left_ = reach > 0 ? apart * (left / reach) : apart / 2;
  right_ = apart - left_;
}

bool LeanBound::Admits(const Eigen::Vector3d& axis) const {
  constexpr double kSameAxis = 1e-9;
  if (least_radius_ > 0 && ContactRadius(rules_->cutter, normal_, axis) < least_radius_) return false;
  if (rules_->scallop == 0) return true;
  if ((axis - AxisOf({rules_->lead, rules_->tilt}, normal_, feed_)).norm() < kSameAxis) return true;
  const Leans leans = LeansOf(axis, normal_, feed_);
  const Scallops scallops(rules_->cutter, leans.lead, leans.tilt, rules_->back_and_forth);
  return scallops.Covers(rules_->scallop, bend_, left_, right_);
}

}  // namespace millpose
