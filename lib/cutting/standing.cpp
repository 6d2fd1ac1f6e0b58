// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/standing.hpp"

#include <algorithm>

namespace millpose {
namespace {

constexpr double kTouch = 1e-3;  // mm: what the envelope only touches stays

RegionOptions WithoutRim(RegionOptions options) {
  options.rim_distance = 0;
  return options;
}

}  // namespace

RaisedRegion::RaisedRegion(const Mesh& mesh, RegionOptions region, double top, double cutter_radius)
    : mesh_(mesh),
      region_(mesh, WithoutRim(std::move(region))),
      top_(top),
      beside_(0.02 * cutter_radius),
      within_(1.001 * (std::max(top, kTouch) + beside_)) {}

bool RaisedRegion::Holds(const Eigen::Vector3d& place) const {
  const SurfacePoint foot = mesh_.Closest(place, within_);
  if (foot.face < 0 || !region_.HasFace(foot.face)) return false;
  const Eigen::Vector3d away = place - foot.position;
  const double height = away.dot(mesh_.FaceNormal(foot.face));
  if (height < -kTouch || height > top_) return false;
  if (away.squaredNorm() - height * height > beside_ * beside_) return false;
  return region_.Margin(foot.face, foot.position) > -beside_;
}

SweptPath::SweptPath(const CutterShape& cutter, const Toolpath& toolpath) : cutter_(cutter) {
  constexpr double kBend = 0.1;  // of the radius: what a curved surface falls away over a radius
  size_t number = 0;
  for (const Pass& pass : toolpath.passes) {
    for (const MillingPoint& point : pass.points) {
      const double cosine = point.normal.dot(point.tool_axis);
      const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
      drop_ = std::max(drop_, cutter.radius * (kBend + sine));
    }
    const std::vector<MillingPoint>& points = pass.points;
    for (size_t i = 0; i < points.size(); ++i, ++number) {
      const bool joined = i > 0 && !(points[i - 1].gouge > 0);
      if (!(points[i].gouge > 0)) Add(points[joined ? i - 1 : i], points[i], number);
    }
    if (pass.closed && !(points.front().gouge > 0) && !(points.back().gouge > 0))
      Add(points.back(), points.front(), number);
  }
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Motion& motion : motions_) {
    Eigen::AlignedBox3d& box = boxes.emplace_back(motion.from);
    box.extend(motion.to);
  }
  tree_ = Bvh(boxes);
}

void SweptPath::Add(const MillingPoint& from, const MillingPoint& to, size_t number) {
  motions_.push_back({from.position, to.position, to.tool_axis, number});
}

std::vector<SweptPath::Near> SweptPath::Before(size_t number, const Eigen::Vector3d& place,
                                               const Eigen::Vector3d& normal) const {
  const double reach = 2 * cutter_.radius;
  const Eigen::AlignedBox3d box(place.array() - reach, place.array() + reach);
  std::vector<Near> near;
  tree_.ForEachIn(box, [&](int i) {
    const Motion& motion = motions_[static_cast<size_t>(i)];
    if (motion.number > number) return;
    const double at_start = (motion.from - place).dot(normal), at_end = (motion.to - place).dot(normal);
    near.push_back({i, std::min(at_start, at_end)});
  });
  std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
    return a.height != b.height ? a.height < b.height : a.motion < b.motion;
  });
  return near;
}

bool SweptPath::Takes(const Motion& motion, const Eigen::Vector3d& place) const {
  const Eigen::Vector3d way = motion.to - motion.from, beyond = place - motion.from;
  const Eigen::Vector3d across = way - way.dot(motion.axis) * motion.axis;
  const double square = across.squaredNorm();
  const double share = square > 0 ? std::clamp(beyond.dot(across) / square, 0.0, 1.0) : 1.0;
  const Eigen::Vector3d from_tip = beyond - share * way;
  const double up = from_tip.dot(motion.axis);
  if (up < kTouch) return false;
  const double below = std::max(0.0, cutter_.corner_radius - up), r = cutter_.corner_radius;
  const double radius = cutter_.radius - r + std::sqrt(std::max(0.0, r * r - below * below)) - kTouch;
  return radius > 0 && from_tip.squaredNorm() - up * up < radius * radius;
}

bool SweptPath::Removed(const std::vector<Near>& swept, double height, const Eigen::Vector3d& place) const {
  for (const Near& near : swept) {
    if (near.height > height + drop_) return false;
    if (Takes(motions_[static_cast<size_t>(near.motion)], place)) return true;
  }
  return false;
}

}  // namespace millpose
