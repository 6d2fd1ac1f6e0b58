// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/evaluator.hpp"
#include "tests/planning/pose/lean_problems.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

const std::array<CutterShape, 3> kCutters{{{8, 8, 40}, {8, 2, 40}, {8, 0, 40}}};

FreedomValues RandomSetting(RandomStream& random) {
  return {random.Uniform(-kPi, kPi), DegToRad(random.Uniform(1, 10)), DegToRad(random.Uniform(-10, 10))};
}

// The contact stays where it is, for every cutter, and every pose of the point knows it.
TEST(Lean, TurnsTheToolAboutItsContact) {
  for (const CutterShape& cutter : kCutters) {
    PoseProblem problem = LeaningProblem();
    problem.lean->cutter = cutter;
    RandomStream random(20, 0);
    for (int k = 0; k < 50; ++k) {
      const MillingPoint point = PanelPoint(random.Uniform(-400, 400), random.Uniform(-300, 300));
      const FreedomValues setting = RandomSetting(random);
      const MillingPoint leaned = AtLean(problem, point, setting);
      EXPECT_LT((ContactOf(problem, leaned).place - point.position).norm(), 1e-9);
      EXPECT_NEAR(leaned.tool_axis.dot(point.feed), std::sin(setting[1]), 1e-12);
      // From a leaned point on, the same.
      const FreedomValues other = RandomSetting(random);
      EXPECT_LT((AtLean(problem, leaned, other).position - AtLean(problem, point, other).position).norm(),
                1e-9);
      EXPECT_LT((Upright(problem, leaned).position - point.position).norm(), 1e-9);
    }
  }
}

// A candidate of a leaning problem is the candidate of the leaned point, whatever the objective.
TEST(Lean, CandidatesAreThoseOfTheLeanedPoint) {
  for (const char* objective : {"chen2021", "drilling", "process_force", "normal_deflection"}) {
    PoseProblem problem = LeaningProblem();
    const bool force = std::string(objective) == "process_force";
    problem.objective = MakeObjective(
        objective, force ? ObjectiveParameters{{"feed_N", 10}, {"across_N", 20}, {"axial_N", -5}}
                         : ObjectiveParameters{});
    const PoseProblem own = AtOwnAxis(problem);
    RandomStream random(21, 0);
    int admissible = 0;
    for (int k = 0; k < 40; ++k) {
      const MillingPoint point = PanelPoint(random.Uniform(-400, 400), random.Uniform(-300, 300));
      const FreedomValues setting = RandomSetting(random);
      const PointScorer leaning(problem, point, Vector3d::UnitZ()),
          leaned(own, AtLean(problem, point, setting), Vector3d::UnitZ());
      EXPECT_LT((leaning.ToolPose(setting).matrix() - leaned.ToolPose({setting[0]}).matrix()).norm(), 1e-9);
      for (int branch = 0; branch < 8; ++branch) {
        const Candidate a = leaning.ScoreOne(setting, branch), b = leaned.ScoreOne({setting[0]}, branch);
        ASSERT_EQ(a.obstacle, b.obstacle);
        if (a.obstacle != Infeasibility::kNone) continue;
        ++admissible;
        EXPECT_LT((a.q - b.q).norm(), 1e-9);
        EXPECT_NEAR(a.objective / b.objective, 1, 1e-9);
        const Pose X_WT = problem.X_WB * ForwardFlange(problem.arm, a.q) * problem.X_FT;
        EXPECT_LT((X_WT.matrix() - leaning.ToolPose(setting).matrix()).norm(), 1e-8);
      }
    }
    EXPECT_GT(admissible, 40) << objective;
  }
}

