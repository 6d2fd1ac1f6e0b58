// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/swept_cutter.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/cutters.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kExactly = 1e-8;  // mm
constexpr double kBand = 15;       // mm

SurfaceRay RayAt(double x, double y, const Vector3d& normal = Vector3d::UnitZ()) {
  return {{x, y, 0}, normal, 2, 0, 0};
}

CutterMotion Upright(const Vector3d& from, const Vector3d& to) {
  return {{from, Vector3d::UnitZ()}, {to, Vector3d::UnitZ()}, 0};
}

double HeightOf(const CutterShape& cutter, const std::vector<CutterMotion>& motions, const SurfaceRay& ray) {
  return SweptCutter(cutter, motions, kBand).HeightOn(ray).height;
}

TEST(SweptCutter, LeavesAFlatAtTheTipsHeight) {
  const CutterShape flat{10, 0, 40};
  for (const double error : {0.0, 0.031, -0.2}) {
    const std::vector<CutterMotion> pass{Upright({0, 0, error}, {30, 0, error})};
    for (const double y : {-9.9, 0.0, 6.5}) EXPECT_NEAR(HeightOf(flat, pass, RayAt(12, y)), error, kExactly);
    EXPECT_FALSE(SweptCutter(flat, pass, kBand).HeightOn(RayAt(12, 10.1)).IsCut());
    EXPECT_FALSE(SweptCutter(flat, pass, kBand).HeightOn(RayAt(40.1, 0)).IsCut());
  }
}

// Where the tip goes down along its way, the lowest place over a ray is where the disc leaves it.
TEST(SweptCutter, KeepsTheDeepestPlaceOfAFallingTip) {
  const CutterShape flat{10, 0, 40};
  const double slope = -0.004, length = 50;
  const std::vector<CutterMotion> pass{Upright({0, 0, 0.1}, {length, 0, 0.1 + slope * length})};
  for (const double x : {5.0, 21.0, 47.0, 55.0})
    for (const double y : {0.0, -4.0, 8.0}) {
      const double last = std::min(length, x + std::sqrt(100 - y * y));
      EXPECT_NEAR(HeightOf(flat, pass, RayAt(x, y)), 0.1 + slope * last, kExactly) << x << ' ' << y;
    }
}

// Across a straight pass a ball leaves its circle, so that two passes s apart leave a scallop of
// R − √(R² − s²/4); a bull-nose leaves its corner's circle beyond its flat.
TEST(SweptCutter, LeavesScallopsInClosedForm) {
  const CutterShape ball{10, 10, 40}, bull{10, 3, 40};
  const double apart = 6;
  const std::vector<CutterMotion> passes{Upright({-20, 0, 0}, {20, 0, 0}),
                                         Upright({-20, apart, 0}, {20, apart, 0})};
  for (const double y : {0.0, 0.7, 2.0, 3.0, 4.4, 6.0}) {
    const double off = std::min(y, apart - y);
    EXPECT_NEAR(HeightOf(ball, passes, RayAt(1.5, y)), 10 - std::sqrt(100 - off * off), kExactly) << y;
  }
  EXPECT_NEAR(HeightOf(ball, passes, RayAt(0, apart / 2)), 10 - std::sqrt(100 - 9.0), kExactly);
  for (const double y : {0.0, -6.9, -7.5, -8.9, -9.99}) {
    const double beyond = std::max(0.0, -y - 7);
    EXPECT_NEAR(HeightOf(bull, passes, RayAt(1.5, y)), 3 - std::sqrt(9 - beyond * beyond), 1e-7) << y;
  }
}

