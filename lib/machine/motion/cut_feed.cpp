// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/cut_feed.hpp"

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kRounding = 1e-9;  // relative: feeds nearer than this are the same

/// All axes: the joints, then the external ones.
constexpr int kAxes = 9;
using Axes = Eigen::Matrix<double, kAxes, 1>;

Axes AxesOf(const CutSample& sample) { return (Axes() << sample.q, sample.external).finished(); }
Axes AxesOf(const Joints& joints, const Eigen::Vector3d& external) {
  return (Axes() << joints, external).finished();
}

/// First and second derivative of the axes by arc length, rad/mm and rad/mm².
struct Course {
  std::vector<Axes> first, second;
};

Course DeriveCourse(std::span<const CutSample> cut) {
  const size_t count = cut.size();
  Course course{std::vector<Axes>(count, Axes::Zero()), std::vector<Axes>(count, Axes::Zero())};
  for (size_t i = 0; i < count && count > 1; ++i) {
    // The ends use the parabola of their neighbour; of two points there is only a line.
    const size_t m = count == 2 ? 1 : std::clamp<size_t>(i, 1, count - 2);
    const double before = cut[m].arc_length - cut[m - 1].arc_length;
    const Axes left = (AxesOf(cut[m]) - AxesOf(cut[m - 1])) / before;
    if (count == 2) {
      course.first[i] = left;
      continue;
    }
    const double after = cut[m + 1].arc_length - cut[m].arc_length;
    const Axes right = (AxesOf(cut[m + 1]) - AxesOf(cut[m])) / after;
    course.second[i] = 2 * (right - left) / (before + after);
    const Axes middle = (after * left + before * right) / (before + after);
    course.first[i] = middle + course.second[i] * (cut[i].arc_length - cut[m].arc_length);
  }
  return course;
}

/// Tangential accelerations u allowed at squared feed x: −a ≤ q''·x + q'·u ≤ a for every axis.
std::pair<double, double> TangentialRange(const Axes& first, const Axes& second, double x, const Axes& a) {
  double low = -kInfinity, high = kInfinity;
  for (int j = 0; j < kAxes; ++j) {
    const double free_low = -a[j] - second[j] * x, free_high = a[j] - second[j] * x;
    if (first[j] == 0) {
      if (free_low > 0 || free_high < 0) return {kInfinity, -kInfinity};
      continue;
    }
    const double p = free_low / first[j], q = free_high / first[j];
    low = std::max(low, std::min(p, q));
    high = std::min(high, std::max(p, q));
  }
  return {low, high};
}

/// Squared feed at which a joint reaches its speed, or its acceleration at constant feed.
double SquareBySpeed(double first, double speed) {
  return first == 0 ? kInfinity : (speed / first) * (speed / first);
}
double SquareByAcceleration(double second, double acceleration) {
  return second == 0 ? kInfinity : acceleration / std::abs(second);
}

/// The largest squared feed of one sample, alone: what it can hold without slowing down.
double SquareCap(const CutSample& sample, const Axes& first, const Axes& second, const Axes& speed,
                 const Axes& acceleration) {
  double cap = sample.feed * sample.feed;
  for (int j = 0; j < kAxes; ++j) {
    cap =
        std::min({cap, SquareBySpeed(first[j], speed[j]), SquareByAcceleration(second[j], acceleration[j])});
  }
  return cap;
}

/// The largest x ≤ cap from which some allowed u leads into [0, next] over the distance ds. The set of such x
/// is an interval from 0 on, because all bounds are linear in x and u.
double LargestControllable(const Axes& first, const Axes& second, const Axes& a, double cap, double ds,
                           double next) {
  const auto controllable = [&](double x) {
    const auto [low, high] = TangentialRange(first, second, x, a);
    return std::max(low, -x / (2 * ds)) <= std::min(high, (next - x) / (2 * ds));
  };
  if (controllable(cap)) return cap;
  double good = 0, bad = cap;
  for (int i = 0; i < 60; ++i) (controllable(0.5 * (good + bad)) ? good : bad) = 0.5 * (good + bad);
  return good;
}

}  // namespace

