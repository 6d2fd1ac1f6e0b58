// SPDX-License-Identifier: GPL-3.0-or-later
// What the axis map and the sentences on a pose say of a pass with something in its way.
#include "report/samples/axis_map.hpp"

#include "report/samples/sample_curves.hpp"
#include "run/pipeline/commands/explain_pose.hpp"
#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

constexpr size_t kMet = 12;  // the point whose best pose the ball is in the way of

struct BallScene {
  PoseProblem problem = MakeProblem(Kr500R2830());
  std::optional<World> world;
  PlanResult plan;
  std::vector<PointCurves> curves;
};

const BallScene& BehindABall() {
  static const BallScene planned = [] {
    BallScene p;
    const Pass pass = Row(-60, 60, 24);
    const PassResult before =
        PlanPass(p.problem, World(EmptyCell(p.problem)), {pass}, Options(), {.threads = 2});
    p.world.emplace(CellWithBallAt(p.problem, before, kMet, 30));
    p.plan.objective_unit = p.problem.objective->Unit();
    p.plan.passes = {PlanPass(p.problem, *p.world, {pass}, Options(), {.threads = 2})};
    p.curves = SampleCurves(p.plan, Stations(*p.world, p.problem), {}, 100, {.threads = 2});
    return p;
  }();
  return planned;
}

AxisMap Map(bool full, int threads) {
  const BallScene& p = BehindABall();
  return MakeAxisMap(p.plan, Stations(*p.world, p.problem), p.curves, full, {.threads = threads});
}

TEST(AxisMap, ZonesAreTheVerdictsOfThePosesThemselves) {
  const BallScene& p = BehindABall();
  const AxisMap known = Map(false, 2), full = Map(true, 2);
  EXPECT_FALSE(known.full);
  ASSERT_EQ(full.zones.size(), 24u);
  ASSERT_EQ(known.pairs, std::vector<std::string>{"ball and wrist"});
  int unchecked = 0, free = 0, met = 0;
  Checker checker(*p.world);
  for (size_t k = 0; k < full.zones.size(); ++k) {
    const PointScorer scorer(p.problem, p.plan.passes[0].points[k].point,
                             p.plan.passes[0].rotation_reference);
    for (size_t i = 0; i < full.zones[k].size(); i += 7) {
      const uint8_t zone = full.zones[k][i];
      const double rotation = CurveGrid().first + static_cast<double>(i % 120) * CurveGrid().step;
      const Candidate candidate = scorer.ScoreOne({rotation}, static_cast<int>(i / 120));
      EXPECT_EQ(zone >= kUncheckedZone, candidate.obstacle == Infeasibility::kNone);
      EXPECT_EQ(zone == kSingularZone, candidate.obstacle == Infeasibility::kSingular);
      EXPECT_NE(zone, kUncheckedZone) << "all was asked for";
      if (zone < kUncheckedZone) continue;
      // What the search learned is of a candidate up to half a step away.
      const bool is_known = known.zones[k][i] != kUncheckedZone;
      EXPECT_TRUE(!is_known || zone == known.zones[k][i]);
      bool found = false;
      for (const double off : {0.0, -0.5, 0.5, -1.0, 1.0, -1.5, 1.5}) {
        if (off != 0 && !is_known) break;
        const Candidate near = scorer.ScoreOne({rotation + DegToRad(off)}, static_cast<int>(i / 120));
        found = found || checker.Blocked(near.q, Phase::kCutting).has_value() == (zone == kPairZone);
      }
      EXPECT_TRUE(found) << k << " at " << RadToDeg(rotation);
      unchecked += known.zones[k][i] == kUncheckedZone;
      free += known.zones[k][i] == kFreeZone;
      met += known.zones[k][i] == kPairZone;
    }
  }
  EXPECT_GT(unchecked, 3 * (free + met)) << "the search looks at little";
  EXPECT_GT(met, 0);
}

TEST(AxisMap, IsTheSameForAnyNumberOfThreads) {
  for (const bool full : {false, true}) {
    const AxisMap one = Map(full, 1), four = Map(full, 4);
    EXPECT_EQ(one.zones, four.zones);
    EXPECT_EQ(one.pairs, four.pairs);
  }
}

TEST(AxisMap, TheLimitIsThatOfTheAxisFarthestBeyondIt) {
  AdmissibleBounds bounds;
  bounds.lower.setConstant(-1);
  bounds.upper.setConstant(1);
  Joints q = Joints::Zero();
  EXPECT_EQ(FarthestBeyond(bounds, q).by, 0);
  q[3] = 1.25;
  q[1] = 2 * kPi - 0.5;  // a full revolution away from what is allowed
  EXPECT_EQ(FarthestBeyond(bounds, q).joint, 3);
  EXPECT_NEAR(FarthestBeyond(bounds, q).by, 0.25, 1e-12);
}

TEST(ExplainPose, NamesWhatBarsTheOptimum) {
  const BallScene& p = BehindABall();
  const PoseReason reason = ExplainPose(p.plan, Stations(*p.world, p.problem), 0, kMet);
  EXPECT_EQ(reason.barred, "ball and wrist");
  EXPECT_GT(reason.beyond, 0);
  EXPECT_GT(reason.path.objective, reason.own.objective);
  EXPECT_GE(reason.path.objective, reason.free.objective);
  const std::vector<std::string> sentences = ReasonSentences(reason);
  EXPECT_TRUE(std::ranges::any_of(sentences, [](const std::string& sentence) {
    return sentence.find("deg beyond where ball and wrist come too near") != std::string::npos;
  })) << fmt::format("{}", fmt::join(sentences, "\n"));
}

TEST(ExplainPose, SkippedPointsSayWhy) {
  BallScene p = BehindABall();
  p.plan.passes[0].points[3].skip = Infeasibility::kLimit;
  p.plan.passes[0].points[3].detail = "every pose is beyond a limit";
  EXPECT_EQ(ReasonSentences(ExplainPose(p.plan, Stations(*p.world, p.problem), 0, 3)),
            std::vector<std::string>{"skipped: limit: every pose is beyond a limit"});
}

}  // namespace
}  // namespace millpose
