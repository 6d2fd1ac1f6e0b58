// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/pass_planner.hpp"

#include "base/error.hpp"
#include "planning/ladder/edge_kernel.hpp"
#include "planning/pass/revolutions.hpp"
#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

TEST(PlanPass, FollowsARow) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const Pass pass = Row(-300, 300, 60);
  const PassResult result = PlanPass(problem, world, {pass, 3, 100}, Options(), {.threads = 2});
  ExpectSound(problem, Options(), pass, result);
  ASSERT_EQ(result.pieces.size(), 1u);
  EXPECT_EQ(result.pieces[0].pass, 3);
  double path = 0, own = 0;
  for (const PlannedPoint& point : result.points) {
    path += point.objective;
    own += point.own_optimum;
  }
  EXPECT_LT(path, 1.05 * own);
  EXPECT_GE(result.grid_gap, 0);
  EXPECT_LT(result.grid_gap, 0.05);
}

TEST(PlanPass, APointAloneBetweenSkippedOnesSaysSo) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  Pass pass = Row(-60, 60, 12);
  pass.points[4].gouge = pass.points[6].gouge = 0.2;
  const PassResult result = PlanPass(problem, World(EmptyCell(problem)), {pass}, Options(), {.threads = 2});
  ExpectSound(problem, Options(), pass, result);
  EXPECT_EQ(result.points[4].skip, Infeasibility::kGouge);
  EXPECT_EQ(result.points[5].skip, Infeasibility::kStep);
  EXPECT_EQ(result.points[5].detail, "is alone between skipped points; a single point is no cut");
  EXPECT_EQ(result.pieces.size(), 2u);
}

TEST(PlanPass, SameBytesForAnyNumberOfThreads) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const Pass pass = Row(-60, 60, 12);
  std::vector<PassResult> results;
  for (const int threads : {1, 2, 4}) {
    results.push_back(PlanPass(problem, world, {pass}, Options(), {.threads = threads}));
  }
  for (size_t t = 0; t < pass.points.size(); ++t) {
    for (const PassResult& other : results) {
      EXPECT_EQ(results[0].points[t].q, other.points[t].q);
      EXPECT_EQ(results[0].points[t].objective, other.points[t].objective);
      EXPECT_EQ(results[0].points[t].genetic_optimum, other.points[t].genetic_optimum);
    }
  }
}

TEST(PlanPass, ClosesARing) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const Pass pass = Ring(400, 150);
  const PassResult result = PlanPass(problem, world, {pass}, Options(), {.threads = 2});
  ExpectSound(problem, Options(), pass, result);
  ASSERT_EQ(result.pieces.size(), 1u);
  EXPECT_TRUE(result.pieces[0].closed);
}

TEST(PlanPass, OneBadPointDoesNotCostThePass) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  Pass pass = Row(-40, 40, 16);
  pass.points[5].position.x() += 9000;
  pass.points[7].position.x() += 9000;  // leaves point 6 alone
  const PassResult result = PlanPass(problem, world, {pass}, Options(), {.threads = 2});
  ExpectSound(problem, Options(), pass, result);
  EXPECT_EQ(result.points[5].skip, Infeasibility::kUnreachable);
  EXPECT_EQ(result.points[6].skip, Infeasibility::kStep);
  EXPECT_EQ(result.points[7].skip, Infeasibility::kUnreachable);
  ASSERT_EQ(result.pieces.size(), 2u);
  EXPECT_EQ(result.pieces[1].first, 8);
}

TEST(PlanPass, HalfThePartOutOfReachLeavesTheOtherHalf) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  Pass pass = Row(-60, 60, 24);
  for (int t = 12; t < 24; ++t) pass.points[t].position.x() += 3000;
  const PassResult result = PlanPass(problem, world, {pass}, Options(), {.threads = 2});
  ExpectSound(problem, Options(), pass, result);
  ASSERT_EQ(result.pieces.size(), 1u);
  for (int t = 0; t < 24; ++t) {
    EXPECT_EQ(result.points[t].skip, t < 12 ? Infeasibility::kNone : Infeasibility::kUnreachable) << t;
  }
  EXPECT_TRUE(result.uncut.empty());
}