// Errors that alternate from pass to pass: the face keeps the lower one wherever both reach.
TEST(SweptCutter, KeepsTheLowerOfNeighbouringPasses) {
  const CutterShape flat{10, 0, 40};
  std::vector<CutterMotion> passes;
  for (int i = 0; i < 6; ++i) {
    const double error = i % 2 == 0 ? 0.02 : -0.03;
    passes.push_back(Upright({-20, 8.0 * i, error}, {20, 8.0 * i, error}));
  }
  for (double y = -9.75; y < 49; y += 0.5) {
    double lowest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 6; ++i)
      if (std::abs(y - 8.0 * i) < 10) lowest = std::min(lowest, i % 2 == 0 ? 0.02 : -0.03);
    EXPECT_NEAR(HeightOf(flat, passes, RayAt(0, y)), lowest, kExactly) << y;
  }
}

TEST(SweptCutter, PassesOverToolsOfTheOtherSide) {
  const CutterShape flat{10, 0, 40};
  const std::vector<CutterMotion> pass{
      {{{0, 0, -0.5}, -Vector3d::UnitZ()}, {{9, 0, -0.5}, -Vector3d::UnitZ()}}};
  EXPECT_FALSE(SweptCutter(flat, pass, kBand).HeightOn(RayAt(3, 0)).IsCut());
}

// What stands in for the sweep here: the tool at many places along its way, each a solid of which a place is
// inside or not.
class PlainMap {
 public:
  PlainMap(CutterShape cutter, CutterMotion motion) : cutter_(cutter), motion_(motion) {}

  bool Inside(double share, const Vector3d& place) const {
    const Vector3d tip = (1 - share) * motion_.from.tip + share * motion_.to.tip;
    const double turn = std::acos(std::min(1.0, motion_.from.axis.dot(motion_.to.axis)));
    const Vector3d axis =
        turn < 1e-9
            ? motion_.from.axis
            : (std::sin((1 - share) * turn) * motion_.from.axis + std::sin(share * turn) * motion_.to.axis) /
                  std::sin(turn);
    const double up = (place - tip).dot(axis);
    if (up < 0) return false;
    const double r = cutter_.corner_radius, radius = ((place - tip) - up * axis).norm();
    const double at_height =
        up < r ? cutter_.radius - r + std::sqrt(r * r - (r - up) * (r - up)) : cutter_.radius;
    return radius <= at_height;
  }

  /// First height from below that is inside; none within the band.
  double EntryAt(double share, const SurfaceRay& ray) const {
    const double step = 0.01;
    double below = -4, inside = std::numeric_limits<double>::infinity();
    for (double h = -4; h < 4; h += step)
      if (Inside(share, ray.origin + h * ray.normal)) {
        inside = h;
        below = h - step;
        break;
      }
    if (!std::isfinite(inside)) return inside;
    while (inside - below > 1e-11) {
      const double middle = (below + inside) / 2;
      (Inside(share, ray.origin + middle * ray.normal) ? inside : below) = middle;
    }
    return inside;
  }

  double Lowest(const SurfaceRay& ray) const {
    double best = std::numeric_limits<double>::infinity(), at = 0, width = 1.0 / 40;
    for (int i = 0; i <= 40; ++i)
      if (const double h = EntryAt(i * width, ray); h < best) best = h, at = i * width;
    for (int zoom = 0; zoom < 7; ++zoom) {
      const double middle = at;
      width /= 6;
      for (int i = -6; i <= 6; ++i)
        if (const double share = std::clamp(middle + i * width, 0.0, 1.0), h = EntryAt(share, ray); h < best)
          best = h, at = share;
    }
    return best;
  }

 private:
  CutterShape cutter_;
  CutterMotion motion_;
};

/// The map turns the axis evenly, the sweep along the chord of a stretch: these differ by no more than
/// √3/216 of the turn's cube, rad.
double EvenTurnError(const Vector3d& from, const Vector3d& to) {
  return std::pow((to - from).norm(), 3) * std::sqrt(3.0) / 216;
}

