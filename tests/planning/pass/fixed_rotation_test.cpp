// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/fixed_rotation.hpp"

#include <numeric>

#include "base/random.hpp"
#include "base/value_bytes.hpp"
#include "machine/robot/angles.hpp"
#include "machine/stiffness/compliance.hpp"
#include "planning/pass/fewest_missing.hpp"
#include "planning/pass/fixed_interference.hpp"
#include "planning/pass/pass_checks.hpp"
#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

FixedRotationOptions FixedOptions(bool worst_first) {
  const PathOptions path = Options();
  return {path.rotation_step, path.steps, path.swept_resolution, worst_first, {}, 0, 2, {}, {}};
}

/// With nothing known.
FixedComparison CompareWithFixed(const Stations& stations, const std::vector<PassResult>& passes,
                                 const FixedRotationOptions& options) {
  std::vector<FixedPass> of_passes(passes.size(), {stations, {}});
  return CompareWithFixed(stations, passes, options, of_passes);
}

/// Two rows of panel points that mill up and down in turns.
std::vector<Pass> Rows() {
  std::vector<Pass> rows{Row(-150, 150, 25, 0), Row(-150, 150, 25, 150)};
  for (Pass& row : rows)
    for (MillingPoint& point : row.points)
      point.engagement = {20 * point.feed - 10 * point.normal, 8, 1, CutSide::kUp};
  return rows;
}

std::vector<PassResult> Plan(const PoseProblem& problem, const World& world, const std::vector<Pass>& rows,
                             bool worst_first) {
  PathOptions options = Options();
  options.worst_first = worst_first;
  std::vector<PassResult> planned;
  for (size_t i = 0; i < rows.size(); ++i)
    planned.push_back(
        PlanPass(problem, world, {rows[i], static_cast<int>(i), 25 * i}, options, {.threads = 2}));
  return planned;
}

TEST(FixedRotation, APlanIsNeverWorseByItsOwnCriterion) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("surface_error", {});
  const World world(EmptyCell(problem));
  const std::vector<PassResult> planned = Plan(problem, world, Rows(), true);
  const FixedComparison found = CompareWithFixed(Stations(world, problem), planned, FixedOptions(true));
  ASSERT_EQ(found.plan.points, 50u);
  ASSERT_EQ(found.job.figures.points, 50u) << found.job_in_the_way;
  ASSERT_EQ(found.passes.figures.points, 50u) << found.passes_in_the_way;
  EXPECT_LE(found.plan.objective.worst, found.passes.figures.objective.worst * (1 + 2e-6));
  EXPECT_LE(found.passes.figures.objective.worst, found.job.figures.objective.worst);
  EXPECT_LT(found.plan.objective.sum, found.job.figures.objective.sum);
}

TEST(FixedRotation, IsTheBestOfAllThatServeEveryPoint) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("surface_error", {});
  const World world(EmptyCell(problem));
  const std::vector<Pass> rows = Rows();
  const std::vector<PassResult> planned = Plan(problem, world, rows, false);
  const FixedComparison found = CompareWithFixed(Stations(world, problem), planned, FixedOptions(true));
  double best = std::numeric_limits<double>::infinity();
  for (int r = -90; r < 90; ++r) {
    const double rotation = r * DegToRad(2);
    double job = 0;
    for (const Pass& row : rows) {
      double least = std::numeric_limits<double>::infinity();
      for (int branch = 0; branch < 8; ++branch) {
        double worst = 0;
        for (const MillingPoint& point : row.points) {
          const Candidate candidate =
              PointScorer(problem, point, row.rotation_reference).ScoreOne({rotation}, branch);
          worst = candidate.obstacle == Infeasibility::kNone ? std::max(worst, candidate.objective)
                                                             : std::numeric_limits<double>::infinity();
          if (!std::isfinite(worst)) break;
        }
        least = std::min(least, worst);
      }
      job = std::max(job, least);
    }
    best = std::min(best, job);
  }
  ASSERT_TRUE(found.job.Exists()) << found.job_in_the_way;
  EXPECT_NEAR(found.job.figures.objective.worst / best, 1, 1e-9);
  // Figures are those of the poses.
  std::vector<double> normal, length;
  for (const PassResult& pass : planned)
    for (const PlannedPoint& point : pass.points) {
      const Eigen::Matrix3d R_BW = problem.X_WB.linear().transpose();
      const Eigen::Vector3d moved =
          Compliance(Jacobian(problem.arm, point.q, problem.X_FT.translation()), problem.arm.stiffness)
              .topLeftCorner<3, 3>() *
          (R_BW * point.point.engagement.force);
      length.push_back(moved.norm());
      normal.push_back(std::abs((R_BW * point.point.normal).dot(moved)));
    }
  for (const auto& [figure, values] : {std::pair(found.plan.normal, &normal), {found.plan.length, &length}}) {
    std::ranges::sort(*values);
    EXPECT_NEAR(figure.worst, values->back(), 1e-12);
    EXPECT_NEAR(figure.median, 0.5 * (values->at(24) + values->at(25)), 1e-12);
    EXPECT_NEAR(figure.sum, std::accumulate(values->begin(), values->end(), 0.0), 1e-10);
  }
}

