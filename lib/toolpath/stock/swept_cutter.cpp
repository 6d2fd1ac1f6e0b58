// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/swept_cutter.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "base/rotation.hpp"

namespace millpose {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kExact = 1e-9;        // mm: a place this near to the cutter is on it
constexpr double kMostTurn = 0.02;     // rad of the axis along a stretch
constexpr double kLeastFacing = 0.05;  // cosine between axis and normal: a tool of the ray's own side
constexpr size_t kChunk = 1024;        // rays that a thread takes at a time

/// What a cutter occupies near its tip, up to `height` along its axis.
AlignedBox3d BoxOf(const CutterShape& cutter, const CutterPlace& place, double height) {
  const Vector3d across = cutter.radius * (Vector3d::Ones() - place.axis.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
  AlignedBox3d box(place.tip - across, place.tip + across);
  const Vector3d top = place.tip + height * place.axis;
  return box.extend(AlignedBox3d(top - across, top + across));
}

/// Turns evenly from one place's axis to the other's.
Vector3d AxisAt(const CutterPlace& from, const CutterPlace& to, double share) {
  const Vector3d about = from.axis.cross(to.axis);
  if (about.norm() < 1e-12 || share == 0) return from.axis;
  if (share == 1) return to.axis;
  return RotationAbout(about.normalized(), share * Atan2(about.norm(), from.axis.dot(to.axis))) * from.axis;
}

}  // namespace

SweptCutter::SweptCutter(const CutterShape& cutter, std::vector<CutterMotion> motions, double band)
    : cutter_(cutter), motions_(std::move(motions)), band_(band) {
  for (size_t i = 0; i < motions_.size(); ++i) Add(motions_[i], static_cast<int>(i));
  std::vector<AlignedBox3d> boxes;
  for (const Stretch& stretch : stretches_) {
    const CutterPlace from{stretch.tip, stretch.axis};
    const CutterPlace to{stretch.tip + stretch.way, (stretch.axis + stretch.turn).normalized()};
    boxes.push_back(BoxOf(cutter_, from, 2 * band_).merged(BoxOf(cutter_, to, 2 * band_)));
  }
  tree_ = Bvh(boxes);
}

void SweptCutter::Add(const CutterMotion& motion, int number) {
  const double turn = (motion.to.axis - motion.from.axis).norm();
  const int parts = 1 + static_cast<int>(turn / kMostTurn);
  for (int part = 0; part < parts; ++part) {
    const double begin = static_cast<double>(part) / parts, end = static_cast<double>(part + 1) / parts;
    const Vector3d axis = AxisAt(motion.from, motion.to, begin);
    const Vector3d way = motion.to.tip - motion.from.tip;
    stretches_.push_back({motion.from.tip + begin * way, (end - begin) * way, axis,
                          AxisAt(motion.from, motion.to, end) - axis, number});
  }
}

// The core is a half-infinite cylinder of radius R − r that begins r above the tip; the cutter is all that is
// within r of it. Its closest point moves with the tool, which gives the slope.
SweptCutter::Nearest SweptCutter::At(const Stretch& stretch, double share, const Vector3d& place) const {
  const Vector3d sum = stretch.axis + share * stretch.turn;
  const double length = sum.norm();
  const Vector3d axis = sum / length;
  const Vector3d off = place - stretch.tip - share * stretch.way;
  const double up = off.dot(axis);
  const Vector3d radial = off - up * axis;
  const double radius = radial.norm(), inner = cutter_.radius - cutter_.corner_radius;
  const Vector3d closest =
      std::max(up, cutter_.corner_radius) * axis + (radius > inner ? inner / radius : 1.0) * radial;
  Nearest nearest;
  nearest.share = share;
  nearest.towards = off - closest;
  nearest.distance = nearest.towards.norm();
  const Vector3d turning = (stretch.turn - axis.dot(stretch.turn) * axis) / length;
  const Vector3d velocity = stretch.way + axis.dot(closest) * turning - turning.dot(closest) * axis;
  nearest.slope = -nearest.towards.dot(velocity);
  return nearest;
}

// Half the squared distance f from a body that moves on is convex in the share as long as it hardly turns;
// its slope is bracketed and its zero found by the Illinois variant of false position, with bisection now and
// then since it bends sharply where an edge of the cutter passes. f is no less than f(s) − |f'(s)|·(what is
// left of the bracket), which tells how far off an answer is: where the place is below the tool a thousandth
// of the distance will do, and `distance` is the least that it can be; beside it the direction must be right
// too, because Newton's step takes it.
SweptCutter::Nearest SweptCutter::NearestAlong(const Stretch& stretch, const Vector3d& place) const {
  constexpr double kBelow = 0.97;  // cosine
  Nearest low = At(stretch, 0, place), high = At(stretch, 1, place);
  if (low.slope >= 0 || high.slope <= 0) {
    if (low.slope < 0) return high;
    if (high.slope > 0) return low;
    return high.distance < low.distance ? high : low;
  }
  double low_slope = low.slope, high_slope = high.slope;
  const double corner = cutter_.corner_radius;
  const double speed = stretch.way.norm() + cutter_.radius * stretch.turn.norm();
  Nearest best = low.distance < high.distance ? low : high;
  for (int i = 0; i < 120 && best.distance > corner + kExact; ++i) {
    const double part = i % 3 == 2 ? 0.5 : low_slope / (low_slope - high_slope);
    const double share = low.share + (high.share - low.share) * part;
    if (share <= low.share || share >= high.share) break;
    Nearest middle = At(stretch, share, place);
    if (middle.distance < best.distance) best = middle;
    if (std::abs(middle.slope) <= speed * std::max(1e-9 * middle.distance, 1e-15)) break;
    const double missing =
        std::abs(middle.slope) * (middle.slope < 0 ? high.share - share : share - low.share);
    const double distance = middle.distance;
    if (-middle.towards.dot(stretch.axis) > kBelow * distance &&
        missing <= 1e-3 * distance * (distance - corner)) {
      middle.distance = std::sqrt(distance * distance - 2 * missing);
      return middle;
    }
    if (middle.slope < 0) {
      low = middle;
      low_slope = middle.slope;
      high_slope /= 2;
    } else {
      high = middle;
      high_slope = middle.slope;
      low_slope /= 2;
    }
  }
  return best;
}

// The cutter lies above the plane through its tip across its axis: along a stretch that plane meets the ray
// nowhere lower than at the ends, but for the axis's turn.
double SweptCutter::LowestPossible(const Stretch& stretch, const SurfaceRay& ray) const {
  const auto meets = [&](const Vector3d& tip, const Vector3d& axis) {
    const double facing = ray.normal.dot(axis);
    return facing < kLeastFacing ? -2 * band_ : (tip - ray.origin).dot(axis) / facing;
  };
  const double from = meets(stretch.tip, stretch.axis);
  const double to = meets(stretch.tip + stretch.way, stretch.axis + stretch.turn);
  const double turn = stretch.turn.norm();
  return std::min(from, to) - turn * (stretch.way.norm() + std::abs(from - to));
}

// From below nothing is passed over when the step is the distance itself. Towards a part of the cutter that
// leans against the ray that would take many steps: there they are Newton's, which do not overshoot either
// where the swept volume is convex.
double SweptCutter::Entry(const Stretch& stretch, const SurfaceRay& ray, double limit) const {
  constexpr double kFacing = 0.9;
  if (ray.normal.dot(stretch.axis) < kLeastFacing) return limit;
  double height = std::max(LowestPossible(stretch, ray), -2 * band_);
  for (int step = 0; step < 200 && height < limit; ++step) {
    const Nearest nearest = NearestAlong(stretch, ray.origin + height * ray.normal);
    const double left = nearest.distance - cutter_.corner_radius;
    if (left <= kExact) return height;
    const double approach = -nearest.towards.dot(ray.normal) / nearest.towards.norm();
    if (approach <= 1e-9) return limit;
    height += approach > kFacing ? left : left / approach;
  }
  return limit;
}

RayHeight SweptCutter::HeightOn(const SurfaceRay& ray) const {
  AlignedBox3d box(ray.origin, ray.origin);
  box.extend(ray.origin + band_ * ray.normal).extend(ray.origin - band_ * ray.normal);
  // Those that may come lowest first: most of the others then need not be looked at.
  std::vector<std::pair<double, int>> near;
  tree_.ForEachIn(box, [&](int index) {
    near.emplace_back(LowestPossible(stretches_[static_cast<size_t>(index)], ray), index);
  });
  std::ranges::sort(near);
  RayHeight found;
  double lowest = band_;
  for (const auto& [bound, index] : near) {
    if (bound >= lowest) break;
    const Stretch& stretch = stretches_[static_cast<size_t>(index)];
    const double height = Entry(stretch, ray, lowest);
    if (height < lowest) lowest = height, found = {height, stretch.motion};
  }
  return found;
}

std::vector<RayHeight> SweptCutter::HeightsOn(const std::vector<SurfaceRay>& rays, int threads,
                                              std::stop_token stop) const {
  std::vector<RayHeight> heights(rays.size());
  ParallelFor((rays.size() + kChunk - 1) / kChunk, threads, std::move(stop), [&](size_t chunk) {
    const size_t end = std::min(rays.size(), (chunk + 1) * kChunk);
    for (size_t i = chunk * kChunk; i < end; ++i) heights[i] = HeightOn(rays[i]);
  });
  return heights;
}

}  // namespace millpose
