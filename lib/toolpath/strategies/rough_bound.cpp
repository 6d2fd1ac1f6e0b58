// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_bound.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBandStep = 0.03;  // mm by which the radius may change within a band
constexpr double kOnFloor = 1e-4;   // mm: a floor exactly an allowance below the tip is not in its way
constexpr double kNoLimit = 1e12;   // mm
constexpr double kFewestBands = 4, kMostBands = 200;

double SquaredToLine(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp(along.dot(p - a) / length, 0.0, 1.0) : 0;
  return (a + share * along - p).squaredNorm();
}

double CrossOf(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// From a convex polygon; 0 inside.
double DistanceFrom(const std::vector<Vector2d>& corners, const Vector2d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  bool left = true, right = true;
  double area = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    nearest = std::min(nearest, SquaredToLine(p, a, b));
    const double side = CrossOf(b - a, p - a);
    left = left && side >= 0, right = right && side <= 0;
    area += CrossOf(a - corners[0], b - corners[0]);
  }
  return (left || right) && std::abs(area) > 1e-9 ? 0 : std::sqrt(nearest);
}

/// What of a polygon lies on one side of a height: `sign` 1: above.
std::vector<Vector3d> CutAt(const std::vector<Vector3d>& polygon, double height, double sign) {
  std::vector<Vector3d> kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a.z() - height), db = sign * (b.z() - height);
    if (da >= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + da / (da - db) * (b - a));
  }
  return kept;
}

}  // namespace

RoughBound::RoughBound(const std::vector<Triangle>& part, const CutterShape& cutter, double allowance,
                       double height) {
  const double corner = cutter.corner_radius + allowance, core = cutter.radius - cutter.corner_radius;
  const double full = height + cutter.corner_radius;  // from here up it is as wide as anywhere
  const auto bands =
      static_cast<int>(std::clamp(std::ceil(kPi / 2 * corner / kBandStep), kFewestBands, kMostBands));
  for (const Triangle& triangle : part) {
    const double top = std::max({triangle[0].z(), triangle[1].z(), triangle[2].z()});
    const double bottom = std::min({triangle[0].z(), triangle[1].z(), triangle[2].z()});
    if (top <= height - allowance + kOnFloor) continue;
    if (top >= full) Add(triangle, std::max(full, bottom), kNoLimit, core + corner);
    double low = height - allowance + kOnFloor;
    for (int band = 1; band <= bands && low < std::min(top, full); ++band) {
      const SineCosine turn = SinCos(kPi / 2 * band / bands);
      const double high = full - corner * turn.cos;
      if (high > bottom) Add(triangle, low, high, core + corner * turn.sin);
      low = std::max(low, high);
    }
  }
  DropCovered();
  for (const Shadow& shadow : shadows_) largest_ = std::max(largest_, shadow.radius);
  tree_ = TreeOf(shadows_);
}

Bvh RoughBound::TreeOf(const std::vector<Shadow>& shadows) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Shadow& shadow : shadows) {
    Eigen::AlignedBox3d& box = boxes.emplace_back();
    for (const Vector2d& corner : shadow.corners) box.extend(Vector3d(corner.x(), corner.y(), 0));
  }
  return Bvh(boxes);
}

// Both are convex: where a shadow's corners are nearer to a wider one than what that is wider by, all of it
// is, and no place has less room for it. So of a steep wall one band in fifty stays.
void RoughBound::DropCovered() {
  constexpr double kSurely = 1e-6;  // mm, so that no last bit of any room changes
  std::vector<Shadow> widest;
  double radius = 0;
  for (const Shadow& shadow : shadows_) radius = std::max(radius, shadow.radius);
  std::ranges::copy_if(shadows_, std::back_inserter(widest),
                       [&](const Shadow& s) { return s.radius == radius; });
  const Bvh tree = TreeOf(widest);
  std::erase_if(shadows_, [&](const Shadow& shadow) {
    const double wider = radius - shadow.radius - kSurely;
    if (wider < 0) return false;
    const Vector3d first(shadow.corners[0].x(), shadow.corners[0].y(), 0);
    bool covered = false;
    tree.ForEachWhere(
        [&](const Eigen::AlignedBox3d& box) {
          return !covered && box.squaredExteriorDistance(first) <= wider * wider;
        },
        [&](int i) {
          covered = covered || std::ranges::all_of(shadow.corners, [&](const Vector2d& corner) {
                      return DistanceFrom(widest[static_cast<size_t>(i)].corners, corner) <= wider;
                    });
        });
    return covered;
  });
}

void RoughBound::Add(const Triangle& triangle, double low, double high, double radius) {
  std::vector<Vector3d> polygon(triangle.begin(), triangle.end());
  polygon = CutAt(polygon, low, 1);
  if (high < kNoLimit) polygon = CutAt(polygon, high, -1);
  if (polygon.empty()) return;
  Shadow& shadow = shadows_.emplace_back();
  shadow.radius = radius;
  for (const Vector3d& corner : polygon) shadow.corners.push_back(corner.head<2>());
}

double RoughBound::Room(const Vector2d& place, double most) const {
  double room = most;
  const Vector3d p(place.x(), place.y(), 0);
  tree_.ForEachWhere(
      [&](const Eigen::AlignedBox3d& box) {
        const double reach = room + largest_;
        return reach > 0 && box.squaredExteriorDistance(p) < reach * reach;
      },
      [&](int i) {
        const Shadow& shadow = shadows_[static_cast<size_t>(i)];
        room = std::min(room, DistanceFrom(shadow.corners, place) - shadow.radius);
      });
  return room;
}

}  // namespace millpose