// Beside a plan for another objective stands what one for |cF| itself would name as the best.
TEST(FixedRotation, TheBestByLengthIsThatOfPlansForTheLength) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("surface_error", {});
  const World world(EmptyCell(problem));
  const std::vector<PassResult> planned = Plan(problem, world, Rows(), true);
  PoseProblem by_length = problem;
  by_length.objective = MakeObjective("process_force", {});
  for (const bool worst_first : {true, false}) {
    const FixedComparison found =
        CompareWithFixed(Stations(world, problem), planned, FixedOptions(worst_first));
    const FixedComparison expected =
        CompareWithFixed(Stations(world, by_length), planned, FixedOptions(worst_first));
    ASSERT_TRUE(expected.job.Exists());
    EXPECT_EQ(found.job_by_length.rotations, expected.job.rotations);
    EXPECT_EQ(found.passes_by_length.rotations, expected.passes.rotations);
    EXPECT_NE(found.job.rotations, expected.job.rotations);  // else the test would see nothing
    for (double OverPoints::*of : {&OverPoints::worst, &OverPoints::median, &OverPoints::sum})
      EXPECT_EQ(found.job_by_length.figures.length.*of, expected.job.figures.length.*of);
  }
  std::vector<Pass> idle = Rows();
  for (Pass& row : idle)
    for (MillingPoint& point : row.points) point.engagement = {};
  problem.objective = MakeObjective("normal_deflection", {});
  const FixedComparison none =
      CompareWithFixed(Stations(world, problem), Plan(problem, world, idle, true), FixedOptions(true));
  EXPECT_TRUE(none.job.Exists());
  EXPECT_FALSE(none.job_by_length.Exists());
}

/// What all rotations of the grid of 2° give a row on their branches, by their worst value and sum.
std::vector<std::pair<double, double>> WorstAndSumOfAll(const PoseProblem& problem, const Pass& row) {
  std::vector<std::pair<double, double>> all;
  for (int r = -90; r < 90; ++r)
    for (int branch = 0; branch < 8; ++branch) {
      double worst = 0, sum = 0;
      for (const MillingPoint& point : row.points) {
        const Candidate candidate =
            PointScorer(problem, point, row.rotation_reference).ScoreOne({r * DegToRad(2)}, branch);
        const bool served = candidate.obstacle == Infeasibility::kNone;
        worst = served ? std::max(worst, candidate.objective) : kInfinity;
        sum += candidate.objective;
        if (!served) break;
      }
      if (std::isfinite(worst)) all.emplace_back(worst, sum);
    }
  return all;
}

TEST(FixedRotation, TheBestBySumIsNearTheBestWorst) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("surface_error", {});
  const World world(EmptyCell(problem));
  const std::vector<Pass> rows = Rows();
  const std::vector<PassResult> planned = Plan(problem, world, rows, true);
  for (const bool worst_first : {true, false}) {
    const FixedComparison found =
        CompareWithFixed(Stations(world, problem), planned, FixedOptions(worst_first));
    double worst = 0, sum = 0;
    for (const Pass& row : rows) {
      const auto all = WorstAndSumOfAll(problem, row);
      const double least = std::ranges::min_element(all)->first;
      double best = kInfinity;
      for (const auto& [of_worst, of_sum] : all)
        if (of_worst <= 1.05 * least) best = std::min(best, of_sum);
      sum += best;
      worst = std::max(worst, least);
    }
    EXPECT_NEAR(found.passes_by_sum.figures.objective.sum / sum, 1, 1e-9);
    EXPECT_LE(found.passes_by_sum.figures.objective.worst, 1.05 * worst * (1 + 1e-12));
    EXPECT_LE(found.passes_by_sum.figures.objective.sum, found.job_by_sum.figures.objective.sum);
    if (worst_first) {
      EXPECT_LE(found.job_by_sum.figures.objective.sum, found.job.figures.objective.sum);
      EXPECT_LE(found.job_by_sum.figures.objective.worst, 1.05 * found.job.figures.objective.worst);
    }
    EXPECT_EQ(found.passes_by_sum.rotations.size(), 2u);
  }
}

