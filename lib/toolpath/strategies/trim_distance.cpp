// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim_distance.hpp"

#include "geometry/mesh/triangle.hpp"

namespace millpose {

Eigen::Vector3d AcrossToSegment(const Eigen::Vector3d& place, const Eigen::Vector3d& axis,
                                const Eigen::Vector3d& a, const Eigen::Vector3d& b, double& share) {
  const auto across = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector3d off = p - place;
    return off - off.dot(axis) * axis;
  };
  const Eigen::Vector3d from = across(a), to = across(b);
  share = (to - from).squaredNorm() > 0 ? ClosestOnSegment(Eigen::Vector3d::Zero(), from, to) : 0.0;
  return from + share * (to - from);
}

ContourDistance::ContourDistance(const Contour& contour, double reach) : contour_(contour), reach_(reach) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (size_t i = 0; i < contour.Segments(); ++i) {
    boxes.emplace_back(contour.From(i).place);
    boxes.back().extend(contour.To(i).place);
  }
  tree_ = Bvh(boxes);
}

NearestOnContour ContourDistance::Nearest(const Eigen::Vector3d& place, const Eigen::Vector3d& axis) const {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(reach_);
  double squared = std::numeric_limits<double>::infinity();
  NearestOnContour nearest;
  tree_.ForEachIn({place - reach, place + reach}, [&](int i) {
    double share = 0;
    const Eigen::Vector3d to = AcrossToSegment(place, axis, contour_.From(static_cast<size_t>(i)).place,
                                               contour_.To(static_cast<size_t>(i)).place, share);
    if (to.squaredNorm() < squared) squared = to.squaredNorm(), nearest.off = -to;
  });
  nearest.distance = std::sqrt(squared);
  return nearest;
}

}  // namespace millpose
