// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/lost_motion_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/student.hpp"
#include "machine/stiffness/compliance.hpp"

namespace millpose {
namespace {

constexpr double kLeastLever = 50;     // mm/rad: 0.3 arcmin is 4 µm there
constexpr size_t kFewestFreedoms = 3;  // of Student's t, as far as its expansion holds

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double SquaresAbout(double mean, const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return squares;
}

/// One pose's difference, its lever and how uncertain it is beside others.
struct Difference {
  double value, lever, variance;  ///< mm, mm/rad, of a reading's variance
};

Difference DifferenceOf(const Arm& arm, const TwoWayReading& reading) {
  const Matrix6 J = Jacobian(arm, reading.q, reading.point);
  Difference difference{
      Mean(reading.second) - Mean(reading.first), reading.direction.dot(J.col(reading.joint).head<3>()),
      1.0 / static_cast<double>(reading.first.size()) + 1.0 / static_cast<double>(reading.second.size())};
  if (reading.push != 0) {
    const Eigen::Matrix3d c = Compliance(J, arm.stiffness).topLeftCorner<3, 3>();
    difference.value -= 2 * reading.push * reading.direction.dot(c * reading.direction);
    difference.lever = std::abs(difference.lever);  // along the direction, whichever way the joint turns
  }
  return difference;
}

LostMotionEstimate Fit(const Arm& arm, const std::vector<const TwoWayReading*>& readings) {
  LostMotionEstimate found;
  double across = 0, along = 0, squares = 0, farthest = 0;
  std::vector<Difference> differences;
  for (const TwoWayReading* reading : readings) {
    const Difference& d = differences.emplace_back(DifferenceOf(arm, *reading));
    across += d.lever * d.value / d.variance;
    along += d.lever * d.lever / d.variance;
    squares += SquaresAbout(Mean(reading->first), reading->first) +
               SquaresAbout(Mean(reading->second), reading->second);
    found.readings += reading->first.size() + reading->second.size();
    farthest = std::max(farthest, std::abs(d.lever));
    found.half_difference = std::max(found.half_difference, 0.5 * std::abs(d.value));
  }
  found.poses = readings.size();
  if (found.readings < found.poses + 1 + kFewestFreedoms) {
    found.reason = "too few readings; allowed: at least five in one pose";
    return found;
  }
  if (farthest < kLeastLever) {
    found.reason = "its turning does not move the dial";
    return found;
  }
  const double width = across / along;
  for (const Difference& d : differences) {
    const double off = d.value - width * d.lever;
    squares += off * off / d.variance;
  }
  const double freedoms = static_cast<double>(found.readings - found.poses - 1);
  const double half = StudentQuantile(freedoms) * std::sqrt(squares / freedoms / along);
  if (width + half < 0) {
    found.reason =
        "the differences have the wrong sign: readings of the two ways may be exchanged, or pushed "
        "ones less than the arm itself gives";
    return found;
  }
  found.determined = true;
  found.width = std::max(0.0, width);
  found.lower = std::max(0.0, width - half);
  found.upper = width + half;
  return found;
}

}  // namespace

std::array<LostMotionEstimate, 6> FitLostMotion(const Arm& arm, const std::vector<TwoWayReading>& readings) {
  std::array<LostMotionEstimate, 6> found;
  for (int joint = 0; joint < 6; ++joint) {
    std::vector<const TwoWayReading*> of_joint;
    for (const TwoWayReading& reading : readings)
      if (reading.joint == joint) of_joint.push_back(&reading);
    LostMotionEstimate& estimate = found[static_cast<size_t>(joint)];
    if (of_joint.empty())
      estimate.reason = "not measured";
    else
      estimate = Fit(arm, of_joint);
  }
  return found;
}

}  // namespace millpose