JointRates RatesAlong(std::span<const CutSample> cut) {
  const Course course = DeriveCourse(cut);
  JointRates rates;
  for (size_t i = 0; i < cut.size(); ++i) {
    const size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, cut.size() - 1);
    const double ds = cut[after].arc_length - cut[before].arc_length;
    const double squares = cut[after].feed * cut[after].feed - cut[before].feed * cut[before].feed;
    const double tangential = ds > 0 ? 0.5 * squares / ds : 0;  // d(v²)/2ds
    rates.speed.push_back(course.first[i].head<6>() * cut[i].feed);
    rates.acceleration.push_back(course.second[i].head<6>() * cut[i].feed * cut[i].feed +
                                 course.first[i].head<6>() * tangential);
  }
  return rates;
}

Joints TimeRms(std::span<const CutSample> cut, std::span<const Joints> values) {
  assert(cut.size() == values.size());
  Joints sum = Joints::Zero();
  double time = 0;
  for (size_t i = 0; i < cut.size(); ++i) {
    const size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, cut.size() - 1);
    const double share = 0.5 * (cut[after].arc_length - cut[before].arc_length) / cut[i].feed;
    sum += share * values[i].cwiseAbs2();
    time += share;
  }
  return time > 0 ? Joints((sum / time).cwiseSqrt()) : Joints(Joints::Zero());
}

std::vector<FeedShortfall> FindShortfalls(std::span<const CutSample> cut, const Joints& joint_speed,
                                          const Joints& joint_acceleration, const ExternalBounds& external) {
  const Axes speed = AxesOf(joint_speed, external.speed);
  const Axes acceleration = AxesOf(joint_acceleration, external.acceleration);
  const Course course = DeriveCourse(cut);
  std::vector<FeedShortfall> shortfalls;
  for (size_t i = 0; i < cut.size(); ++i) {
    FeedShortfall worst{static_cast<int>(i), 0, false, cut[i].feed};
    for (int j = 0; j < kAxes; ++j) {
      const double by_speed = std::sqrt(SquareBySpeed(course.first[i][j], speed[j]));
      const double by_acceleration = std::sqrt(SquareByAcceleration(course.second[i][j], acceleration[j]));
      const double possible = std::min(by_speed, by_acceleration);
      if (possible < worst.feed_possible) worst = {worst.sample, j, by_acceleration < by_speed, possible};
    }
    if (worst.feed_possible < cut[i].feed * (1 - kRounding)) shortfalls.push_back(worst);
  }
  return shortfalls;
}

std::vector<double> ReducedFeeds(std::span<const CutSample> cut, const Joints& joint_speed,
                                 const Joints& joint_acceleration, const ExternalBounds& external) {
  const Axes speed = AxesOf(joint_speed, external.speed);
  const Axes acceleration = AxesOf(joint_acceleration, external.acceleration);
  const Course course = DeriveCourse(cut);
  const size_t count = cut.size();
  // Backwards: the largest squared feed from which the rest can still be run.
  std::vector<double> square(count);
  for (size_t i = count; i-- > 0;) {
    const double cap = SquareCap(cut[i], course.first[i], course.second[i], speed, acceleration);
    const bool last = i + 1 == count;
    const double ds = last ? 1 : cut[i + 1].arc_length - cut[i].arc_length;
    const double next = last ? kInfinity : square[i + 1];
    square[i] = LargestControllable(course.first[i], course.second[i], acceleration, cap, ds, next);
  }
  // Forwards: as fast as that and the tangential acceleration allow.
  for (size_t i = 0; i + 1 < count; ++i) {
    const double ds = cut[i + 1].arc_length - cut[i].arc_length;
    const auto [low, high] = TangentialRange(course.first[i], course.second[i], square[i], acceleration);
    square[i + 1] = std::clamp(square[i] + 2 * ds * high, 0.0, square[i + 1]);
  }
  std::vector<double> feeds;
  for (size_t i = 0; i < count; ++i) {
    // What is within rounding of the programmed feed is the programmed feed.
    const double feed = std::sqrt(square[i]);
    feeds.push_back(feed > cut[i].feed * (1 - kRounding) ? cut[i].feed : feed);
  }
  return feeds;
}

}  // namespace millpose
