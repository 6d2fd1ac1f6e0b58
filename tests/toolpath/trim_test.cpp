// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim.hpp"

#include "base/error.hpp"
#include "tests/base/refusal.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/gouge.hpp"
#include "toolpath/pass_variants.hpp"
#include "toolpath/strategies/trim_distance.hpp"

namespace millpose {
namespace {

constexpr double kTrimRadius = 3;

// A sheet of 100 mm in z = 0 with a square window of 20 mm in its middle.
Mesh Windowed() { return SoundMesh(PlateShape(10, 10, 10, {{{{40, 40}, {60, 60}}}})); }
const Eigen::Vector3d kAtWindow(50, 41, 0), kAtRim(50, 1, 0);

Trim Through(const Eigen::Vector3d& near) {
  Trim trim;
  trim.border = TrimBorder{near, {}};
  trim.through = 4;
  trim.overcut = 0.5;
  return trim;
}

ToolpathOptions Trimming(const Trim& trim) {
  ToolpathOptions options;
  options.strategy = std::make_shared<Trim>(trim);
  options.cutter = {kTrimRadius, 0, 30};
  options.feed_rate = 10;
  options.plunge_feed = 2;
  options.retract_feed = 50;
  options.spacing = 4;
  return options;
}

LaidPath Laid(const Mesh& mesh, const ToolpathOptions& options) {
  return options.strategy->Make({mesh, options, {}}, {});
}

std::string TrimRefusal(const Mesh& mesh, const ToolpathOptions& options) {
  return RefusalOf([&] { Laid(mesh, options); });
}

// Seen from above, the nearest place of a square's sides.
double FromSquare(const Eigen::Vector3d& p, double low, double high) {
  const double x = std::max({low - p.x(), p.x() - high}), y = std::max({low - p.y(), p.y() - high});
  if (x <= 0 && y <= 0) return -std::max(x, y);
  return Eigen::Vector2d(std::max(x, 0.0), std::max(y, 0.0)).norm();
}

double DepthOf(const MillingPoint& point) { return -point.position.z(); }

// Places along the cut, 0.05 mm apart.
std::vector<Eigen::Vector3d> Dense(const Pass& pass) {
  std::vector<Eigen::Vector3d> places;
  for (size_t i = 1; i < pass.points.size(); ++i) {
    if (pass.points[i].kind != PointKind::kCut) continue;  // the way up to it
    const Eigen::Vector3d &a = pass.points[i - 1].position, &b = pass.points[i].position;
    const int steps = std::max(1, static_cast<int>((b - a).norm() / 0.05));
    for (int k = 0; k < steps; ++k) places.push_back(a + (b - a) * k / steps);
  }
  return places;
}

TEST(Trim, RunsAtTheCuttersRadiusBesideAWindowAndARim) {
  for (const bool window : {true, false}) {
    const double low = window ? 40 : 0, high = window ? 60 : 100;
    const LaidPath laid = Laid(Windowed(), Trimming(Through(window ? kAtWindow : kAtRim)));
    ASSERT_EQ(laid.toolpath.passes.size(), 1);
    double least = 1e9, most = 0;
    for (const Eigen::Vector3d& p : Dense(laid.toolpath.passes[0])) {
      const bool inside = p.x() > low && p.x() < high && p.y() > low && p.y() < high;
      EXPECT_EQ(inside, window);
      least = std::min(least, FromSquare(p, low, high));
      most = std::max(most, FromSquare(p, low, high));
    }
    EXPECT_GT(least, kTrimRadius - 0.011) << "chords round outer corners";
    EXPECT_LT(most, kTrimRadius + 1e-4);
    // Everywhere along the edge the cutter comes by.
    const std::vector<Eigen::Vector3d> dense = Dense(laid.toolpath.passes[0]);
    for (double s = low + (window ? kTrimRadius : 0); s <= high - (window ? kTrimRadius : 0); s += 1)
      for (const Eigen::Vector3d& edge : {Eigen::Vector3d(s, low, 0), Eigen::Vector3d(s, high, 0),
                                          Eigen::Vector3d(low, s, 0), Eigen::Vector3d(high, s, 0)}) {
        double nearest = 1e9;
        for (const Eigen::Vector3d& p : dense) nearest = std::min(nearest, (p - edge).head<2>().norm());
        EXPECT_LT(nearest, kTrimRadius + 0.01) << edge.transpose();
      }
  }
}

TEST(Trim, InnerCornersTighterThanTheCutterAreTold) {
  const LaidPath window = Laid(Windowed(), Trimming(Through(kAtWindow)));
  ASSERT_EQ(window.findings.size(), 4);
  EXPECT_NE(window.findings[0].find(fmt::format("leaves {:.3f} mm", kTrimRadius * (std::sqrt(2) - 1))),
            std::string::npos)
      << window.findings[0];
  EXPECT_TRUE(Laid(Windowed(), Trimming(Through(kAtRim))).findings.empty());
  // Round ones of 20 mm are none, of 2.5 mm they are.
  const Mesh ring = SoundMesh(LatheShape({{40, 0}, {20, 0}}, 90));
  EXPECT_TRUE(Laid(ring, Trimming(Through({20, 0, 0}))).findings.empty());
}

TEST(Trim, TheCutterFollowsARoundWindowWithinAHundredth) {
  const Mesh ring = SoundMesh(LatheShape({{40, 0}, {20, 0}}, 180));
  ToolpathOptions options = Trimming(Through({20, 0, 0}));
  for (const Eigen::Vector3d& p : Dense(Laid(ring, options).toolpath.passes[0])) {
    EXPECT_LT(p.head<2>().norm(), 20 - kTrimRadius + 1e-6);
    EXPECT_GT(p.head<2>().norm(), 20 - kTrimRadius - 0.01);
  }
}

TEST(Trim, ClimbHasThePartOnTheRight) {
  for (const bool climb : {true, false})
    for (const Eigen::Vector3d& near : {kAtWindow, kAtRim}) {
      Trim trim = Through(near);
      trim.climb = climb;
      const LaidPath laid = Laid(Windowed(), Trimming(trim));
      size_t right = 0, cut = 0;
      for (const MillingPoint& point : laid.toolpath.passes[0].points) {
        if (point.kind != PointKind::kCut) continue;
        Eigen::Vector3d aside = point.position + 1.2 * kTrimRadius * point.feed.cross(point.tool_axis);
        aside.z() = 0;
        right += Windowed().Closest(aside).distance < 1e-6 ? 1 : 0;
        ++cut;
        EXPECT_LT(std::abs(point.normal.dot(point.tool_axis)), 1e-9);
        EXPECT_LT(std::abs(point.normal.dot(point.feed)), 1e-9);
        Eigen::Vector3d part = point.position - 1.2 * kTrimRadius * point.normal;
        part.z() = 0;
        EXPECT_LT(Windowed().Closest(part).distance, 1.0) << "the normal leads away from the part";
      }
      if (climb) {
        EXPECT_GT(right, cut * 7 / 10);
      } else {
        EXPECT_LT(right, cut * 3 / 10);
      }
    }
}

TEST(Trim, GoesDownInRoundsAndNowhereSteeperThanItsRamp) {
  for (const double per_depth : {1.0, 2.0, 10.0}) {
    Trim trim = Through(kAtWindow);
    trim.per_depth = per_depth;
    trim.ramp = DegToRad(5);
    ToolpathOptions options = Trimming(trim);
    options.spacing = 50;
    const LaidPath laid = Laid(Windowed(), options);
    const std::vector<MillingPoint>& points = laid.toolpath.passes[0].points;
    EXPECT_TRUE(laid.toolpath.passes[0].whole);
    EXPECT_LT(DepthOf(points.front()), 0) << "from over the surface";
    EXPECT_NEAR(DepthOf(points.back()), 4.5, 1e-9);
    std::map<long, double> way;  // by depth, how far the cutter goes level there
    for (size_t i = 1; i < points.size(); ++i) {
      const double down = DepthOf(points[i]) - DepthOf(points[i - 1]);
      const double across = (points[i].position - points[i - 1].position).head<2>().norm();
      if (down > 1e-9) {
        EXPECT_LT(down / across, 1.02 * std::tan(trim.ramp))
            << "chords of the circle are shorter by a little";
        EXPECT_LE(points[i].feed_rate, 2);
      } else if (points[i].kind == PointKind::kCut) {
        way[std::lround(1000 * DepthOf(points[i]))] += across;
      }
    }
    const size_t rounds = static_cast<size_t>(std::ceil(4.5 / per_depth));
    ASSERT_EQ(way.size(), rounds);
    double before = 0;
    for (const auto& [depth, length] : way) {
      EXPECT_LE(static_cast<double>(depth) / 1000 - before, per_depth + 1e-3);
      before = static_cast<double>(depth) / 1000;
      EXPECT_GT(length, 4 * (20 - 2 * kTrimRadius)) << "all round";
    }
  }
}

TEST(Trim, TabsStayUpByWidthAndHeight) {
  Trim trim = Through(kAtRim);
  trim.per_depth = 2;
  trim.ramp = DegToRad(20);
  trim.tabs = TrimTabs{3, {}, 5, 1.2};
  const LaidPath laid = Laid(Windowed(), Trimming(trim));
  EXPECT_TRUE(laid.warnings.empty());
  // What stands along the rim: the least depth over all rounds' deepest at each place.
  const std::vector<Eigen::Vector3d> dense = Dense(laid.toolpath.passes[0]);
  double standing = 0, lost = 0;
  for (double s = 5; s < 95; s += 0.1)
    for (const Eigen::Vector3d& edge : {Eigen::Vector3d(s, 0, 0), Eigen::Vector3d(s, 100, 0),
                                        Eigen::Vector3d(0, s, 0), Eigen::Vector3d(100, s, 0)}) {
      double deepest = 0;
      for (const Eigen::Vector3d& p : dense)
        if ((p - edge).head<2>().norm() < kTrimRadius + 0.02) deepest = std::max(deepest, -p.z());
      if (deepest <= 4 - 1.2 + 1e-6) standing += 0.1;
      if (deepest < 4 - 1.2 - 1e-6) lost += 0.1;
    }
  EXPECT_GT(standing, 3 * (5 + 2 * kTrimRadius - 1));
  EXPECT_LT(standing, 3 * (5 + 2 * kTrimRadius + 1));
  EXPECT_EQ(lost, 0) << "no deeper round is left out beside the tabs";
  trim.tabs->count = 40;
  EXPECT_NE(TrimRefusal(Windowed(), Trimming(trim)).find("has no room"), std::string::npos);
  trim.tabs.reset();
  const LaidPath without = Laid(Windowed(), Trimming(trim));
  ASSERT_EQ(without.warnings.size(), 1);
  EXPECT_NE(without.warnings[0].find("no tabs"), std::string::npos);
}

TEST(Trim, LeadsStayOnTheWastesSideAndMeetTheWayTangentially) {
  for (const Eigen::Vector3d& near : {kAtWindow, kAtRim}) {
    const LaidPath laid = Laid(Windowed(), Trimming(Through(near)));
    const std::vector<MillingPoint>& points = laid.toolpath.passes[0].points;
    const double low = near == kAtWindow ? 40 : 0, high = near == kAtWindow ? 60 : 100;
    for (size_t i = 0; i < points.size(); ++i) {
      EXPECT_GT(FromSquare(points[i].position, low, high), kTrimRadius - 0.011);
      if (i == 0 || i + 1 == points.size() || points[i].kind == points[i - 1].kind) continue;
      const Eigen::Vector3d in = (points[i].position - points[i - 1].position).normalized();
      const Eigen::Vector3d out = (points[i + 1].position - points[i].position).normalized();
      EXPECT_GT(in.dot(out), std::cos(DegToRad(31)));
    }
  }
}

TEST(Trim, ALineIsTrimmedOnTheSideThatIsNamed) {
  const Mesh block = SoundMesh(BoxShape({-50, -50, -4}, {150, 150, 0}));
  for (const LineSide side : {LineSide::kLeft, LineSide::kRight, LineSide::kInside, LineSide::kOutside})
    for (const bool anticlockwise : {true, false}) {
      Trim trim = Through(kAtRim);
      trim.border.reset();
      trim.line = TrimLine{{{40, 40, 0}, {60, 40, 0}, {60, 60, 0}, {40, 60, 0}}, true, side, true};
      if (!anticlockwise) std::ranges::reverse(trim.line->points);
      ToolpathOptions options = Trimming(trim);
      options.tool_axis = {AxisRule::kFixed, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()};
      LaidPath laid = Laid(block, options);
      const bool inside = side == LineSide::kInside ||
                          (side != LineSide::kOutside && (side == LineSide::kLeft) == anticlockwise);
      for (const Eigen::Vector3d& p : Dense(laid.toolpath.passes[0]))
        ASSERT_EQ(p.x() > 40 && p.x() < 60 && p.y() > 40 && p.y() < 60, inside);
      // The kerf in the blank is no gouge; said to be cut already, it is.
      EXPECT_EQ(CheckGouges(block, options.cutter, {}, {.threads = 1}, laid.toolpath).points, 0);
      trim.line->blank = false;
      options.strategy = std::make_shared<Trim>(trim);
      Toolpath modelled = Laid(block, options).toolpath;
      EXPECT_GT(CheckGouges(block, options.cutter, {}, {.threads = 1}, modelled).points, 0);
    }
}

TEST(Trim, AStretchRunsBetweenItsPlacesByTheNearOne) {
  Trim trim = Through({50, 0, 0});
  trim.border->between = {{20, 0, 0}, {80, 0, 0}};
  const LaidPath laid = Laid(Windowed(), Trimming(trim));
  EXPECT_TRUE(laid.warnings.empty()) << "nothing falls";
  double least = 1e9, most = -1e9;
  for (const Eigen::Vector3d& p : Dense(laid.toolpath.passes[0])) {
    EXPECT_NEAR(p.y(), -kTrimRadius, 1e-9);
    least = std::min(least, p.x());
    most = std::max(most, p.x());
  }
  EXPECT_NEAR(least, 20, 0.1);
  EXPECT_NEAR(most, 80, 0.1);
  trim.border->near = {50, 100, 0};
  double length = 0;
  for (const auto& point : Laid(Windowed(), Trimming(trim)).toolpath.passes)
    length = point.points.back().arc_length;
  EXPECT_GT(length, 340);
}

TEST(Trim, WhereTheCutterDoesNotPassThePartsAreTold) {
  // Two squares of 30 mm joined by a slot of 4 mm: too narrow for a cutter of 6 mm.
  const Mesh plate = SoundMesh(
      PlateShape(50, 30, 2, {{{{10, 10}, {40, 40}}}, {{{40, 24}, {60, 28}}}, {{{60, 10}, {90, 40}}}}));
  const LaidPath laid = Laid(plate, Trimming(Through({10, 20, 0})));
  EXPECT_EQ(laid.toolpath.passes.size(), 2);
  EXPECT_TRUE(std::ranges::any_of(
      laid.findings, [](const std::string& text) { return text.find("in 2 parts") != std::string::npos; }));
  for (const Pass& pass : laid.toolpath.passes)
    for (const Eigen::Vector3d& p : Dense(pass)) {
      Eigen::Vector3d on = p;
      on.z() = 0;
      EXPECT_GT(plate.Closest(on).distance, kTrimRadius - 0.01);
    }
  ToolpathOptions large = Trimming(Through({10, 20, 0}));
  large.cutter.radius = 16;
  EXPECT_NE(TrimRefusal(plate, large).find("fits nowhere"), std::string::npos);
}

TEST(Trim, WhatCannotBeIsRefused) {
  Trim trim = Through(kAtWindow);
  trim.border->near.reset();
  EXPECT_NE(TrimRefusal(Windowed(), Trimming(trim)).find("has 2 borders"), std::string::npos);
  trim = Through(kAtWindow);
  trim.through = 31;
  EXPECT_NE(TrimRefusal(Windowed(), Trimming(trim)).find("shank"), std::string::npos);
  trim = Through(kAtWindow);
  trim.lead_radius = 4;
  EXPECT_NE(TrimRefusal(Windowed(), Trimming(trim)).find("core"), std::string::npos);
  trim.entry = TrimEntry::kPlunge;
  trim.lead_radius = 9;
  EXPECT_NE(TrimRefusal(Windowed(), Trimming(trim)).find("no room anywhere"), std::string::npos);
}

TEST(Trim, FinerPassesHoldThePointsOfTheCoarse) {
  Trim trim = Through(kAtWindow);
  trim.per_depth = 2;
  ToolpathOptions options = Trimming(trim);
  const Pass laid = Laid(Windowed(), options).toolpath.passes[0];
  options.parts = 4;
  const Pass finer = Laid(Windowed(), options).toolpath.passes[0];
  ASSERT_EQ(finer.points.size(), 4 * (laid.points.size() - 1) + 1);
  const std::vector<char> everywhere(laid.points.size(), 1);
  EXPECT_EQ(WithPointsBetween(laid, finer, everywhere).points.size(), finer.points.size());
}

// The window of a curved panel with walls: the tool square to the skin.
TEST(Trim, TheWindowOfACurvedPanelIsMetWithinAHundredth) {
  const Mesh panel = SampleMesh("cabin_panel");
  Trim trim = Through({-110, 0, 0});
  trim.through = 8;
  trim.ramp = DegToRad(5);
  ToolpathOptions options = Trimming(trim);
  options.cutter = {10, 0, 40};
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(30);
  options.spacing = 20;
  LaidPath laid = Laid(panel, options);
  ASSERT_EQ(laid.toolpath.passes.size(), 1);
  EXPECT_TRUE(laid.findings.empty());
  const ContourDistance contour(ContourOf(trim, {panel, options, {}}), 60);
  double least = 1e9, most = 0;
  for (const MillingPoint& point : laid.toolpath.passes[0].points) {
    const double distance = contour.At(point.position, point.tool_axis);
    least = std::min(least, distance);
    if (point.kind == PointKind::kCut) most = std::max(most, distance);
  }
  EXPECT_GT(least, 10 - 0.01);
  EXPECT_LT(most, 10 + 0.01);
  EXPECT_EQ(CheckGouges(panel, options.cutter, {}, {.threads = 1}, laid.toolpath).points, 0);
}

}  // namespace
}  // namespace millpose