// Lanes of a block share a lean or do not: the same bits.
TEST(Lean, CandidatesDoNotDependOnTheirNeighbours) {
  PoseProblem problem = LeaningProblem();
  problem.objective = MakeObjective("drilling", {});
  const PointScorer scorer(problem, PanelPoint(100, 50), Vector3d::UnitZ());
  RandomStream random(22, 0);
  std::vector<FreedomValues> settings;
  for (int k = 0; k < 40; ++k) {
    settings.push_back(RandomSetting(random));
    for (int i = 0; i < k % 5; ++i) {
      settings.push_back(settings.back());
      settings.back()[0] = random.Uniform(-kPi, kPi);
    }
  }
  std::vector<Candidate> together(8 * settings.size());
  scorer.Score(settings, together);
  for (size_t k = 0; k < settings.size(); ++k)
    for (int branch = 0; branch < 8; ++branch) {
      const Candidate alone = scorer.ScoreOne(settings[k], branch);
      const Candidate& beside = together[8 * k + static_cast<size_t>(branch)];
      ASSERT_EQ(alone.obstacle, beside.obstacle);
      EXPECT_EQ(alone.q, beside.q);
      EXPECT_EQ(alone.objective, beside.objective);
    }
}

TEST(Lean, WhatTheLawBarsIsNoCandidate) {
  PoseProblem problem = LeaningProblem();
  problem.lean->lead = DegToRad(5);
  problem.lean->min_speed_share = 0.5;
  const PointScorer scorer(problem, PanelPoint(0, 0), Vector3d::UnitZ());
  const auto any = [&](double lead_deg, double tilt_deg) {
    std::vector<FreedomValues> settings;
    for (int k = 0; k < 36; ++k)
      settings.push_back({DegToRad(10 * k), DegToRad(lead_deg), DegToRad(tilt_deg)});
    std::vector<Candidate> candidates(8 * settings.size());
    scorer.Score(settings, candidates);
    return std::ranges::any_of(candidates,
                               [](const Candidate& c) { return c.obstacle == Infeasibility::kNone; });
  };
  EXPECT_TRUE(any(5, 0));
  EXPECT_FALSE(any(1, 0)) << "cuts too slowly";
  EXPECT_TRUE(any(0, -4));
}

TEST(CandidateTable, FollowsEachFreedomsOwnStepAboutItsNominalValue) {
  PoseProblem problem = LeaningProblem();
  problem.freedoms[1] =
      std::make_shared<Lead>(LeanRange{DegToRad(-3), DegToRad(10), DegToRad(4), DegToRad(2)});
  const PointScorer scorer(problem, PanelPoint(0, 0), Vector3d::UnitZ());
  const CandidateTable table = CandidateTable::OfStep(scorer, DegToRad(6));
  EXPECT_EQ(table.line_length(), 60);
  EXPECT_EQ(table.stride(), 5u * 5);  // leads −3, −2, 2, 6, 10; tilts −10, −5, 0, 5, 10
  EXPECT_EQ(table.At(1, 0), DegToRad(-3));
  EXPECT_EQ(table.At(1, 2), DegToRad(2));
  EXPECT_EQ(table.At(2, 2), 0);
  size_t admissible = 0;
  for (size_t k = 0; k < table.settings(); ++k)
    for (int branch = 0; branch < 8; ++branch)
      admissible += scorer.ScoreOne(table.Setting(k), branch).obstacle == Infeasibility::kNone;
  EXPECT_EQ(table.entries().size(), admissible);
  for (const CandidateTable::Entry& entry : table.entries())
    EXPECT_EQ(entry.objective, scorer.ScoreOne(table.Setting(entry.setting), entry.branch).objective);
}

/// By how much, relative, the lowest of many poses close around a place lies below it.
double LowerAround(const PointScorer& scorer, const PointOptimum& at, RandomStream& random) {
  double lower = 0;
  for (const double size : {3e-3, 1e-3, 1e-4})
    for (int i = 0; i < 100; ++i) {
      FreedomValues setting = at.freedoms;
      for (size_t d = 0; d < setting.size(); ++d)
        setting[d] = Confine(*scorer.problem().freedoms[d], setting[d] + random.Uniform(-size, size));
      const Candidate candidate = scorer.ScoreOne(setting, at.branch);
      if (candidate.obstacle == Infeasibility::kNone)
        lower = std::max(lower, 1 - candidate.objective / at.objective);
    }
  return lower;
}

