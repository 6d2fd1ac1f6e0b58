// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/standing_stock.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/geometry/shapes.hpp"
#include "toolpath/stock/taken_off.hpp"

namespace millpose {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

CutterMotion Straight(const Vector3d& from, const Vector3d& to) {
  return {{from, Vector3d::UnitZ()}, {to, Vector3d::UnitZ()}, 0};
}

double VolumeAfter(const Triangles& blank, double spacing, const CutterShape& cutter,
                   const std::vector<CutterMotion>& motions) {
  StandingStock stock(blank, spacing);
  stock.Remove(cutter, motions, 1);
  return stock.Volume();
}

/// The highest material near x, y of a stock whose lines run along z; −inf where there is none.
double TopAt(const StandingStock& stock, double x, double y) {
  double top = -std::numeric_limits<double>::infinity();
  const double half = stock.spacing() / 2;
  stock.Meets([&](const AlignedBox3d& box) {
    if (box.min().x() > x + half || box.max().x() < x - half || box.min().y() > y + half ||
        box.max().y() < y - half)
      return false;
    if (box.min().head<2>() == box.max().head<2>()) top = std::max(top, box.max().z());
    return box.min().head<2>() != box.max().head<2>();
  });
  return top;
}

TEST(StandingStock, ABlankHasItsVolume) {
  const double spacing = 0.25;
  EXPECT_NEAR(StandingStock(BoxShape({0, 0, 0}, {40, 30, 8}), spacing).Volume(), 40 * 30 * 8, 0.02 * 9600);
  const double cylinder = std::numbers::pi * 10 * 10 * 15;
  EXPECT_NEAR(StandingStock(CylinderShape(10, 15, 720), spacing).Volume(), cylinder, 2e-3 * cylinder);
  const double sphere = 4.0 / 3 * std::numbers::pi * 1000;
  EXPECT_NEAR(StandingStock(SphereShape(10, 200), spacing).Volume(), sphere, 2e-3 * sphere);
}

// A blank with a hole right through it: lines in the hole hold nothing.
TEST(StandingStock, HolesHoldNothing) {
  const Triangles ring = LatheShape({{6, 0}, {20, 0}, {20, 5}, {6, 5}, {6, 0}}, 720);
  const double volume = std::numbers::pi * (400 - 36) * 5;
  EXPECT_NEAR(StandingStock(ring, 0.25).Volume(), volume, 2e-3 * volume);
}

TEST(StandingStock, ASlotTakesItsVolume) {
  const Triangles blank = BoxShape({0, 0, 0}, {60, 40, 10});
  const double all = StandingStock(blank, 0.1).Volume();
  const CutterShape flat{5, 0, 30};
  const double slot = VolumeAfter(blank, 0.1, flat, {Straight({-20, 20, 6}, {80, 20, 6})});
  EXPECT_NEAR(all - slot, 10 * 60 * 4, 0.01 * 2400);
  // One that ends within: a half disc beyond the last tip.
  const double closed = VolumeAfter(blank, 0.1, flat, {Straight({-20, 20, 6}, {30, 20, 6})});
  EXPECT_NEAR(all - closed, (10 * 30 + std::numbers::pi * 25 / 2) * 4, 0.01 * 1400);
  // Only the cutting length takes off: 3 mm of it, with 1 mm above left standing.
  const double low = VolumeAfter(blank, 0.1, {5, 0, 3}, {Straight({-20, 20, 6}, {80, 20, 6})});
  EXPECT_NEAR(all - low, 10 * 60 * 3, 0.01 * 1800);
}

// A plunge with the axis leant by 30° makes a leant cylinder; its elliptic section is larger by 1 ÷ cos.
TEST(StandingStock, ALeantBoreTakesALeantCylinder) {
  const Triangles blank = BoxShape({0, 0, 0}, {60, 60, 10});
  const double lean = std::numbers::pi / 6;
  const Vector3d axis(std::sin(lean), 0, std::cos(lean));
  const Vector3d top = Vector3d(30, 30, 5) + 20 * axis, bottom = Vector3d(30, 30, 5) - 20 * axis;
  const double all = StandingStock(blank, 0.1).Volume();
  const double left = VolumeAfter(blank, 0.1, {4, 0, 50}, {{{top, axis}, {bottom, axis}, 0}});
  const double bore = std::numbers::pi * 16 * 10 / std::cos(lean);
  EXPECT_NEAR(all - left, bore, 0.01 * bore);
}

TEST(StandingStock, BallsLeaveTheirScallops) {
  StandingStock stock(BoxShape({0, 0, 0}, {60, 40, 10}), 0.25);
  const CutterShape ball{8, 8, 40};
  const double apart = 5;
  std::vector<CutterMotion> passes;
  for (double y = -10; y < 51; y += apart) passes.push_back(Straight({-20, y, 4}, {80, y, 4}));
  stock.Remove(ball, passes, 1);
  for (const double y : {5.0, 6.2, 7.5, 13.9, 22.5}) {
    // The line nearest to y lies within half a spacing of it.
    const double off = std::abs(std::remainder(y, apart)), s = stock.spacing();
    const auto height = [](double d) { return 4 + 8 - std::sqrt(64 - d * d); };
    const double top = TopAt(stock, 30, y);
    EXPECT_GE(top, height(std::max(0.0, off - s)) - 1e-9) << y;
    EXPECT_LE(top, height(std::min(apart / 2, off + s)) + s / 100 + 1e-9) << y;
  }
}

/// Whether a place is in the cutter's profile at a tip; > 0: by how much not. Convex in the tip's place.
double Outside(const CutterProfile::Frustum& frustum, const Vector3d& tip, const Vector3d& axis,
               const Vector3d& place) {
  const Vector3d beyond = place - tip;
  const double h = beyond.dot(axis), across = (beyond - h * axis).norm();
  return std::max({frustum.low - h, h - frustum.high, across - frustum.radius - frustum.rise * h});
}

// What a line meets, against asking places on it: for each the best tip on the way by ternary search.
TEST(SweptVolume, MeetsALineWherePlacesAreInside) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto vector = [&] { return Vector3d(any(random), any(random), any(random)); };
  const CutterShape cutters[] = {{5, 0, 20}, {5, 5, 20}, {6, 2, 15}};
  int met = 0;
  for (int n = 0; n < 200; ++n) {
    const CutterProfile profile(cutters[n % 3], 0.01);
    const Vector3d axis =
        (n % 5 == 0 ? Vector3d(0, 0, 1) : Vector3d(vector() + Vector3d(0, 0, 1.5))).normalized();
    const Vector3d from = 10 * vector();
    Vector3d to = from + 12 * vector();
    if (n % 7 == 0) to = from;
    if (n % 7 == 1) to = from + 9 * axis;
    const Vector3d direction = n % 2 ? Vector3d::UnitZ() : Vector3d::UnitX();
    const SweptVolume volume(profile, from, to, axis);
    const Vector3d origin = from + 12 * vector();
    const auto outside = [&](double t) {
      const Vector3d place = origin + t * direction;
      double least = std::numeric_limits<double>::infinity();
      for (const auto& frustum : profile.frusta) {
        const auto at = [&](double u) { return Outside(frustum, from + u * (to - from), axis, place); };
        double low = 0, high = 1;
        for (int i = 0; i < 90; ++i) {
          const double a = low + (high - low) / 3, b = high - (high - low) / 3;
          if (at(a) < at(b))
            high = b;
          else
            low = a;
        }
        least = std::min(least, at(low));
      }
      return least;
    };
    const auto span = volume.On(origin, direction);
    for (double t = -60; t <= 60; t += 0.37) {
      const double by = outside(t);
      if (std::abs(by) < 1e-6) continue;
      EXPECT_EQ(span && t > span->low && t < span->high, by < 0) << n << ' ' << t << ' ' << by;
    }
    if (!span) continue;
    ++met;
    const Span between = volume.BetweenPlanes(origin, direction);
    EXPECT_LE(between.low, span->low + 1e-8) << n;
    EXPECT_GE(between.high, span->high - 1e-8) << n;
    const double wide = span->high - span->low;
    EXPECT_LE(outside(span->low), 1e-6) << n;
    EXPECT_LE(outside(span->high), 1e-6) << n;
    EXPECT_GE(outside(span->low - 1e-3 - 1e-3 * wide), -1e-9) << n;
    EXPECT_GE(outside(span->high + 1e-3 + 1e-3 * wide), -1e-9) << n;
    EXPECT_TRUE(volume.box().contains(origin + span->low * direction) || wide < 1e-6) << n;
  }
  EXPECT_GT(met, 50);
}

