// SPDX-License-Identifier: GPL-3.0-or-later
// Where a part stands: drawn places and noise come back within what the fit says of itself.
#include "base/rotation.hpp"
#include "geometry/mesh/point_fit.hpp"
#include "tests/base/tier.hpp"
#include "tests/geometry/panel.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

TEST(Registration, FindsAPlaceExactlyWhereNothingDisturbs) {
  RandomStream random(43, 1);
  for (int trial = 0; trial < 5; ++trial) {
    Drawn drawn = Draw(random, 20, 12, 0);
    for (ProbedPoint& point : drawn.points) point.sd = 0.01;
    const Registration found = Register(ThePanel().part, drawn.points, drawn.start);
    EXPECT_TRUE(found.determined());
    EXPECT_LT(Off(ThePanel().skin, drawn.X_true, found.X), 1e-5);
    EXPECT_LT((found.X.matrix() - drawn.X_true.matrix()).cwiseAbs().maxCoeff(), 1e-4);
  }
}

// The bound over the whole face holds as often as it says, whatever ball and place.
TEST(Registration, TheFaceIsWithinItsBoundAsOftenAsSaid) {
  const int draws = OfTier(100, 4000);
  RandomStream random(43, 2);
  int within = 0, told = 0;
  std::vector<double> worst;
  for (int trial = 0; trial < draws; ++trial) {
    const Drawn drawn = Draw(random, 40, 12, 0.18);
    const Registration found = Register(ThePanel().part, drawn.points, drawn.start);
    EXPECT_TRUE(found.converged);
    if (!found.determined()) continue;  // all of the sides' points lay on two sides
    ++told;
    worst.push_back(Off(ThePanel().milled, drawn.X_true, found.X));
    const FaceError error = ErrorOfFace(found.covariance, found.centre, ThePanel().milled);
    within += worst.back() <= error.off_95 ? 1 : 0;
  }
  const double share = 100.0 * within / told;
  EXPECT_GE(told, draws * 99 / 100);
  RecordProperty("coverage_percent", fmt::format("{:.1f}", share));
  RecordProperty("median_worst_mm", fmt::format("{:.3f}", Median(worst)));
  EXPECT_GE(share, OfTier(900, 930) / 10.0);
  EXPECT_LE(share, OfTier(1000, 970) / 10.0);
  EXPECT_NEAR(Median(worst), 0.11, 0.03);
}

// One chip of 1 mm under the ball among 18 points: least squares (which a deviation of 2 mm makes of Huber's
// fit) follows it, the robust fit names it.
TEST(Registration, AChipIsNamedAndMovesNothing) {
  const int draws = OfTier(60, 300);
  RandomStream random(43, 3);
  std::vector<double> robust, plain, apart;
  int named = 0, wrongly = 0;
  for (int trial = 0; trial < draws; ++trial) {
    Drawn drawn = Draw(random, 12, 6, 0.06);
    drawn.points[3].measured +=
        drawn.X_true.linear() * drawn.start.linear().transpose() * *drawn.points[3].normal;
    const Registration found = Register(ThePanel().part, drawn.points, drawn.start);
    robust.push_back(Off(ThePanel().milled, drawn.X_true, found.X));
    named += found.residuals[3].outlier ? 1 : 0;
    for (size_t i = 0; i < drawn.points.size(); ++i) wrongly += i != 3 && found.residuals[i].outlier ? 1 : 0;
    if (found.residuals[3].outlier && wrongly == 0) {  // as if it had not been probed
      std::vector<ProbedPoint> others = drawn.points;
      others.erase(others.begin() + 3);
      apart.push_back(Off(ThePanel().skin, found.X, Register(ThePanel().part, others, drawn.start).X));
    }
    for (ProbedPoint& point : drawn.points) point.sd = 2;
    plain.push_back(
        Off(ThePanel().milled, drawn.X_true, Register(ThePanel().part, drawn.points, drawn.start).X));
  }
  RecordProperty("robust_mm", fmt::format("{:.3f}", Median(robust)));
  RecordProperty("plain_mm", fmt::format("{:.3f}", Median(plain)));
  RecordProperty("wrongly_named", wrongly);
  EXPECT_LE(Median(robust), 0.08);
  EXPECT_LT(Median(apart), 1e-4);
  EXPECT_GE(Median(plain), 0.2);
  EXPECT_GE(named, draws * 9 / 10);
  EXPECT_LE(wrongly, draws / 10);
}