// Leaning tools that turn along their way, over surfaces that lean too, against the plain map, which may only
// miss what is lower. Both have the whole tool in view: rays that it just grazes are left out.
TEST(SweptCutter, AgreesWithAPlainMap) {
  std::mt19937_64 random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  int compared = 0, both_missed = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const CutterShape& cutter = kCutters[static_cast<size_t>(trial % 3)];
    // One draw a statement: the order of arguments is the compiler's.
    const double u = uniform(-0.2, 0.2), v = uniform(-0.2, 0.2);
    const Vector3d from = Leaning(u, v);
    const double du = uniform(-0.01, 0.01), dv = uniform(-0.01, 0.01);
    const Vector3d to = (from + Vector3d(du, dv, 0)).normalized();
    const double x = uniform(2, 8), y = uniform(-2, 2), first = uniform(-0.3, 0.3), last = uniform(-0.3, 0.3);
    const CutterMotion motion{{{0, 0, first}, from}, {{x, y, last}, to}};
    const double at_x = uniform(-11, 18), at_y = uniform(-11, 11);
    const double lean_x = uniform(-0.1, 0.1), lean_y = uniform(-0.1, 0.1);
    const SurfaceRay ray = RayAt(at_x, at_y, Leaning(lean_x, lean_y));
    const double plain = PlainMap(cutter, motion).Lowest(ray);
    const double height = HeightOf(cutter, {motion}, ray);
    if (plain > 3 || height > 3) {
      both_missed += plain > 2.9 && height > 2.9 ? 1 : 0;
      EXPECT_GT(std::min(plain, height), 2.9) << trial;
      continue;
    }
    ++compared;
    EXPECT_LE(height, plain + 1e-8 + EvenTurnError(from, to) * cutter.radius) << trial;
    EXPECT_GE(height, plain - 5e-5) << trial;
  }
  EXPECT_GT(compared, 60);
  EXPECT_GT(both_missed, 5);
}

// A facetted dome under a tool that follows it: the axis turns by more than a stretch takes at a time.
TEST(SweptCutter, FollowsATurningAxis) {
  const CutterShape flat{10, 0, 40};
  const double radius = 300, turn = 0.12;
  const auto place = [&](double angle) {
    const Vector3d out(std::sin(angle), 0, std::cos(angle));
    return CutterPlace{radius * out - Vector3d(0, 0, radius), out};
  };
  const CutterMotion motion{place(0), place(turn)};
  for (const double angle : {0.03, 0.0601, 0.1})
    for (const double y : {0.0, 5.0}) {
      const Vector3d out(std::sin(angle), 0, std::cos(angle));
      const SurfaceRay ray{radius * out - Vector3d(0, 0, radius) + Vector3d(0, y, 0), out, 2, 0, 0};
      EXPECT_NEAR(HeightOf(flat, {motion}, ray), PlainMap(flat, motion).Lowest(ray), 2e-6) << angle;
    }
}

TEST(SweptCutter, IsTheSameForAnyThreadsAndOrder) {
  const CutterShape bull{10, 3, 40};
  const std::vector<SurfaceRay> rays = RaysOver(Region(Mesh(GridShape(30, 20, 2)), {}), 0.5);
  std::vector<CutterMotion> motions;
  for (int i = 0; i < 12; ++i)
    motions.push_back(Upright({0, 3.5 * i, 0.001 * (i % 5)}, {60, 3.5 * i, 0.001 * (i % 3)}));
  const std::vector<RayHeight> one = SweptCutter(bull, motions, kBand).HeightsOn(rays, 1);
  const std::vector<RayHeight> three = SweptCutter(bull, motions, kBand).HeightsOn(rays, 3);
  std::ranges::reverse(motions);
  const std::vector<RayHeight> turned = SweptCutter(bull, motions, kBand).HeightsOn(rays, 2);
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(one[i].height, three[i].height);
    ASSERT_EQ(one[i].motion, three[i].motion);
    ASSERT_NEAR(one[i].height, turned[i].height, kExactly);
  }
}

}  // namespace
}  // namespace millpose