TEST(CutterProfile, LiesWithinTheCutterByNoMoreThanItsTolerance) {
  for (const CutterShape& cutter : {CutterShape{8, 8, 30}, CutterShape{8, 3, 30}, CutterShape{8, 0, 30}}) {
    const CutterProfile profile(cutter, 0.005);
    double low = 0;
    for (const auto& frustum : profile.frusta) {
      EXPECT_NEAR(frustum.low, low, 1e-12);
      low = frustum.high;
      for (double h = frustum.low; h <= frustum.high; h += (frustum.high - frustum.low) / 16) {
        const double beyond = frustum.radius + frustum.rise * h - (cutter.radius - cutter.corner_radius);
        const double above = cutter.corner_radius - h;
        if (above < 0) continue;
        const double within = cutter.corner_radius - std::hypot(beyond, above);
        EXPECT_GE(within, -1e-12);
        EXPECT_LE(within, 0.005);
      }
    }
    EXPECT_NEAR(low, cutter.length, 1e-12);
  }
}

// The same for any order of motions and number of threads; and what is gone stays gone.
TEST(StandingStock, SameForAnyOrderAndThreads) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  const CutterShape bull{6, 2, 30};
  std::vector<CutterMotion> motions;
  for (int i = 0; i < 14; ++i) {
    const auto place = [&] {
      return CutterPlace{{30 + 40 * any(random), 20 + 30 * any(random), 7 + 4 * any(random)},
                         Vector3d(0.3 * any(random), 0.3 * any(random), 1).normalized()};
    };
    motions.push_back({place(), place(), 0});
  }
  const Triangles blank = BoxShape({0, 0, 0}, {60, 40, 10});
  StandingStock at_once(blank, 0.5), threads(blank, 0.5), one_by_one(blank, 0.5);
  at_once.Remove(bull, motions, 1);
  threads.Remove(bull, motions, 4);
  EXPECT_EQ(at_once.Volume(), threads.Volume());
  double before = one_by_one.Volume();
  for (auto motion = motions.rbegin(); motion != motions.rend(); ++motion) {
    one_by_one.Remove(bull, {&*motion, 1}, 1);
    EXPECT_LE(one_by_one.Volume(), before + 1e-6);
    before = one_by_one.Volume();
  }
  EXPECT_NEAR(before, at_once.Volume(), 1e-4);
  EXPECT_LT(before, 0.97 * StandingStock(blank, 0.5).Volume());
  EXPECT_GT(before, 0.05 * StandingStock(blank, 0.5).Volume());
}