// Where joints meet their limits and deflections change their sign, valleys run across all freedoms: one
// freedom after the other gets stuck there.
TEST(Descend, EndsWhereNothingAroundIsLower) {
  for (const char* objective : {"chen2021", "surface_error"}) {
    PoseProblem problem = LeaningProblem();
    const bool force = std::string(objective) == "surface_error";
    problem.objective = MakeObjective(
        objective, force ? ObjectiveParameters{{"force_uncertainty_percent", 30}, {"force_direction_deg", 20}}
                         : ObjectiveParameters{});
    RandomStream random(23, 0), around(24, 0);
    int found = 0, lower = 0;
    for (int k = 0; k < 60; ++k) {
      MillingPoint point = PanelPoint(random.Uniform(-450, 450), random.Uniform(-300, 300),
                                      random.Uniform(1500, 2200), random.Uniform(700, 1500));
      point.engagement.force = 20 * point.feed + 10 * point.normal.cross(point.feed) + 5 * point.normal;
      const PointScorer scorer(problem, point, Vector3d::UnitZ());
      const CandidateTable table = CandidateTable::OfStep(scorer, DegToRad(4));
      const PointOptimum best = DescendTable(scorer, table);
      EXPECT_EQ(best.found, !table.entries().empty());
      if (!best.found) continue;
      ++found;
      for (const CandidateTable::Entry& entry : table.entries()) EXPECT_GE(entry.objective, best.objective);
      EXPECT_EQ(scorer.ScoreOne(best.freedoms, best.branch).objective, best.objective);
      lower += LowerAround(scorer, best, around) > 1e-5;
      const PointOptimum few = Descend(scorer, best, best.evaluations + 20);
      EXPECT_LE(few.evaluations, best.evaluations + 20);
      EXPECT_LE(few.objective, best.objective);
    }
    EXPECT_GT(found, 50) << objective;
    EXPECT_LE(lower, 2) << objective;
  }
}

// With lead and tilt: what the genetic algorithm finds beyond a table refined along its lines and brought
// down in all freedoms.
TEST(GeneticSearch, FindsLeansThatTheTableDoesNotLeadTo) {
  const PoseProblem problem = LeaningProblem();
  RandomStream random(23, 0);
  double genetic = 0, table = 0, judge = 0;
  int found = 0;
  for (uint64_t k = 0; k < 30; ++k) {
    // One draw a statement: the order of arguments is the compiler's.
    const double height = random.Uniform(700, 1500), front = random.Uniform(1500, 2200);
    const double z = random.Uniform(-300, 300), y = random.Uniform(-450, 450);
    const MillingPoint point = PanelPoint(y, z, front, height);
    const PointScorer scorer(problem, point, Vector3d::UnitZ());
    const GeneticOptions options;
    const PointOptimum refined = RefineTable(scorer, CandidateTable::OfSize(scorer, options.table));
    const PointOptimum best = GeneticSearch(scorer, problem, options, RandomStream(3, k));
    const PointOptimum grid = RefineTable(scorer, CandidateTable::OfStep(scorer, DegToRad(4)));
    if (!best.found || !refined.found || !grid.found) continue;
    ++found;
    genetic += best.objective;
    table += refined.objective;
    judge += Descend(scorer, grid).objective;
    EXPECT_LE(best.evaluations, options.max_evaluations);
  }
  EXPECT_GT(found, 24);
  EXPECT_LT(genetic, 0.999 * table);
  // The judge starts from every rotation on every setting of the leans, some twenty times as many places.
  EXPECT_LT(genetic, 1.004 * judge);
}

}  // namespace
}  // namespace millpose
