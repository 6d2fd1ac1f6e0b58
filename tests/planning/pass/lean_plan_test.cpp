// SPDX-License-Identifier: GPL-3.0-or-later
// Passes planned with lead and tilt as freedoms.
#include <numeric>

#include "base/value_bytes.hpp"
#include "planning/pass/lean_courses.hpp"
#include "planning/pass/nominal_plan.hpp"
#include "tests/base/tier.hpp"
#include "tests/planning/pass/exhaustive_lean.hpp"
#include "tests/planning/pass/pass_problem.hpp"
#include "tests/planning/pose/lean_problems.hpp"
#include "toolpath/deepest_gouge.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

PassResult Plan(const PoseProblem& problem, const Pass& pass, const PathOptions& options, int threads = 2) {
  return PlanPass(problem, World(EmptyCell(problem)), {pass}, options, {.threads = threads});
}

double Sum(const PassResult& plan) {
  return std::accumulate(plan.points.begin(), plan.points.end(), 0.0,
                         [](double sum, const PlannedPoint& point) { return sum + point.objective; });
}

double Worst(const PassResult& plan) {
  return std::ranges::max(plan.points, {}, &PlannedPoint::objective).objective;
}

/// Poses meet the contacts, leans keep their ranges and change no faster than they may, steps keep theirs.
void ExpectLeansSound(const PoseProblem& problem, const PathOptions& options, const Pass& pass,
                      const PassResult& plan) {
  ASSERT_EQ(plan.points.size(), pass.points.size());
  const std::vector<MillingPoint> contacts = StepPoints(problem, pass.points);
  const std::vector<double> most = LeanBounds(problem, options.max_lean_change, pass.points);
  for (size_t t = 0; t < plan.points.size(); ++t) {
    const PlannedPoint& planned = plan.points[t];
    ASSERT_EQ(planned.skip, Infeasibility::kNone) << planned.detail;
    const Pose X_WT = problem.X_WB * ForwardFlange(problem.arm, planned.q) * problem.X_FT;
    EXPECT_LT((X_WT.translation() - planned.point.position).norm(), 1e-8);
    EXPECT_LT((X_WT.linear().col(2) - planned.point.tool_axis).norm(), 1e-10);
    EXPECT_LT((ContactOf(problem, planned.point).place - contacts[t].position).norm(), 1e-8);
    const Leans leans = LeansOf(X_WT.linear().col(2), planned.point.normal, planned.point.feed);
    EXPECT_NEAR(leans.lead, planned.freedoms[1], 1e-9);
    EXPECT_NEAR(leans.tilt, planned.freedoms[2], 1e-9);
    for (size_t d : {1, 2}) {
      EXPECT_GE(planned.freedoms[d], problem.freedoms[d]->Lower() - 1e-12);
      EXPECT_LE(planned.freedoms[d], problem.freedoms[d]->Upper() + 1e-12);
    }
    EXPECT_LE(planned.own_optimum, planned.objective * (1 + 1e-9));
    EXPECT_LE(planned.free_optimum, planned.objective);
    if (t == 0 && !pass.closed) continue;
    const size_t before = t > 0 ? t - 1 : plan.points.size() - 1;
    EXPECT_TRUE(LeansWithin(plan.points[before].freedoms, planned.freedoms, most[before] + 1e-9)) << t;
    const Joints step = (planned.q - plan.points[before].q).unaryExpr(&WrapToPi);
    const Joints bound = StepBound(options.steps, problem.arm, contacts[before], contacts[t]);
    EXPECT_TRUE((step.cwiseAbs().array() <= bound.array() + 1e-9).all()) << t;
  }
}

TEST(LeanPlan, IsSoundAndBetterThanWithoutLeans) {
  const PoseProblem problem = LeaningProblem();
  PathOptions options = Options();
  const Pass pass = Row(-150, 150, 31);
  const PassResult plan = Plan(problem, pass, options), nominal = Plan(AtOwnAxis(problem), pass, options);
  ExpectLeansSound(problem, options, pass, plan);
  EXPECT_LT(Sum(plan), 0.97 * Sum(nominal));
  // Even leans: from one change to the next by less than what a change may be.
  double uneven = 0;
  for (size_t t = 1; t + 1 < plan.points.size(); ++t)
    for (size_t d : {1, 2})
      uneven = std::max(uneven, std::abs(plan.points[t - 1].freedoms[d] - 2 * plan.points[t].freedoms[d] +
                                         plan.points[t + 1].freedoms[d]));
  EXPECT_LT(uneven, 0.95 * 10 * options.max_lean_change);
  // Back at the nominal lean, the points are those of the tool path.
  const PassResult laid = AtNominalLean(problem, plan);
  for (size_t t = 0; t < pass.points.size(); ++t)
    EXPECT_LT((laid.points[t].point.position - pass.points[t].position).norm(), 1e-9);

  options.worst_first = true;
  const PassResult worst = Plan(problem, pass, options);
  ExpectLeansSound(problem, options, pass, worst);
  EXPECT_LT(Worst(worst), 0.97 * Worst(Plan(AtOwnAxis(problem), pass, options)));
}