// Places that tools have been at, against the lines of the lattice.
TEST(TakenOff, HoldsWhatIsGone) {
  const CutsOfTool slot{{5, 0, 20}, {Straight({0, 0, 2}, {30, 0, 2}), Straight({30, 0, 2}, {30, 20, 2})}};
  const CutsOfTool bore{{2, 2, 20}, {Straight({50, 0, 10}, {50, 0, -5})}};
  const TakenOff taken({slot, bore}, 0.01);
  EXPECT_TRUE(taken.Holds({15, 4.99, 2.01}));
  EXPECT_FALSE(taken.Holds({15, 5.01, 2.01}));
  EXPECT_FALSE(taken.Holds({15, 4.99, 1.99}));
  EXPECT_TRUE(taken.Holds({34.9, 15, 21.9}));
  EXPECT_FALSE(taken.Holds({34.9, 15, 22.1}));
  EXPECT_TRUE(taken.Holds({50, 0, -4.98}));
  EXPECT_FALSE(taken.Holds({51.9, 0, -4.9}));
  EXPECT_FALSE(taken.Holds({-20, 0, 5}));
}

// After each of many cuts, small ones here and there: where material is asked for is where its spans are.
TEST(StandingStock, IsFoundWhereItsSpansAre) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> any(0, 1);
  const double spacing = 1.5;
  StandingStock stock(BoxShape({0, 0, 0}, {61, 43, 9}), spacing);
  size_t met = 0, asked = 0;
  for (int cut = 0; cut < 60; ++cut) {
    const auto place = [&] { return Vector3d(80 * any(random) - 10, 60 * any(random) - 8, 8 * any(random)); };
    const Vector3d from = place(),
                   way = (12 * (Vector3d(any(random), any(random), any(random)).array() - 0.5)).matrix();
    stock.Remove({4, 1, 5}, std::vector<CutterMotion>{Straight(from, from + way)}, 1);
    std::vector<std::pair<Vector3d, Vector3d>> spans;
    stock.ForEachSpan([&](const Vector3d& low, const Vector3d& high) { spans.emplace_back(low, high); });
    std::vector<Span> ends(stock.rows() * stock.columns(), Span{0, -1});
    for (const auto& [low, high] : spans) {
      const Vector3d at = (low - stock.Place(0, 0, 0)) / spacing;
      Span& all = ends[static_cast<size_t>(std::lround(at.y())) * stock.columns() +
                       static_cast<size_t>(std::lround(at.x()))];
      all = all.high < all.low ? Span{low.z(), high.z()}
                               : Span{std::min(all.low, low.z()), std::max(all.high, high.z())};
    }
    for (size_t line = 0; line < ends.size(); ++line) {
      ASSERT_EQ(stock.Ends()[line].low, ends[line].low) << line;
      ASSERT_EQ(stock.Ends()[line].high, ends[line].high) << line;
    }
    for (int ask = 0; ask < 40; ++ask) {
      const Vector3d lower = place();
      const AlignedBox3d box(lower, lower + Vector3d(4 * any(random), 4 * any(random), any(random)));
      const bool stands = std::ranges::any_of(spans, [&](const auto& span) {
        return box.intersects({span.first, span.second});
      });
      ASSERT_EQ(stock.Meets([&](const AlignedBox3d& around) { return box.intersects(around); }), stands);
      ++asked, met += stands;
    }
  }
  EXPECT_GT(met, asked / 10);
  EXPECT_LT(met, asked - asked / 10);
}

// A large blank has a coarser lattice, not more lines.
TEST(StandingStock, KeepsToItsLines) {
  const StandingStock stock(BoxShape({0, 0, 0}, {2000, 2000, 10}), 0.1, 10'000);
  EXPECT_NEAR(stock.spacing(), 20, 1e-9);
  EXPECT_NEAR(stock.Volume(), 2000.0 * 2000 * 10, 0.03 * 4e7);
}

TEST(StandingStock, TellsItsSpans) {
  StandingStock stock(BoxShape({0, 0, 0}, {30, 20, 10}), 0.5);
  stock.Remove({3, 0, 4}, std::vector<CutterMotion>{Straight({-10, 10, 4}, {40, 10, 4})}, 1);  // a tunnel
  double length = 0;
  size_t spans = 0;
  stock.ForEachSpan([&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    EXPECT_EQ(low.head<2>(), high.head<2>());
    length += high.z() - low.z();
    ++spans;
  });
  EXPECT_NEAR(length * 0.25, stock.Volume(), 1e-6 * stock.Volume());
  EXPECT_GT(spans, 60 * 40 + 60 * 11);
}

}  // namespace
}  // namespace millpose