/// The branch on which a rotation's worst value over a pass is least.
int BestBranch(const PoseProblem& problem, const PassResult& pass, double rotation) {
  std::pair<double, int> best{kInfinity, -1};
  for (int branch = 0; branch < 8; ++branch) {
    double worst = 0;
    for (const PlannedPoint& point : pass.points) {
      const Candidate candidate =
          PointScorer(problem, point.point, pass.rotation_reference).ScoreOne({rotation}, branch);
      worst = candidate.obstacle == Infeasibility::kNone ? std::max(worst, candidate.objective) : kInfinity;
      if (!std::isfinite(worst)) break;
    }
    best = std::min(best, {worst, branch});
  }
  return best.second;
}

TEST(FixedRotation, CountsTheJointsThatTurnBack) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("surface_error", {});
  const World world(EmptyCell(problem));
  std::vector<Pass> rows = Rows();
  for (Pass& row : rows)  // there and back: joints must turn
    for (size_t t = row.points.size() - 1; t-- > 0;) {
      const double step = row.points[1].arc_length - row.points[0].arc_length;
      row.points.push_back(row.points[t]);
      row.points.back().arc_length = (row.points.end() - 2)->arc_length + step;
    }
  const std::vector<PassResult> planned = Plan(problem, world, rows, true);
  FixedRotationOptions options = FixedOptions(true);
  options.gears.lost.width.head<6>().setConstant(DegToRad(0.005));
  std::fill_n(options.gears.known.begin(), 6, true);
  const FixedComparison found = CompareWithFixed(Stations(world, problem), planned, options);
  GearTally plan, fixed;
  for (size_t p = 0; p < planned.size(); ++p) {
    std::vector<PosedPoint> as_planned, with_fixed;
    for (const PlannedPoint& point : planned[p].points) {
      as_planned.push_back({&point.point, point.q, problem.X_WB, {}});
      const PointScorer scorer(problem, point.point, planned[p].rotation_reference);
      const Joints q = scorer
                           .ScoreOne({found.passes.rotations[p]},
                                     BestBranch(problem, planned[p], found.passes.rotations[p]))
                           .q;
      with_fixed.push_back({&point.point, q, problem.X_WB, {}});
    }
    const auto count = [&](const std::vector<PosedPoint>& places, GearTally& tally) {
      const PieceGears gears =
          FollowPiece(options.gears, {problem.arm, problem.X_FT, Mechanism()}, places, false);
      for (const GearEvent& event : gears.events) tally.turns[static_cast<size_t>(event.gear)] += event.turns;
      for (const double error : gears.errors) tally.worst = std::max(tally.worst, std::abs(error));
    };
    count(as_planned, plan);
    count(with_fixed, fixed);
  }
  EXPECT_GT(plan.Turns(), 0);
  EXPECT_GT(fixed.Turns(), 0);
  EXPECT_EQ(found.plan_gears.turns, plan.turns);
  EXPECT_DOUBLE_EQ(found.plan_gears.worst, plan.worst);
  EXPECT_EQ(found.passes.gears.turns, fixed.turns);
  EXPECT_NEAR(found.passes.gears.worst, fixed.worst, 1e-9);
}

