// SPDX-License-Identifier: GPL-3.0-or-later
// What a path has swept, against all of its motions asked one by one.
#include "toolpath/engagement/standing.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kLeast = 1e-3;  // mm: what a cutter only touches stays

/// Passes to and fro over a sphere's cap, rings and a plunge beside them, with leaning tools.
Toolpath PathOver(double sphere, double spacing, double lean, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point_at = [&](double x, double y) {
    MillingPoint point;
    point.position = {x, y, std::sqrt(sphere * sphere - x * x - y * y)};
    point.normal = point.position.normalized();
    point.tool_axis = (point.normal + lean * Vector3d(unit(random), unit(random), unit(random))).normalized();
    return point;
  };
  Toolpath path;
  for (int k = 0; k < 5; ++k) {
    Pass& pass = path.passes.emplace_back();
    for (double s = -12; s <= 12; s += spacing)
      pass.points.push_back(point_at(k % 2 == 0 ? s : -s, 3 * k - 24));
  }
  for (const double radius : {3.0, 7.0}) {
    Pass& ring = path.passes.emplace_back();
    ring.closed = true;
    for (double angle = 0; angle < 2 * kPi; angle += spacing / radius)
      ring.points.push_back(point_at(12 + radius * SinCos(angle).cos, 12 + radius * SinCos(angle).sin));
  }
  Pass& plunge = path.passes.emplace_back();
  for (double up = 4; up >= 0; up -= spacing) {
    plunge.points.push_back(point_at(-15, 15));
    plunge.points.back().position += up * plunge.points.back().tool_axis;
  }
  for (Pass& pass : path.passes)
    for (MillingPoint& point : pass.points) point.gouge = unit(random) > 0.97 ? 1 : 0;
  return path;
}

struct Cleared {
  Vector3d from, to, axis;
  size_t number;
};

std::vector<Cleared> ClearedBy(const Toolpath& path) {
  std::vector<Cleared> cleared;
  size_t number = 0;
  for (const Pass& pass : path.passes) {
    for (size_t i = 0; i < pass.points.size(); ++i, ++number) {
      const MillingPoint &here = pass.points[i], &before = pass.points[i > 0 ? i - 1 : 0];
      if (here.gouge > 0) continue;
      cleared.push_back(
          {before.gouge > 0 ? here.position : before.position, here.position, here.tool_axis, number});
    }
    const MillingPoint &first = pass.points.front(), &last = pass.points.back();
    if (pass.closed && first.gouge == 0 && last.gouge == 0)
      cleared.push_back({last.position, first.position, first.tool_axis, number});
  }
  return cleared;
}

/// By the distance from the tip that is nearest across the axis.
bool Clears(const CutterShape& cutter, const Cleared& motion, const Vector3d& place) {
  const auto across = [&](const Vector3d& v) { return Vector3d(v - v.dot(motion.axis) * motion.axis); };
  const Vector3d way = motion.to - motion.from, beyond = place - motion.from, flat = across(way);
  const double square = flat.squaredNorm();
  const double share = square > 0 ? std::clamp(beyond.dot(flat) / square, 0.0, 1.0) : 1;
  const Vector3d away = beyond - share * way;
  const double up = away.dot(motion.axis), round = cutter.corner_radius;
  if (up < kLeast) return false;
  const double below = std::max(0.0, round - up);
  return across(away).norm() < cutter.radius - round + std::sqrt(round * round - below * below) - kLeast;
}

TEST(SweptPath, HasRemovedWhatSomeMotionBeforeClears) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  size_t removed = 0, asked = 0;
  for (const double lean : {0.0, 0.02, 0.2})
    for (const double spacing : {0.05, 0.7, 3.0})
      for (const CutterShape& cutter :
           {CutterShape{5, 0, 20}, CutterShape{5, 1.5, 20}, CutterShape{4, 4, 20}}) {
        const Toolpath path = PathOver(60, spacing, lean, random);
        const SweptPath swept(cutter, path);
        const std::vector<Cleared> cleared = ClearedBy(path);
        std::vector<const MillingPoint*> points;
        for (const Pass& pass : path.passes)
          for (const MillingPoint& point : pass.points) points.push_back(&point);
        for (int k = 0; k < 40; ++k) {
          const auto number =
              static_cast<size_t>((unit(random) + 1) / 2 * static_cast<double>(points.size() - 1));
          const MillingPoint& point = *points[number];
          SweptPath::Near near = swept.Before(number, point.position, point.normal);
          // Half of the places lie about the edge at the point, half just within that beside a point before.
          for (int i = 0; i < 48; ++i) {
            const bool own = i % 2 == 0;
            const size_t by = own ? number : number - std::min(number, static_cast<size_t>(random() % 60));
            const Vector3d& axis = points[by]->tool_axis;
            const Vector3d along = points[by + 1]->position - points[by > 0 ? by - 1 : 0]->position;
            const Vector3d left = axis.cross(along).normalized();
            const double angle =
                own ? kPi * unit(random) : 0.05 * unit(random) + (unit(random) > 0 ? kPi : 0);
            const auto [s, c] = SinCos(angle);
            const double radius = own ? (1 + 0.03 * unit(random)) * cutter.radius
                                      : cutter.radius - kLeast - 0.004 * (unit(random) + 0.8);
            const Vector3d place = points[by]->position + radius * (c * left + s * left.cross(axis)) +
                                   (cutter.corner_radius + 0.6 + 0.6 * unit(random)) * axis;
            if ((place - point.position).norm() > 1.1 * cutter.radius) continue;
            const bool expected = std::ranges::any_of(cleared, [&](const Cleared& motion) {
              return motion.number <= number && Clears(cutter, motion, place);
            });
            ASSERT_EQ(swept.Removed(near, place), expected)
                << "lean " << lean << ", spacing " << spacing << ", point " << number << ", place " << i;
            removed += expected, ++asked;
          }
        }
      }
  EXPECT_GT(asked, 5000);
  EXPECT_GT(asked - removed, asked / 10);
}

}  // namespace
}  // namespace millpose
