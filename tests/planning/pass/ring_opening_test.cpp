// SPDX-License-Identifier: GPL-3.0-or-later
// Rings that are left open, and lifts that pay.
#include "planning/pass/ring_opening.hpp"

#include "base/value_bytes.hpp"
#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

Pass OpenRing(double radius, int count, RingOpening opening) {
  Pass pass = Ring(radius, count);
  pass.opening = opening;
  for (size_t t = 0; t < pass.points.size(); ++t) {
    pass.points[t].arc_length = 2 * radius * std::sin(kPi / count) * static_cast<double>(t);
    pass.points[t].feed_rate = 10;
  }
  return pass;
}

double SumOf(const PassResult& result) {
  double sum = 0;
  for (const PlannedPoint& point : result.points)
    if (point.point.kind == PointKind::kCut) sum += point.objective;
  return sum;
}

double WorstOf(const PassResult& result) {
  double worst = 0;
  for (const PlannedPoint& point : result.points)
    if (point.point.kind == PointKind::kCut) worst = std::max(worst, point.objective);
  return worst;
}

void ExpectOpened(const Pass& pass, const PassResult& result) {
  ASSERT_EQ(result.pieces.size(), 1u);
  EXPECT_FALSE(result.pieces[0].closed);
  EXPECT_TRUE(result.uncut.empty());
  for (size_t t = 0; t < pass.points.size(); ++t) EXPECT_TRUE(IsCut(pass, result, t)) << t;
  const auto height = [](const PlannedPoint& point) { return 2000 - point.point.position.x(); };
  const PlannedPoint &first = result.points.front(), &last = result.points.back();
  EXPECT_EQ(first.point.kind, PointKind::kLeadIn);
  EXPECT_EQ(last.point.kind, PointKind::kLeadOut);
  EXPECT_NEAR(height(first), 10, 1e-9) << "an arc";
  EXPECT_NEAR(height(last), 10, 1e-9) << "an arc";
  ASSERT_GE(result.opened_at, 0);
  const auto cut = std::ranges::find(result.points, PointKind::kCut,
                                     [](const PlannedPoint& point) { return point.point.kind; });
  EXPECT_EQ(cut->point.position, pass.points[static_cast<size_t>(result.opened_at)].position);
  for (size_t t = 1; t < result.points.size(); ++t)
    EXPECT_GT(result.points[t].point.arc_length, result.points[t - 1].point.arc_length);
}

PoseProblem HeldArm() {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.bounds.lower[5] = DegToRad(-100);
  problem.bounds.upper[5] = DegToRad(100);
  return problem;
}

TEST(OpenRing, BeginsWhereThatCostsLeast) {
  const PoseProblem problem = HeldArm();
  const World world(EmptyCell(problem));
  PathOptions options = Options();
  const Pass pass = OpenRing(450, 60, RingOpening::kAnywhere);
  for (const bool worst_first : {false, true}) {
    options.worst_first = worst_first;
    const PassResult result = PlanPass(problem, world, {pass}, options, {.threads = 1});
    ExpectSound(problem, options, pass, result);
    ExpectOpened(pass, result);
    // Neither closed nor from any other start does it cost less, but for the overlap, refinement and
    // smoothing.
    const double value = worst_first ? WorstOf(result) : SumOf(result);
    Pass given = pass;
    for (const size_t start : {0, 15}) {
      given.opening = RingOpening::kAtStart;
      const PassResult other = PlanPass(problem, world, {BeginningAt(given, start)}, options, {.threads = 2});
      EXPECT_EQ(other.opened_at, 0);
      EXPECT_GT(worst_first ? WorstOf(other) : SumOf(other), 0.99 * value) << start;
    }
    given.opening = RingOpening::kNone;
    const PassResult closed = PlanPass(problem, world, {given}, options, {.threads = 2});
    EXPECT_TRUE(closed.pieces[0].closed);
    EXPECT_GT(worst_first ? WorstOf(closed) : SumOf(closed), 1.05 * value);
    if (worst_first) continue;
    const std::string bytes = HashOfValues(result);
    EXPECT_EQ(HashOfValues(PlanPass(problem, world, {pass}, options, {.threads = 2})), bytes);
    EXPECT_EQ(HashOfValues(PlanPass(problem, world, {pass}, options, {.threads = 4})), bytes);
  }
}

TEST(Lifts, AreMadeWhereTheyPayAndCutEverything) {
  const PoseProblem problem = HeldArm();
  const World world(EmptyCell(problem));
  const Pass pass = Row(-450, 450, 61);
  PathOptions options = Options();
  for (const bool worst_first : {false, true}) {
    options.worst_first = worst_first;
    options.lift_gain = 0;
    const PassResult whole = PlanPass(problem, world, {pass}, options, {.threads = 2});
    ASSERT_EQ(whole.pieces.size(), 1u);
    EXPECT_TRUE(whole.lifts.empty());
    options.lift_gain = 0.005;
    options.max_lifts = 2;
    const PassResult lifted = PlanPass(problem, world, {pass}, options, {.threads = 1});
    ExpectSound(problem, options, pass, lifted);
    EXPECT_EQ(lifted.lifts, (std::vector<int>{1, 2}));
    EXPECT_EQ(lifted.pieces.size(), 3u);
    EXPECT_TRUE(lifted.uncut.empty());
    for (size_t t = 0; t + 1 < pass.points.size(); ++t) EXPECT_TRUE(IsCut(pass, lifted, t)) << t;
    EXPECT_GT(lifted.lift_gain, 2 * options.lift_gain);
    EXPECT_LT(SumOf(lifted), (1 - 2 * options.lift_gain) * SumOf(whole));
    if (worst_first) {
      EXPECT_LE(WorstOf(lifted), WorstOf(whole) * (1 + 1e-5));
    }
    EXPECT_EQ(HashOfValues(PlanPass(problem, world, {pass}, options, {.threads = 4})), HashOfValues(lifted));
    // Two lifts that gain 5 % together are not worth 5 % each.
    options.lift_gain = 0.05;
    const PassResult dear = PlanPass(problem, world, {pass}, options, {.threads = 2});
    EXPECT_TRUE(dear.lifts.empty());
    ASSERT_EQ(dear.points.size(), whole.points.size());
    for (size_t t = 0; t < whole.points.size(); ++t) EXPECT_EQ(dear.points[t].q, whole.points[t].q);
  }
}

}  // namespace
}  // namespace millpose