TEST(FixedRotation, SaysWhatIsInTheWay) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const std::vector<PassResult> planned = Plan(problem, world, {Row(-60, 60, 8)}, false);
  const double middle = planned[0].points[4].q[4];
  // Axis 5 has to stay where only a few rotations bring it, and not the same ones at both ends.
  problem.bounds.lower[4] = middle - 1e-3;
  problem.bounds.upper[4] = middle + 1e-3;
  problem.bounds.lower[0] = planned[0].points[4].q[0] - 1e-3;
  problem.bounds.upper[0] = planned[0].points[4].q[0] + 1e-3;
  const FixedComparison found = CompareWithFixed(Stations(world, problem), planned, FixedOptions(false));
  EXPECT_FALSE(found.job.Exists());
  EXPECT_FALSE(found.passes.Exists());
  EXPECT_NE(found.job_in_the_way.find("points: "), std::string::npos) << found.job_in_the_way;
  EXPECT_NE(found.passes_in_the_way.find("pass 0"), std::string::npos) << found.passes_in_the_way;
}

/// A wrist, and a ball of this radius (mm) about where it is in the middle of the first row.
Cell CellWithBall(const PoseProblem& problem, const std::vector<PassResult>& planned, double radius) {
  Cell cell = EmptyCell(problem);
  Body wrist{
      .name = "wrist", .body_class = BodyClass::kLink, .mount = Mount::kLink, .link = 5, .shape = Sphere{8}};
  Body ball{
      .name = "ball", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{radius}};
  const Joints& q = planned[0].points[planned[0].points.size() / 2].q;
  ball.X_MG.translation() = (problem.X_WB * LinkFrames(problem.arm, q)[5]).translation();
  cell.bodies = {wrist, ball};
  return cell;
}

TEST(FixedRotation, WhatIsKnownOfPassesChangesNothing) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("surface_error", {});
  const std::vector<PassResult> planned = Plan(problem, World(EmptyCell(problem)), Rows(), true);
  size_t served = 0, in_the_way = 0;
  for (const double radius : {1.0, 40.0, 2000.0}) {  // mm: of few rotations, of many, of all
    const Cell cell = CellWithBall(problem, planned, radius);
    const Stations stations{World(cell), problem};
    std::vector<FixedPass> known(planned.size(), {stations, {}});
    for (const bool worst_first : {true, false, true}) {
      const std::string anew = HashOfValues(CompareWithFixed(stations, planned, FixedOptions(worst_first)));
      // Of one pass from before, of the other as it comes.
      std::vector<FixedPass> half = known;
      half[1].known = {};
      EXPECT_EQ(HashOfValues(CompareWithFixed(stations, planned, FixedOptions(worst_first), half)), anew);
      EXPECT_EQ(HashOfValues(CompareWithFixed(stations, planned, FixedOptions(worst_first), known)), anew);
    }
    // All is known by now, so that nothing is asked but what is in the way.
    const auto looks = std::make_shared<QueryLog>();
    for (FixedPass& of : known) of.stations = Stations(World(cell).Recording(looks), problem);
    const FixedComparison found = CompareWithFixed(stations, planned, FixedOptions(true), known);
    EXPECT_EQ(looks->Collected().boxes.empty(), found.job.Exists());
    ++(!found.job.Exists() ? in_the_way : served);
    const bool told = found.job_in_the_way.find("it is met at points ") != std::string::npos;
    EXPECT_EQ(told, !found.job.Exists()) << found.job_in_the_way;
  }
  EXPECT_GT(served, 0u);
  EXPECT_GT(in_the_way, 0u);
}

/// What is in the way of a rotation.
enum class Hit : uint8_t { kNone, kPose, kMotion };

Hit HitOf(const PoseProblem& problem, const World& world, const PassResult& pass, double rotation,
          int branch) {
  const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
  Checker checker(world);
  std::vector<Joints> q;
  for (const PlannedPoint& point : pass.points)
    q.push_back(PointScorer(problem, point.point, pass.rotation_reference).ScoreOne({rotation}, branch).q);
  for (const Joints& at : q)
    if (checker.Blocked(at, Phase::kCutting)) return Hit::kPose;
  for (size_t t = 1; t < q.size(); ++t)
    if (CheckCut(checker, carrier, q[t - 1], NearestEquivalent(q[t - 1], q[t]), Options().swept_resolution))
      return Hit::kMotion;
  return Hit::kNone;
}