// Whoever states a tenth of the true deviation is told so, and the bound grows with what the points show.
TEST(Registration, PointsThatScatterMoreThanStatedCountForLess) {
  RandomStream random(43, 4);
  Drawn drawn = Draw(random, 80, 30, 0.2);
  const Registration honest = Register(ThePanel().part, drawn.points, drawn.start);
  for (ProbedPoint& point : drawn.points) point.sd = 0.02;
  const Registration boasting = Register(ThePanel().part, drawn.points, drawn.start);
  EXPECT_FALSE(honest.scatters_more);
  EXPECT_TRUE(boasting.scatters_more);
  EXPECT_NEAR(boasting.scatter, 10, 2);
  const double ratio = boasting.covariance.trace() / honest.covariance.trace();
  EXPECT_GT(ratio, 0.6);
  EXPECT_LT(ratio, 1.6);
}

TEST(Registration, AnyNumberOfThreadsFindsTheSameBits) {
  RandomStream random(43, 5);
  const Drawn drawn = Draw(random, 3000, 1000, 0.1);
  const Registration one = Register(ThePanel().part, drawn.points, drawn.start, 1);
  const Registration two = Register(ThePanel().part, drawn.points, drawn.start, 2);
  EXPECT_EQ(one.X.matrix(), two.X.matrix());
  EXPECT_EQ(one.covariance, two.covariance);
}

// Targets alone, all as good: the fit of Kabsch.
TEST(Registration, TargetsFitAsPointsDo) {
  RandomStream random(43, 6);
  const Eigen::Isometry3d start = SmallMove(random, 1000), X = start * SmallMove(random, 20);
  std::vector<ProbedPoint> points;
  std::vector<Vector3d> from, to;
  for (int i = 0; i < 6; ++i) {
    ProbedPoint point;
    point.on = ProbedOn::kTarget;
    point.nominal = 300 * NormalVector(random);
    point.measured = X * *point.nominal + 0.02 * NormalVector(random);
    point.sd = 1;  // far from Huber's bound
    points.push_back(point);
    from.push_back(*point.nominal);
    to.push_back(point.measured);
  }
  const ProbedPart part(SoundMesh(BoxShape({0, 0, 0}, {500, 300, 200})), kSharp);
  const Registration found = Register(part, points, start);
  EXPECT_LT((found.X.matrix() - FitPoints(from, to)->X.matrix()).cwiseAbs().maxCoeff(), 1e-5);
}

// Six points on a flat face tell three of six directions; the others are named and stay as they were.
TEST(Registration, WhatNoPointTellsIsNamed) {
  const ProbedPart part(SoundMesh(BoxShape({0, 0, 0}, {500, 300, 200})), kSharp);
  std::vector<ProbedPoint> points;
  for (const auto& [x, y] : {std::pair(50, 40), {450, 60}, {60, 250}, {440, 260}, {250, 150}, {300, 100}}) {
    ProbedPoint point;
    point.measured = Vector3d(x, y, 200.5);
    point.sd = 0.05;
    points.push_back(point);
  }
  const Registration found = Register(part, points, Eigen::Isometry3d::Identity());
  ASSERT_EQ(found.undetermined.size(), 3u);
  EXPECT_EQ(found.undetermined[0].substr(0, 14), "a shift along ");
  EXPECT_EQ(found.undetermined[2], "a turn about (0.00, 0.00, 1.00)");
  EXPECT_FALSE(found.determined());
  EXPECT_NEAR(found.X.translation().z(), 0.5, 1e-6);
  EXPECT_NEAR(found.X.translation().head<2>().norm(), 0, 1e-9);
}

