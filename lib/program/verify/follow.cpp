// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/follow.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"
#include "machine/motion/line.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kNoLength = 1e-6;  // mm: such a segment only turns

double AngleBetweenAxes(const Vector3d& a, const Vector3d& b) { return Atan2(a.cross(b).norm(), a.dot(b)); }

/// The part of the rotation from a to b that turns about the tool axis: between a's x and b's x once b's axis
/// is tilted back onto a's, the shorter way round. Of axes that point against each other there is no shorter
/// way: then as if none were tilted.
double AngleAboutAxis(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Vector3d across = b.col(2).cross(a.col(2)), x = b.col(0), moved = across.cross(x);
  const double divisor = 1 + b.col(2).dot(a.col(2));
  const bool against = divisor < 1e-12;
  return AngleBetweenAxes(a.col(0), against ? x : Vector3d(x + moved + across.cross(moved) / divisor));
}

PathDeviation Apart(const Pose& place, const Pose& pose, size_t segment) {
  return {(pose.translation() - place.translation()).norm(),
          AngleBetweenAxes(place.linear().col(2), pose.linear().col(2)),
          AngleAboutAxis(place.linear(), pose.linear()), segment};
}

}  // namespace

bool PathDeviation::Within(const VerifyOptions& options) const {
  return position <= options.position_tolerance && axis <= options.angle_tolerance &&
         rotation <= options.angle_tolerance;
}

std::string PathDeviation::Text() const {
  return fmt::format("tip off by {:.3f} mm, tool axis by {:.4f} deg, rotation about it by {:.4f} deg",
                     position, axis * kDegPerRad, rotation * kDegPerRad);
}

PathFollower::PathFollower(const std::vector<Pose>& path, size_t look_ahead, const VerifyOptions& options)
    : options_(options), look_ahead_(look_ahead) {
  for (size_t i = 1; i < path.size(); ++i) lines_.emplace_back(path[i - 1], path[i]);
  if (path.size() == 1) lines_.emplace_back(path[0], path[0]);
}

PathDeviation PathFollower::Measure(const Pose& pose, size_t segment, double from, double& share) const {
  const PoseLine& line = lines_[segment];
  const Vector3d along = line.to() - line.from();
  double place = 1;
  if (line.length() > kNoLength) {
    place = (pose.translation() - line.from()).dot(along) / along.squaredNorm();
  } else if (line.angle() > 0) {
    place = AngleBetween(line.At(0).linear(), pose.linear()) / line.angle();
  }
  share = std::clamp(place, from, 1.0);
  return Apart(line.At(share), pose, segment);
}

PathDeviation PathFollower::Off(const Pose& pose) const {
  return Apart(lines_[segment_].At(share_), pose, segment_);
}

PathDeviation PathFollower::Follow(const Pose& pose) {
  std::optional<PathDeviation> nearest;
  const size_t end = std::min(lines_.size(), segment_ + std::min(look_ahead_, lines_.size()));
  for (size_t segment = segment_; segment < end; ++segment) {
    double share = 0;
    const PathDeviation deviation = Measure(pose, segment, segment == segment_ ? share_ : 0.0, share);
    if (deviation.Within(options_)) {
      segment_ = segment;
      share_ = share;
      return deviation;
    }
    if (!nearest || deviation.position < nearest->position) nearest = deviation;
  }
  return *nearest;
}

}  // namespace millpose