TEST(LeanPlan, ClosesRings) {
  const PoseProblem problem = LeaningProblem();
  PathOptions options = Options();
  options.steps.most.setConstant(DegToRad(20));
  const Pass pass = Ring(150, 24);
  const PassResult plan = Plan(problem, pass, options), nominal = Plan(AtOwnAxis(problem), pass, options);
  ASSERT_EQ(plan.pieces.size(), 1u);
  EXPECT_TRUE(plan.pieces[0].closed);
  ExpectLeansSound(problem, options, pass, plan);
  EXPECT_LT(Sum(plan), Sum(nominal));
}

TEST(LeanPlan, IsTheSameForAnyNumberOfThreads) {
  const PoseProblem problem = LeaningProblem();
  const Pass pass = Row(-60, 60, 13);
  const std::string one = HashOfValues(Plan(problem, pass, Options(), 1));
  EXPECT_EQ(HashOfValues(Plan(problem, pass, Options(), 2)), one);
  EXPECT_EQ(HashOfValues(Plan(problem, pass, Options(), 4)), one);
}

// The path's windows find valleys that the search of a point alone may miss.
TEST(LeanPlan, NoPointsOwnOptimumLiesAboveItsPlan) {
  for (const double front : {1750.0, 2050.0})
    for (const double step : {5.0, 10.0}) {
      const PoseProblem problem = LeaningProblem(10, step);
      PathOptions options = Options();
      options.motion_share = 0;
      options.smoothing_loss = 0;
      Pass pass;
      for (int t = 0; t < 24; ++t) {
        pass.points.push_back(PanelPoint(-230 + 20 * t, 150, front));
        pass.points.back().arc_length = 20 * t;
      }
      for (const PlannedPoint& point : Plan(problem, pass, options).points) {
        if (point.skip != Infeasibility::kNone) continue;
        EXPECT_LE(point.own_optimum, point.free_optimum) << front << " " << step;
        EXPECT_LE(point.free_optimum, point.objective) << front << " " << step;
      }
    }
}

// Against every sequence on a grid: in the slow tier of rotations 2° apart and leans 1° apart.
TEST(LeanPlan, IsWithinHalfAPercentOfTheExhaustiveSearch) {
  for (const double front : {1750.0, 2050.0}) {
    const PoseProblem problem = LeaningProblem(OfTier(6, 10), 5);
    PathOptions options = Options();
    options.max_lean_change = DegToRad(0.2);
    options.motion_share = 0;
    options.smoothing_loss = 0;
    Pass pass;
    for (int t = 0; t < OfTier(5, 8); ++t) {
      pass.points.push_back(PanelPoint(-200 + 10 * t, 150, front));
      pass.points.back().arc_length = 10 * t;
    }
    const PassResult plan = Plan(problem, pass, options);
    ExpectLeansSound(problem, options, pass, plan);
    const double exhaustive =
        ExhaustiveLeanSum(problem, options, pass, DegToRad(OfTier(4, 2)), DegToRad(OfTier(2, 1)));
    ASSERT_TRUE(std::isfinite(exhaustive));
    EXPECT_LT(Sum(plan), 1.005 * exhaustive) << front;
    EXPECT_GT(Sum(plan), 0.97 * exhaustive) << front;
  }
}

/// Walls along a row, `away` from it to these sides, from `bottom` to 60 mm over the surface.
Mesh Walls(double away, std::vector<double> sides = {-1.0, 1.0}, double bottom = -5) {
  Triangles walls;
  for (const double side : sides) {
    const int first = static_cast<int>(walls.vertices.size());
    constexpr int kParts = 24;
    for (int i = 0; i <= kParts; ++i) {
      const MillingPoint on = PanelPoint(-150 + 300.0 * i / kParts, side * away);
      for (const double height : {bottom, 60.0})
        walls.vertices.emplace_back(on.position + height * on.normal);
    }
    for (int i = 0; i < kParts; ++i) {
      const int a = first + 2 * i;
      walls.faces.push_back({a, a + 1, a + 2});
      walls.faces.push_back({a + 2, a + 1, a + 3});
    }
  }
  return Mesh(std::move(walls));
}