TEST(FixedInterference, IsThatOfEveryPoseAndMotionWhateverWasLookedAtBefore) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  PathOptions far = Options();
  far.steps = {kPi, 1e9, Joints::Constant(DegToRad(30))};
  const PassResult planned =
      PlanPass(problem, World(EmptyCell(problem)), {Row(-380, 380, 20)}, far, {.threads = 2});
  const int branch = planned.points[10].branch;
  const FixedRotationOptions options = FixedOptions(false);
  std::array<int, 3> found{};
  for (const size_t at : {10, 17}) {
    // Two small balls: one stands where the wrist comes by, at a point or half-way to the next.
    Cell cell = EmptyCell(problem);
    Body wrist{.name = "wrist",
               .body_class = BodyClass::kLink,
               .mount = Mount::kLink,
               .link = 5,
               .shape = Sphere{8}};
    Body ball{.name = "ball", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{4}};
    const auto wrist_at = [&](size_t t) {
      return Eigen::Vector3d((problem.X_WB * LinkFrames(problem.arm, planned.points[t].q)[5]).translation());
    };
    ball.X_MG.translation() = at == 10 ? wrist_at(10) : Eigen::Vector3d((wrist_at(17) + wrist_at(18)) / 2);
    cell.bodies = {wrist, ball};
    const World world(cell);
    const Stations stations(world, problem);
    FixedInterference interference(stations, planned, options);
    const double plan = planned.points[at].freedoms[0];
    for (int turn = 0; turn < 2; ++turn) {
      for (int k = -12; k <= 12; ++k) {
        const double rotation = plan + DegToRad(0.5) * (turn == 0 ? k : -k);
        const Hit hit = HitOf(problem, world, planned, rotation, branch);
        EXPECT_EQ(interference.IsFree(rotation, branch), hit == Hit::kNone) << at << ' ' << k;
        ++found[static_cast<size_t>(hit)];
      }
    }
  }
  for (const int count : found) EXPECT_GT(count, 5);
}

/// Whether some branch of a rotation has a pose.
bool HasPose(const PoseProblem& problem, const PassResult& pass, size_t t, double rotation) {
  const PointScorer scorer(problem, pass.points[t].point, pass.rotation_reference);
  for (int branch = 0; branch < 8; ++branch)
    if (scorer.ScoreOne({rotation}, branch).obstacle == Infeasibility::kNone) return true;
  return false;
}

TEST(FewestMissing, IsTheFirstOfTheRotationsThatServeMost) {
  const PoseProblem wide = MakeProblem(Kr500R2830());
  const World world(EmptyCell(wide));
  const std::vector<PassResult> planned = Plan(wide, world, Rows(), false);
  const std::vector<const PassResult*> passes{&planned[0], &planned[1]};
  FixedTable grid;
  grid.rotations = 45;
  grid.first = -kPi;
  grid.step = DegToRad(8);
  RandomStream stream(51, 0);
  int none_missing = 0, some_missing = 0;
  for (int trial = 0; trial < 40; ++trial) {
    PoseProblem problem = wide;
    for (int j = 0; j < 6; ++j) {
      const double middle = planned[0].points[static_cast<size_t>(stream.Below(25))].q[j];
      problem.bounds.lower[j] = std::max(wide.bounds.lower[j], middle - stream.Uniform(0.02, 1.2));
      problem.bounds.upper[j] = std::min(wide.bounds.upper[j], middle + stream.Uniform(0.02, 1.2));
    }
    MissingPoints expected{0, std::numeric_limits<size_t>::max(), {}};
    for (size_t r = 0; r < grid.rotations; ++r) {
      MissingPoints of{r, 0, {{}, {}}};
      for (size_t pass = 0; pass < 2; ++pass)
        for (size_t t = 0; t < planned[pass].points.size(); ++t)
          if (!HasPose(problem, planned[pass], t, grid.Rotation(r)))
            ++of.count, of.of_pass[pass].push_back(t);
      if (of.count < expected.count) expected = of;
    }
    const MissingPoints found = FewestMissing(Stations(world, problem), passes, grid, 2, {});
    EXPECT_EQ(found.rotation, expected.rotation);
    EXPECT_EQ(found.count, expected.count);
    EXPECT_EQ(found.of_pass, expected.of_pass);
    ++(found.count > 0 ? some_missing : none_missing);
  }
  EXPECT_GT(none_missing, 3);
  EXPECT_GT(some_missing, 3);
}

}  // namespace
}  // namespace millpose
