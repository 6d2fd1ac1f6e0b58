// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/standing.hpp"

#include <algorithm>
#include <bit>
#include <span>

namespace millpose {
namespace {

constexpr double kTouch = 1e-3;  // mm: what the envelope only touches stays

Eigen::AlignedBox3d BoxAbout(const Eigen::Vector3d& place, double reach) {
  return {place.array() - reach, place.array() + reach};
}

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
  if (motions_.empty()) return;
  stretches_.reserve(2 * motions_.size());
  stretches_.emplace_back();
  Build(0, 0, static_cast<int>(motions_.size()));
}

void SweptPath::Add(const MillingPoint& from, const MillingPoint& to, size_t number) {
  motions_.push_back({from.position, to.position, to.tool_axis, number});
}

void SweptPath::Build(int stretch, int first, int count) {
  Stretch made;
  made.first = first;
  made.count = count;
  made.bar = BarOf(first, count);
  for (int i = first; i < first + count; ++i) {
    made.box.extend(motions_[static_cast<size_t>(i)].from);
    made.box.extend(motions_[static_cast<size_t>(i)].to);
  }
  if (count > 1) {
    made.half = static_cast<int>(stretches_.size());
    stretches_.emplace_back();
    stretches_.emplace_back();
  }
  stretches_[static_cast<size_t>(stretch)] = made;
  if (count == 1) return;
  Build(made.half, first, count / 2);
  Build(made.half + 1, first + count / 2, count - count / 2);
}

SweptBar SweptPath::BarOf(int first, int count) const {
  const std::span motions =
      std::span(motions_).subspan(static_cast<size_t>(first), static_cast<size_t>(count));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Motion& motion : motions) sum += motion.axis;
  SweptBar bar;
  bar.from = motions.front().from;
  bar.way = motions.back().to - bar.from;
  bar.axis = sum.norm() > 0 ? Eigen::Vector3d(sum.normalized()) : motions.front().axis;
  const double square = bar.way.squaredNorm();
  for (const Motion& motion : motions) {
    bar.lean = std::max(bar.lean, (motion.axis - bar.axis).norm());
    for (const Eigen::Vector3d& tip : {motion.from, motion.to}) {
      const Eigen::Vector3d beyond = tip - bar.from;
      const double share = square > 0 ? std::clamp(beyond.dot(bar.way) / square, 0.0, 1.0) : 0.0;
      bar.off = std::max(bar.off, (beyond - share * bar.way).norm());
    }
  }
  return bar;
}

bool SweptPath::IsShort(const Stretch& stretch) const {
  constexpr int kMost = 32;           // motions, each of which may be asked
  constexpr double kStraight = 0.02;  // of the radius, that tips lie beside the line at most
  return stretch.half == 0 || (stretch.count <= kMost && stretch.box.diagonal().norm() < 2 * cutter_.radius &&
                               stretch.bar.off < kStraight * cutter_.radius);
}

SweptPath::Near SweptPath::Before(size_t number, const Eigen::Vector3d& place, const Eigen::Vector3d& normal,
                                  double above) const {
  Near near{number, place, normal, Reach(cutter_, above), {}, {}};
  const Eigen::AlignedBox3d about = BoxAbout(place, near.reach);
  std::vector<int> open;
  if (!stretches_.empty()) open.push_back(0);
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    const Stretch& stretch = stretches_[static_cast<size_t>(index)];
    if (motions_[static_cast<size_t>(stretch.first)].number > number || !stretch.box.intersects(about))
      continue;
    if (IsShort(stretch))
      near.stretches.push_back(index);
    else
      open.insert(open.end(), {stretch.half, stretch.half + 1});
  }
  near.blocks.resize((near.stretches.size() + kLanes - 1) / kLanes);
  for (size_t i = 0; i < near.stretches.size(); ++i) {
    const SweptBar& bar = stretches_[static_cast<size_t>(near.stretches[i])].bar;
    const double lowest = (bar.from - place).dot(normal) + std::min(0.0, bar.way.dot(normal)) - bar.off;
    near.blocks[i / kLanes].Set(static_cast<int>(i % kLanes), bar, lowest - drop_);
  }
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

bool SweptPath::TakesAt(int index, const Near& near, const Eigen::Vector3d& place) const {
  const Motion& motion = motions_[static_cast<size_t>(index)];
  if (motion.number > near.number) return false;
  const Eigen::AlignedBox3d tips(motion.from.cwiseMin(motion.to), motion.from.cwiseMax(motion.to));
  if (!tips.intersects(BoxAbout(near.place, near.reach))) return false;
  const double height = (place - near.place).dot(near.normal);
  const double at_start = (motion.from - near.place).dot(near.normal);
  const double at_end = (motion.to - near.place).dot(near.normal);
  return std::min(at_start, at_end) <= height + drop_ && Takes(motion, place);
}

bool SweptPath::Removed(Near& near, const Eigen::Vector3d& place) const {
  if (near.last_taker >= 0 && TakesAt(near.last_taker, near, place)) return true;
  const double height = (place - near.place).dot(near.normal);
  for (size_t block = 0; block < near.blocks.size(); ++block) {
    uint32_t may = TakersIn(near.blocks[block], place, height, cutter_.radius);
    for (; may != 0; may &= may - 1) {
      const size_t at = block * kLanes + static_cast<size_t>(std::countr_zero(may));
      const Stretch& stretch = stretches_[static_cast<size_t>(near.stretches[at])];
      for (int motion = stretch.first; motion < stretch.first + stretch.count; ++motion) {
        if (!TakesAt(motion, near, place)) continue;
        near.last_taker = motion;
        return true;
      }
    }
  }
  return false;
}

}  // namespace millpose