/// Gives the problem a part.
void Mill(const Mesh& part, double tolerance, PoseProblem& problem) {
  problem.lean->surface = std::make_shared<const LeanSurface>(
      part, CornerNormals(part, DegToRad(30)), Pose::Identity(), problem.lean->cutter, tolerance);
}

/// How deep a plan goes into a part, by looking at its poses and at ten between neighbours.
double Deepest(const Mesh& part, const CutterShape& cutter, const PassResult& plan) {
  double depth = 0;
  for (size_t t = 0; t < plan.points.size(); ++t)
    for (int i = 0; i < 10; ++i) {  // from each point to the next
      const MillingPoint &from = plan.points[t].point,
                         &to = plan.points[std::min(t + 1, plan.points.size() - 1)].point;
      const Vector3d axis = (from.tool_axis + 0.1 * i * (to.tool_axis - from.tool_axis)).normalized();
      const Vector3d tip = from.position + 0.1 * i * (to.position - from.position);
      depth = std::max(depth, DeepestGouge(part, cutter, tip, axis, 0).depth);
    }
  return depth;
}

// Between walls that an upright cutter clears by 1 mm.
TEST(LeanPlan, NeverGoesIntoThePart) {
  constexpr double kTolerance = 0.05;
  PoseProblem problem = LeaningProblem();
  PathOptions options = Options();
  const Pass pass = Row(-100, 100, 21);
  const CutterShape cutter = problem.lean->cutter;
  const Mesh walls = Walls(9);
  EXPECT_GT(Deepest(walls, cutter, Plan(problem, pass, options)), 1);
  Mill(walls, kTolerance, problem);
  const PassResult plan = Plan(problem, pass, options);
  ExpectLeansSound(problem, options, pass, plan);
  EXPECT_LE(Deepest(walls, cutter, plan), kTolerance + 1e-3);
  EXPECT_LT(Sum(plan), Sum(Plan(AtOwnAxis(problem), pass, options)));
}

// Under an edge beside the row that an upright shank would cut by 1 mm: only leaning away from it is clear.
TEST(LeanPlan, TakesAnotherLeanWhereTheNominalOneGouges) {
  constexpr double kTolerance = 0.05;
  const PathOptions options = Options();
  const Pass pass = Row(-100, 100, OfTier(11, 21));
  for (const double side : {-1.0, 1.0}) {
    const Mesh edge = Walls(7, {side}, 20);
    PoseProblem problem = LeaningProblem();
    Mill(edge, kTolerance, problem);
    const PassResult plan = Plan(problem, pass, options);
    ExpectLeansSound(problem, options, pass, plan);
    EXPECT_EQ(plan.pieces.size(), 1u);
    EXPECT_LE(Deepest(edge, problem.lean->cutter, plan), kTolerance + 1e-3);
    EXPECT_GT(Deepest(edge, problem.lean->cutter, AtNominalLean(problem, plan)), 0.5);

    problem = LeaningProblem(2, 1);
    Mill(edge, kTolerance, problem);
    for (const PlannedPoint& point : Plan(problem, pass, options).points)
      EXPECT_EQ(point.skip, Infeasibility::kGouge) << point.detail;
  }
}

// What bars a lean bars it alone: the nominal one stays, and more than that where the tool has room.
TEST(LeanPlan, LosesNothingToInterferenceThatTheNominalLeanKeeps) {
  const PoseProblem problem = LeaningProblem();
  const PathOptions options = Options();
  const Pass pass = Row(-100, 100, 21);
  const PassResult free = Plan(problem, pass, options);
  const Cell cell = CellWithBallAt(problem, free, 10, 60);
  const World world(cell);
  const PassResult plan = PlanPass(problem, world, {pass}, options, {.threads = 2});
  const PassResult nominal = PlanPass(AtOwnAxis(problem), world, {pass}, options, {.threads = 2});
  const auto skipped = [](const PassResult& of) {
    return std::ranges::count_if(of.points,
                                 [](const PlannedPoint& p) { return p.skip != Infeasibility::kNone; });
  };
  EXPECT_EQ(skipped(plan), skipped(nominal));
  EXPECT_LE(Sum(plan), Sum(nominal));
  Checker checker(world);
  for (const PlannedPoint& point : plan.points)
    if (point.skip == Infeasibility::kNone) {
      EXPECT_FALSE(checker.Blocked(point.q, Phase::kCutting));
    }
}

}  // namespace
}  // namespace millpose