// Faces, edges and holes together, each alone not enough.
TEST(Registration, AnyMixtureOfFeaturesServes) {
  RandomStream random(43, 7);
  // A round block with a hole through it and a flat on top.
  const ProbedPart part(SoundMesh(LatheShape({{10, 0}, {60, 0}, {60, 40}, {10, 40}, {10, 0}}, 96)), kSharp);
  ASSERT_TRUE(part.HasHoles());
  const Eigen::Isometry3d start = SmallMove(random, 300);
  Eigen::Isometry3d move = Eigen::Isometry3d::Identity();
  move.linear() = RotationAbout(Vector3d(1, 2, 0).normalized(), 0.004);
  move.translation() = Vector3d(0.4, -0.3, 0.7);
  const Eigen::Isometry3d X = start * move;
  std::vector<ProbedPoint> points;
  const auto add = [&](ProbedOn on, const Vector3d& p) {
    ProbedPoint point;
    point.on = on;
    point.measured = X * p;
    point.sd = 0.02;
    points.push_back(point);
  };
  for (const auto& [x, y] : {std::pair(30, 5), {-25, 20}, {3, -35}}) add(ProbedOn::kFace, Vector3d(x, y, 40));
  add(ProbedOn::kHole, Vector3d(0, 0, 22));
  const Registration round = Register(part, points, start);
  // A turn about its own axis nobody can tell of a round part.
  ASSERT_EQ(round.undetermined.size(), 1u);
  EXPECT_EQ(round.undetermined[0].substr(0, 12), "a turn about");
  for (const PartPlace& place :
       {PartPlace{{40, 0, 40}, {0, 0, 1}}, {{0, 40, 40}, {0, 0, 1}}, {{60, 0, 20}, {1, 0, 0}}}) {
    const Vector3d moved = X.inverse(Eigen::Isometry) * round.X * place.position - place.position;
    EXPECT_NEAR(place.normal.dot(moved), 0, 1e-4);
  }
  const ProbedPart box(SoundMesh(BoxShape({0, 0, 0}, {500, 300, 200})), kSharp);
  points.clear();
  for (const Vector3d& p :
       {Vector3d(100, 0, 200), {400, 0, 200}, {0, 100, 200}, {0, 250, 200}, {500, 300, 90}})
    add(ProbedOn::kEdge, p);
  const Registration by_edges = Register(box, points, start);
  EXPECT_TRUE(by_edges.determined());
  EXPECT_LT((by_edges.X.matrix() - X.matrix()).cwiseAbs().maxCoeff(), 1e-4);
}

// What is foretold of a proposed place is what probing there brings.
TEST(NextPlaces, LowerTheWorstErrorAsForetold) {
  RandomStream random(43, 8);
  Drawn drawn = Draw(random, 10, 8, 0.05);
  const Registration before = Register(ThePanel().part, drawn.points, drawn.start);
  const std::vector<PartPlace> candidates = PlacesToProbe(ThePanel().part.mesh(), 100, 1, kSharp, 400);
  const auto any = [](size_t) { return true; };
  const std::vector<NextPlace> next =
      ProposePlaces(before.covariance, before.centre, ThePanel().milled, candidates, 0.05, 3, any);
  ASSERT_EQ(next.size(), 3u);
  const FaceError now = ErrorOfFace(before.covariance, before.centre, ThePanel().milled);
  double last = now.sd[now.worst];
  for (const NextPlace& place : next) {
    EXPECT_LT(place.worst_sd, last);
    last = place.worst_sd;
  }
  for (const NextPlace& place : next) {
    const PartPlace& where = candidates[place.candidate];
    ProbedPoint point;
    point.sd = 0.05;
    point.measured = before.X * where.position;
    point.normal = before.X.linear() * where.normal;
    drawn.points.push_back(point);
  }
  const Registration after = Register(ThePanel().part, drawn.points, drawn.start);
  const FaceError then = ErrorOfFace(after.covariance, after.centre, ThePanel().milled);
  EXPECT_NEAR(then.sd[then.worst] / last, 1, 0.15);
  // None better is left out: of all candidates the first is the best single one.
  for (size_t i = 0; i < candidates.size(); i += 7) {
    const auto only =
        ProposePlaces(before.covariance, before.centre, ThePanel().milled, {candidates[i]}, 0.05, 1, any);
    EXPECT_GE(only.at(0).worst_sd, next[0].worst_sd * (1 - 1e-12));
  }
  const auto none = ProposePlaces(before.covariance, before.centre, ThePanel().milled, candidates, 0.05, 1,
                                  [&](size_t candidate) { return candidate != next[0].candidate; });
  EXPECT_NE(none.at(0).candidate, next[0].candidate);
}

// A scan: as fast as a scanner's user expects, in the quick tier with fewer points.
TEST(Registration, AScanIsFoundInSeconds) {
  RandomStream random(43, 9);
  const auto count = static_cast<size_t>(OfTier(4000, 100000));
  const Drawn drawn = Draw(random, count * 9 / 10, count / 10, 0.1, 0);
  const Registration found = Register(ThePanel().part, drawn.points, drawn.start, 2);
  EXPECT_TRUE(found.determined());
  EXPECT_LT(Off(ThePanel().milled, drawn.X_true, found.X), 0.02);
}

}  // namespace
}  // namespace millpose
