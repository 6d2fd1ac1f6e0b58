// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/resample.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "geometry/mesh/triangle.hpp"

namespace millpose {
namespace {

Curve Polyline(const std::vector<Eigen::Vector3d>& points) {
  Curve curve;
  for (size_t i = 0; i + 1 < points.size(); ++i)
    curve.pieces.push_back(LinePiece(0, points[i], points[i + 1]));
  return curve;
}

Curve CirclePart(double radius, double angle) {
  CurvePiece piece;
  piece.face = 0;
  piece.arc = true;
  piece.u = {radius, 0, 0};
  piece.v = {0, radius, 0};
  piece.angle1 = angle;
  piece.start = piece.u;
  piece.end =
      angle >= 2 * kPi ? piece.u : Eigen::Vector3d(std::cos(angle) * piece.u + std::sin(angle) * piece.v);
  Curve curve;
  curve.pieces = {piece};
  curve.closed = angle >= 2 * kPi;
  return curve;
}

// The largest distance of densely sampled curve points from the chord that spans them, and the largest
// spacing.
std::pair<double, double> DeviationAndSpacing(const Curve& curve, std::vector<CurvePoint> points) {
  double deviation = 0, spacing = 0;
  if (curve.closed) points.push_back({static_cast<int>(curve.pieces.size()) - 1, 1.0, 0});
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector3d a = curve.pieces[points[i].piece].At(points[i].t),
                          b = curve.pieces[points[i + 1].piece].At(points[i + 1].t);
    spacing = std::max(spacing, (b - a).norm());
    for (int piece = points[i].piece; piece <= points[i + 1].piece; ++piece) {
      const double from = piece == points[i].piece ? points[i].t : 0,
                   to = piece == points[i + 1].piece ? points[i + 1].t : 1;
      for (int k = 0; k <= 50; ++k) {
        const Eigen::Vector3d p = curve.pieces[piece].At(from + (to - from) * k / 50);
        deviation = std::max(deviation, (a + ClosestOnSegment(p, a, b) * (b - a) - p).norm());
      }
    }
  }
  return {deviation, spacing};
}

TEST(Resample, StraightLineIsCutEvenly) {
  const auto points = Resample(Polyline({{0, 0, 0}, {3, 0, 0}, {10, 0, 0}}), 0.01, 4);
  ASSERT_EQ(points.size(), 4);  // the corner that is none does not count
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(points[i].arc_length, i * 10.0 / 3, 1e-12);
  EXPECT_EQ(points[1].piece, 1);
  EXPECT_NEAR(points[1].t, (10.0 / 3 - 3) / 7, 1e-12);
}

TEST(Resample, CornersStay) {
  const auto points = Resample(Polyline({{0, 0, 0}, {3, 0, 0}, {3, 2, 0}}), 0.01, 100);
  ASSERT_EQ(points.size(), 3);
  EXPECT_EQ(points[1].arc_length, 3);
}

TEST(Resample, ArcsKeepToleranceAndSpacing) {
  for (const double angle : {0.5, 3.0, 2 * kPi})
    for (const double tolerance : {0.001, 0.01, 0.5}) {
      const Curve curve = CirclePart(100, angle);
      const auto points = Resample(curve, tolerance, 5);
      const auto [deviation, spacing] = DeviationAndSpacing(curve, points);
      EXPECT_LE(deviation, tolerance);
      EXPECT_LE(spacing, 5);
      // No more points than a few times what is needed.
      const double chord = std::min(5.0, std::sqrt(8 * 100 * tolerance));
      EXPECT_LE(points.size(), 3 * angle * 100 / chord + 3);
    }
}

TEST(Resample, RandomPolylinesKeepToleranceAndSpacing) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    RandomStream random(seed, 0);
    std::vector<Eigen::Vector3d> corners{Eigen::Vector3d::Zero()};
    for (int i = 0; i < 60; ++i)
      corners.push_back(corners.back() +
                        Eigen::Vector3d{random.Uniform(0.1, 2), random.Uniform(-0.02, 0.02), 0});
    const Curve curve = Polyline(corners);
    const auto points = Resample(curve, 0.02, 3);
    const auto [deviation, spacing] = DeviationAndSpacing(curve, points);
    EXPECT_LE(deviation, 0.02);
    EXPECT_LE(spacing, 3 + 1e-9);
    EXPECT_EQ(points.front().arc_length, 0);
    EXPECT_EQ(points.back().t, 1);
  }
}

TEST(Resample, PartsKeepThePointsOfFewerParts) {
  for (const Curve& curve :
       {CirclePart(100, 3), CirclePart(100, 2 * kPi), Polyline({{0, 0, 0}, {7, 0.3, 0}, {31, 4, 1}})}) {
    std::vector<CurvePoint> before = Resample(curve, 0.01, 5);
    for (const int parts : {2, 4, 16}) {
      const std::vector<CurvePoint> finer = Resample(curve, 0.01, 5, parts);
      const size_t stride = parts == 16 ? 4 : 2;
      EXPECT_EQ((finer.size() + stride - 1) / stride, before.size());
      for (size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(finer[stride * i].piece, before[i].piece);
        EXPECT_EQ(finer[stride * i].t, before[i].t);
        EXPECT_EQ(finer[stride * i].arc_length, before[i].arc_length);
      }
      before = finer;
    }
  }
}

TEST(Resample, ClosedCurvesDoNotRepeatTheirStart) {
  const Curve curve = CirclePart(50, 2 * kPi);
  const auto points = Resample(curve, 0.01, 5);
  EXPECT_LT(points.back().arc_length, 2 * kPi * 50 - 1);
}

}  // namespace
}  // namespace millpose
