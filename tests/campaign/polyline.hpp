// SPDX-License-Identifier: GPL-3.0-or-later
// The way of a tip, sampled, and how far another leaves it.
#pragma once

#include "tests/campaign/trace.hpp"

namespace millpose::campaign {

struct Sample {
  Eigen::Vector3d p;
  Eigen::Quaterniond o;
  size_t step = 0;  ///< that it belongs to
};

struct Polyline {
  std::vector<Sample> samples;
  std::vector<double> lengths, angles;        ///< mm and rad of every step
  std::vector<Eigen::Vector3d> along, about;  ///< its way and its rotation vector
};

/// The tip along steps that begin at `start`.
Polyline Sampled(const std::vector<Step>& steps, const Joints& start, const Machine& machine);

Sample Between(const Sample& a, const Sample& b);

/// By how much direction (1) and turning per mm (rad/mm) change behind step i.
struct Corner {
  double turn = 0, twist = 0;
};
Corner CornerAt(const Polyline& line, size_t i);

/// Goes along a line after samples that come in order.
class Follower {
 public:
  Follower(const Polyline& line, double tolerance, double angle_tolerance)
      : line_(line), tolerance_(tolerance), angle_tolerance_(angle_tolerance) {}
  /// How far the sample is from what is left of the line, in tolerances.
  double Follow(const Sample& sample);
  size_t segment() const { return segment_; }  ///< between this sample of the line and the next

 private:
  const Polyline& line_;
  double tolerance_, angle_tolerance_;
  size_t segment_ = 0;
  double share_ = 0;
};

/// The farthest (rad of a joint) that the places `visited` are in order from the straight joint motions of
/// `way`.
double FarthestOf(const std::vector<Joints>& way, const std::vector<Joints>& visited);

}  // namespace millpose::campaign
