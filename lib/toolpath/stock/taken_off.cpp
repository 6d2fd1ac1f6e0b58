// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/taken_off.hpp"

namespace millpose {

TakenOff::TakenOff(const std::vector<CutsOfTool>& cuts, double tolerance) {
  for (const CutsOfTool& own : cuts) {
    profiles_.push_back(std::make_unique<const CutterProfile>(own.cutter, tolerance));
    for (const CutterMotion& motion : own.motions)
      for (const CutterMotion& part : WithoutTurns(motion, own.cutter.length, tolerance))
        volumes_.emplace_back(*profiles_.back(), part.from.tip, part.to.tip, part.from.axis);
  }
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const SweptVolume& volume : volumes_) boxes.push_back(volume.box());
  tree_ = Bvh(boxes);
}

bool TakenOff::Holds(const Eigen::Vector3d& place) const {
  bool holds = false;
  const auto meets = [&](const Eigen::AlignedBox3d& box) { return !holds && box.contains(place); };
  tree_.ForEachWhere(meets, [&](int i) {
    if (holds || !volumes_[static_cast<size_t>(i)].box().contains(place)) return;
    const auto span = volumes_[static_cast<size_t>(i)].On(place, Eigen::Vector3d::UnitZ());
    holds = span && span->low <= 0 && span->high >= 0;
  });
  return holds;
}

}  // namespace millpose