TEST(PlanPass, SmoothsWhatItFinds) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const Pass pass = Row(-300, 300, 60);
  PathOptions options = Options();
  options.max_deviation = 0.5;
  PathOptions rough = options;
  rough.smoothing_loss = 0;
  const PassResult smooth = PlanPass(problem, world, {pass}, options, {.threads = 2});
  ExpectSound(problem, options, pass, smooth);
  const PassResult before = PlanPass(problem, world, {pass}, rough, {.threads = 2});
  const Smoothing& figures = smooth.smoothing;
  EXPECT_LT(figures.square_after, 0.25 * figures.square_before);
  EXPECT_LE(figures.objective_after, 1.01 * figures.objective_before);
  EXPECT_NEAR(figures.square_before, before.smoothing.square_after, 1e-12 * figures.square_before);
  EXPECT_EQ(before.smoothing.square_after, before.smoothing.square_before);
}

TEST(PlanPass, RingsInsideACabinWindAJointAndTheNextRunsTheOtherWay) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  // The inner skin of a cabin that lies along the arm's reach, the tool radial: once round turns it by 360°.
  const auto ring = [](double x) {
    constexpr int kPoints = 100;
    constexpr double kRadius = 450;
    Pass pass;
    pass.closed = true;
    pass.rotation_reference = Eigen::Vector3d::UnitX();
    for (int t = 0; t < kPoints; ++t) {
      const double angle = 2 * kPi * t / kPoints;
      const Eigen::Vector3d out(0, std::sin(angle), std::cos(angle));
      MillingPoint point;
      point.position = Eigen::Vector3d(x, 0, 1300) + kRadius * out;
      point.normal = point.tool_axis = -out;
      point.feed = Eigen::Vector3d(0, std::cos(angle), -std::sin(angle));
      point.feed_rate = 10;
      point.arc_length = kRadius * angle;
      pass.points.push_back(point);
    }
    return pass;
  };
  std::vector<PassResult> as_laid;
  for (int p = 0; p < 3; ++p) {
    const Pass pass = ring(1900 + 20 * p);
    as_laid.push_back(
        PlanPass(problem, world, {pass, p, 100 * static_cast<size_t>(p)}, Options(), {.threads = 2}));
    ExpectSound(problem, Options(), pass, as_laid.back());
    ASSERT_EQ(as_laid.back().pieces.size(), 1u);
    ASSERT_TRUE(as_laid.back().pieces[0].closed);
  }
  const auto end = [](const PassResult& pass) -> Joints {  // back at the first point, turns counted
    const Joints &first = pass.points.front().q, &last = pass.points.back().q;
    return last + (first - last).unaryExpr(&WrapToPi);
  };
  const Joints winding = end(as_laid[0]) - as_laid[0].points.front().q;
  EXPECT_NEAR(winding.cwiseAbs().sum(), 2 * kPi, 1e-9) << "one joint, once round";
  const Joints home = Degrees(0, -90, 90, 0, 0, 0);
  const auto turning = [&](const std::vector<PassResult>& passes) {
    double sum = 0;
    Joints at = home;
    for (const PassResult& pass : passes) {
      sum += (pass.points.front().q - at).cwiseAbs().sum();
      at = end(pass);
    }
    return sum + (home - at).cwiseAbs().sum();
  };
  std::vector<PassResult> free = as_laid;
  ChooseRevolutions(as_laid, {home, problem.bounds.lower, problem.bounds.upper, false});
  ChooseRevolutions(free, {home, problem.bounds.lower, problem.bounds.upper, true});
  EXPECT_LT(turning(free), turning(as_laid) - DegToRad(600)) << "two unwindings saved";
  for (const PassResult& pass : free) {
    for (size_t t = 1; t < pass.points.size(); ++t) {
      const Joints step = pass.points[t].q - pass.points[t - 1].q;
      EXPECT_LE(step.cwiseAbs().maxCoeff(), DegToRad(5) + 1e-9);
    }
    EXPECT_TRUE((end(pass).array() >= problem.bounds.lower.array() - 1e-9).all());
    EXPECT_TRUE((end(pass).array() <= problem.bounds.upper.array() + 1e-9).all());
  }
}

TEST(PlanPass, StopsWhenAsked) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(PlanPass(problem, World(EmptyCell(problem)), {Row(-60, 60, 8)}, Options(),
                        {.threads = 1, .stop = source.get_token()}),
               Interrupted);
}

}  // namespace
}  // namespace millpose
