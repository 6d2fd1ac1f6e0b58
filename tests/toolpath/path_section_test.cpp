// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/path_section.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"

namespace millpose {
namespace {

// A circle of radius 10 about the origin in the plane z = 0, in pieces of 50° from `begin` (rad) on.
Curve Circle(double begin, bool backwards) {
  Curve circle;
  circle.closed = true;
  const auto at = [](double angle) {
    return Eigen::Vector3d(10 * SinCos(angle).cos, 10 * SinCos(angle).sin, 0);
  };
  for (double from = 0; from < 360; from += 50) {
    CurvePiece piece;
    piece.arc = true;
    piece.angle0 = begin + DegToRad(from);
    piece.angle1 = begin + DegToRad(std::min(360.0, from + 50));
    piece.u = {10, 0, 0};
    piece.v = {0, 10, 0};
    piece.start = at(piece.angle0);
    piece.end = at(piece.angle1);
    circle.pieces.push_back(piece);
  }
  return backwards ? Reversed(circle) : circle;
}

double LengthOf(const std::vector<Curve>& curves) {
  double length = 0;
  for (const Curve& curve : curves)
    for (const CurvePiece& piece : curve.pieces) length += 10 * std::abs(piece.angle1 - piece.angle0);
  return length;
}

TEST(ClipToSection, CutsACircleAtTheChordsEnds) {
  for (const double begin : {0.0, 0.3, 1.7, 4.0, -2.5})
    for (const bool backwards : {false, true}) {
      const PathSection share{Eigen::Vector3d(0.6, 0.8, 0), -5, 7, 2};  // cut at -6 and 8
      const std::vector<Curve> parts = ClipToSection(Circle(begin, backwards), share, 0.01);
      ASSERT_EQ(parts.size(), 2U) << begin;
      const double half = std::acos(-0.6) - std::acos(0.8);  // of each side's arc
      EXPECT_NEAR(LengthOf(parts), 20 * half, 1e-9);
      for (const Curve& part : parts) {
        EXPECT_FALSE(part.closed);
        std::array<double, 2> ends{share.direction.dot(part.pieces.front().start),
                                   share.direction.dot(part.pieces.back().end)};
        std::ranges::sort(ends);
        EXPECT_NEAR(ends[0], -6, 1e-9);
        EXPECT_NEAR(ends[1], 8, 1e-9);
        for (size_t i = 1; i < part.pieces.size(); ++i)
          EXPECT_LT((part.pieces[i].start - part.pieces[i - 1].end).norm(), 1e-9);
      }
    }
}

TEST(ClipToSection, LeavesClosedWhatItDoesNotCut) {
  const std::vector<Curve> whole =
      ClipToSection(Circle(1, false), {Eigen::Vector3d::UnitX(), -11, 11, 0}, 0.01);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_TRUE(whole.front().closed);
  EXPECT_NEAR(LengthOf(whole), 20 * kPi, 1e-9);
  EXPECT_TRUE(ClipToSection(Circle(1, false), {Eigen::Vector3d::UnitZ(), 1, 2, 0}, 0.01).empty());
  const std::vector<Curve> one = ClipToSection(Circle(1, false), {Eigen::Vector3d::UnitX(), 0, 99, 0}, 0.01);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_NEAR(LengthOf(one), 10 * kPi, 1e-9);
}

TEST(PathSection, SaysHowFarThePathGoesWhereItHoldsNothing) {
  ToolpathOptions options = PadOptions();
  options.share = PathSection{Eigen::Vector3d::UnitX(), 900, 1000, 0};
  const std::string told = PathRefusal(SampleMesh("support_pad"), options);
  EXPECT_NE(told.find("toolpath.share: nothing of the tool path lies in it"), std::string::npos) << told;
  EXPECT_NE(told.find("-40.000 to 40.000 mm"), std::string::npos) << told;
}

TEST(PathSection, HasEveryHoleOnce) {
  Drill drill;
  for (int i = 0; i < 7; ++i) drill.holes.push_back({{10.0 * i, 5, 0}, Eigen::Vector3d::UnitZ(), 4});
  ToolpathOptions options;
  options.strategy = std::make_shared<Drill>(drill);
  options.cutter = {2, 0, 40};
  const Mesh none(Triangles{});
  std::vector<double> holes;
  for (const auto& [from, to] : {std::pair(-5.0, 20.0), {20.0, 45.0}, {45.0, 100.0}}) {
    options.share = PathSection{Eigen::Vector3d::UnitX(), from, to, 0};
    for (const Pass& pass : MakeToolpath(none, options, {}).passes) {
      holes.push_back(pass.points.front().position.x());
      EXPECT_TRUE(from <= holes.back() && holes.back() < to);
    }
  }
  EXPECT_EQ(holes, (std::vector<double>{0, 10, 20, 30, 40, 50, 60}));
  options.share->overlap = 1;
  EXPECT_NE(PathRefusal(none, options).find("toolpath.share.overlap_mm: has no effect with strategy drill"),
            std::string::npos);
  options.share = PathSection{Eigen::Vector3d::UnitX(), 200, 300, 0};
  EXPECT_NE(PathRefusal(none, options).find("no hole lies in it"), std::string::npos);
}

}  // namespace
}  // namespace millpose
