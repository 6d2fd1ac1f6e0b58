// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/judge_block.hpp"
#include "planning/pose/score_along.hpp"
#include "tests/planning/pose/admissible_reference.hpp"
#include "tests/planning/pose/lean_problems.hpp"

namespace millpose {
namespace {

/// The plain way: one pose at a time from the arm's own functions, no blocks.
Candidate Reference(const PoseProblem& problem, const MillingPoint& point, double rotation, int branch) {
  const Pose X_WT = NominalToolPose(point, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(rotation, Eigen::Vector3d::UnitZ());
  const InverseResult inverse = Inverse(problem.arm, problem.X_WB.inverse() * X_WT * problem.X_FT.inverse());
  Candidate candidate;
  for (int s = 0; s < inverse.count; ++s) {
    if (inverse.solutions[s].branch != branch) continue;
    const Joints& q = inverse.solutions[s].q;
    const Eigen::Vector3d origin = problem.origin == StiffnessOrigin::kToolTip
                                       ? Eigen::Vector3d(problem.X_FT.translation())
                                       : Eigen::Vector3d::Zero();
    const Matrix6 C = Compliance(Jacobian(problem.arm, q, origin), problem.arm.stiffness);
    const auto indices =
        IndicesInPlane(C.topLeftCorner<3, 3>(), problem.X_WB.linear().transpose() * point.normal);
    candidate.objective = indices ? 0.5 * indices->lambda_t2 + 0.5 * indices->lambda_n : 1e9;
    const std::vector<Joints> within = RevolutionsWithin(problem.bounds, q);
    candidate.q = within.empty() ? q : within.front();
    candidate.obstacle =
        within.empty() ? Infeasibility::kLimit : ReferenceInfeasibility(problem, within.front());
  }
  return candidate;
}

/// A UR10e enlarged to the reach of the other arms.
Arm LargeUr() {
  Arm arm = Ur10e();
  for (double* length : {&arm.d1, &arm.dy, &arm.a2, &arm.d4, &arm.d5, &arm.d6}) *length *= 2.2;
  arm.lower.setConstant(-5);
  arm.upper.setConstant(5);
  return arm;
}

TEST(PointScorer, EqualsThePlainReference) {
  RandomStream stream(3, 1);
  int admissible = 0, reached = 0;
  for (const Arm& arm : {Kr500R2830(), Kr500R2800(), KrQuantecR2700(), Chen2021Table6(), LargeUr()}) {
    const int admissible_before = admissible;
    PoseProblem problem = MakeProblem(arm);
    problem.X_WB = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) * Eigen::Translation3d(50, 20, 400);
    problem.bounds.dexterity_min = 0.2;
    const AdmissibleBounds usual = problem.bounds;
    for (int k = 0; k < 40; ++k) {
      if (k == 20) problem.origin = StiffnessOrigin::kFlange;
      // Every bound binds at some of the points.
      problem.bounds = usual;
      if (k % 4 == 1) problem.bounds.wrist_min = 0.7;
      if (k % 4 == 2) problem.bounds.elbow_min = 0.9;
      if (k % 4 == 3) problem.bounds.shoulder_min_mm = 1800;
      // Axes that couple have less than a revolution.
      if (k % 5 == 0 && arm.family == ArmFamily::kSphericalWrist)
        problem.bounds.coupled = {{(Joints() << 0, -1, 1, 0, 0, 0).finished(), stream.Uniform(2.2, 3)},
                                  {(Joints() << 0, -0.5, 0, 0, 1, 0).finished(), stream.Uniform(0.5, 2)}};
      const MillingPoint point = PanelPoint(stream.Uniform(-700, 700), stream.Uniform(-600, 900));
      const PointScorer scorer(problem, point, Eigen::Vector3d::UnitZ());
      std::vector<FreedomValues> rotations;
      for (int i = 0; i < 13; ++i) rotations.push_back({stream.Uniform(-kPi, kPi)});
      std::vector<Candidate> candidates(8 * rotations.size());
      scorer.Score(rotations, candidates);
      for (size_t i = 0; i < rotations.size(); ++i) {
        for (int branch = 0; branch < 8; ++branch) {
          const Candidate& found = candidates[8 * i + branch];
          const Candidate expected = Reference(problem, point, rotations[i][0], branch);
          ASSERT_EQ(found.obstacle, expected.obstacle);
          if (found.obstacle == Infeasibility::kUnreachable) continue;
          ++reached;
          // Equal up to full revolutions; within the bounds when admissible.
          for (int j = 0; j < 6; ++j) {
            EXPECT_NEAR(std::remainder(found.q[j] - expected.q[j], 2 * kPi), 0, 1e-9);
          }
          EXPECT_EQ(found.shortfall == 0, found.obstacle == Infeasibility::kNone);
          if (found.obstacle != Infeasibility::kNone) continue;
          ++admissible;
          EXPECT_NEAR(found.objective / expected.objective, 1, 1e-9);
          EXPECT_EQ(ReferenceInfeasibility(problem, found.q), Infeasibility::kNone);
          const Pose X_WT = problem.X_WB * ForwardFlange(arm, found.q) * problem.X_FT;
          EXPECT_LT((X_WT.matrix() - scorer.ToolPose(rotations[i]).matrix()).norm(), 1e-8);
        }
      }
    }
    EXPECT_GT(admissible, admissible_before + 100) << arm.name;
  }
  EXPECT_GT(reached, 3 * admissible);
}

// Turning the cell and the point together changes nothing for the arm: normal, feed and tool axis reach the
// objective in the arm's own frame.
TEST(PointScorer, TheWorldsDirectionsDoNotMatter) {
  const Pose turn = Eigen::Translation3d(300, -200, 100) *
                    Pose(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()));
  const std::map<std::string, ObjectiveParameters> objectives{
      {"normal_deflection", {}},
      {"drilling", {}},
      {"process_force", {{"feed_N", 30}, {"across_N", 50}, {"axial_N", -7}}}};
  for (const auto& [name, parameters] : objectives) {
    PoseProblem problem = MakeProblem(Kr500R2830());
    problem.objective = MakeObjective(name, parameters);
    MillingPoint point = PanelPoint(100, 50);
    point.tool_axis = (point.normal + 0.3 * point.feed).normalized();
    const PointScorer here(problem, point, Eigen::Vector3d::UnitZ());
    PoseProblem turned = MakeProblem(Kr500R2830());
    turned.objective = MakeObjective(name, parameters);
    turned.X_WB = turn * problem.X_WB;
    MillingPoint there = point;
    there.position = turn * point.position;
    for (Eigen::Vector3d* v : {&there.normal, &there.feed, &there.tool_axis}) *v = turn.linear() * *v;
    const PointScorer elsewhere(turned, there, turn.linear() * Eigen::Vector3d::UnitZ());
    int compared = 0;
    for (int i = 0; i < 24; ++i) {
      for (int branch = 0; branch < 8; ++branch) {
        const Candidate a = here.ScoreOne({DegToRad(15.0 * i - 180)}, branch);
        const Candidate b = elsewhere.ScoreOne({DegToRad(15.0 * i - 180)}, branch);
        if (a.obstacle != Infeasibility::kNone || b.obstacle != a.obstacle) continue;
        ++compared;
        EXPECT_NEAR(b.objective / a.objective, 1, 1e-9) << name;
      }
    }
    EXPECT_GT(compared, 5) << name;
  }
}

TEST(PointScorer, AnEntryDoesNotDependOnItsNeighbours) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(100, 50), Eigen::Vector3d::UnitZ());
  std::vector<FreedomValues> rotations;
  for (int i = 0; i < 19; ++i) rotations.push_back({-3 + 0.31 * i});
  std::vector<Candidate> together(8 * rotations.size()), alone(8);
  scorer.Score(rotations, together);
  for (size_t i = 0; i < rotations.size(); ++i) {
    scorer.Score(std::span(&rotations[i], 1), alone);
    for (int branch = 0; branch < 8; ++branch) {
      const Candidate& a = together[8 * i + branch];
      for (const Candidate& b : {alone[branch], scorer.ScoreOne(rotations[i], branch)}) {
        EXPECT_EQ(a.obstacle, b.obstacle);
        EXPECT_EQ(a.objective, b.objective);
        EXPECT_EQ(a.q, b.q);
      }
    }
  }
}

TEST(ScoreAlong, GivesWhatEachSettingGivesAlone) {
  for (const PoseProblem& problem : {MakeProblem(Kr500R2830()), LeaningProblem()}) {
    const PointScorer scorer(problem, PanelPoint(100, 50), Eigen::Vector3d::UnitZ());
    FreedomValues freedoms(problem.freedoms.size(), 0.05);
    for (size_t d = 0; d < freedoms.size(); ++d) {
      for (int branch = 0; branch < 8; ++branch) {
        std::array<double, kLanes> values;
        for (size_t l = 0; l < kLanes; ++l) values[l] = freedoms[d] + 0.03 * static_cast<double>(l);
        const std::array<Candidate, kLanes> together = ScoreAlong(scorer, freedoms, d, values, branch);
        for (size_t l = 0; l < kLanes; ++l) {
          FreedomValues setting = freedoms;
          setting[d] = values[l];
          const Candidate alone = scorer.ScoreOne(setting, branch);
          EXPECT_EQ(together[l].obstacle, alone.obstacle);
          EXPECT_EQ(together[l].objective, alone.objective);
          EXPECT_EQ(together[l].q, alone.q);
        }
      }
    }
  }
}

TEST(PointScorer, FullTurnsBringAJointWithinItsLimits) {
  PoseProblem problem = MakeProblem(Kr500R2830(), 0);
  problem.bounds.lower[3] = DegToRad(190);  // only reached by a turn more than principal
  problem.bounds.upper[3] = DegToRad(350);
  const PointScorer scorer(problem, PanelPoint(0, 0), Eigen::Vector3d::UnitZ());
  int admissible = 0;
  for (double rotation = -3; rotation < 3; rotation += 0.01) {
    for (int branch = 0; branch < 8; ++branch) {
      const Candidate candidate = scorer.ScoreOne({rotation}, branch);
      if (candidate.obstacle != Infeasibility::kNone) continue;
      ++admissible;
      EXPECT_GE(candidate.q[3], DegToRad(190));
      EXPECT_LE(candidate.q[3], DegToRad(350));
    }
  }
  EXPECT_GT(admissible, 20);
}

TEST(PointScorer, CountsCompliancesBesideTheJointsOnEveryBranch) {
  for (const int link : {0, 3, 4, 5, 6}) {
    PoseProblem problem = MakeProblem(Kr500R2830());
    problem.bounds.lower[3] = problem.bounds.lower[5] = -6;
    problem.bounds.upper[3] = problem.bounds.upper[5] = 6;
    SeriesCompliance element;
    element.link = link;
    element.X_LK.translation() = Eigen::Vector3d(20, 30, 60);
    element.X_LK.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    element.C.diagonal() << 1e-4, 2e-4, 5e-5, 1e-9, 2e-9, 3e-9;
    problem.compliances = {element};
    problem.objective = MakeObjective("normal_deflection", {});
    const MillingPoint point = PanelPoint(100, 50);
    const PointScorer scorer(problem, point, Eigen::Vector3d::UnitZ());
    int both_wrists = 0;
    double apart = 0, least = 1;
    for (double rotation = -3; rotation < 3; rotation += 0.1) {
      std::array<double, 8> value{};
      for (int branch = 0; branch < 8; ++branch) {
        const Candidate found = scorer.ScoreOne({rotation}, branch);
        if (found.obstacle != Infeasibility::kNone) continue;
        value[branch] = found.objective;
        least = std::min(least, found.objective);
        const Eigen::Vector3d tip = problem.X_FT.translation();
        const Matrix6 C = Compliance(Jacobian(problem.arm, found.q, tip), problem.arm.stiffness) +
                          SeriesComplianceAt(problem.arm, found.q, tip, problem.compliances);
        const Eigen::Vector3d n = problem.X_WB.linear().transpose() * point.normal;
        EXPECT_NEAR(found.objective / n.dot(C.topLeftCorner<3, 3>() * n), 1, 1e-9);
      }
      for (int arm = 0; arm < 4; ++arm) {
        if (value[arm] == 0 || value[arm + 4] == 0) continue;
        ++both_wrists;
        apart = std::max(apart, std::abs(value[arm] / value[arm + 4] - 1));
      }
    }
    EXPECT_GT(both_wrists, 10);
    if (link != 5) {  // of link 4 the wrist flips turn the frame; this tool hides what they do to link 5's
      EXPECT_EQ(apart > 1e-9, link == 4) << link << ' ' << apart;
    }
    const PointOptimum exhaustive = ExhaustiveSearch(scorer, DegToRad(0.25)),
                       genetic = GeneticSearch(scorer, problem, {}, RandomStream(1, 0));
    EXPECT_LE(exhaustive.objective, least * (1 + 1e-12));
    EXPECT_NEAR(genetic.objective / exhaustive.objective, 1, 1e-3) << link;
  }
}

/// The predicate's answer for the pose that the angles `q` give, on their own branch.
Infeasibility AtJoints(const PoseProblem& problem, const Joints& q) {
  FlangeBlock flange;
  for (int l = 0; l < kLanes; ++l) flange.Set(l, ForwardFlange(problem.arm, q));
  ArmBranches solved;
  InverseBlock(problem.arm, flange, solved);
  const int branch = Status(problem.arm, q), entry = branch % EntryCount(problem.arm);
  CheckedBranch checked;
  CheckAdmissible(problem, flange, solved[static_cast<size_t>(entry)], checked);
  return (branch == entry ? checked.unflipped : checked.flipped).obstacle[0];
}

TEST(CheckAdmissible, SaysWhatIsMissed) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  const auto expect = [&](const Joints& q, Infeasibility obstacle) {
    EXPECT_EQ(AtJoints(problem, q), obstacle) << q.transpose();
    EXPECT_EQ(ReferenceInfeasibility(problem, q), obstacle) << q.transpose();
  };
  expect(Degrees(0, -90, 90, 0, 45, 0), Infeasibility::kNone);
  expect(Degrees(0, -90, 90, 0, 117.5, 0), Infeasibility::kLimit);    // margin
  expect(Degrees(0, -90, 90, 0, 2, 0), Infeasibility::kSingular);     // wrist
  expect(Degrees(0, -90, -3.5, 0, 45, 0), Infeasibility::kSingular);  // elbow
  expect(Degrees(0, -90, -99, 0, 2, 0), Infeasibility::kLimit);       // limits before singularities
  problem.bounds.dexterity_min = 0.9;
  expect(Degrees(0, -90, 90, 0, 45, 0), Infeasibility::kSingular);
}

// Every bound alone, moved to where the pose is: a little below it the pose is admissible, a little above
// not.
TEST(CheckAdmissible, EveryBoundIsWhereTheReferenceMeasuresIt) {
  constexpr double kLittle = 1e-6;
  RandomStream stream(5, 2);
  for (const Arm& arm : {Kr500R2830(), OddArm(), DoosanM1013(), LargeUr()}) {
    PoseProblem problem = MakeProblem(arm, 0);
    for (int k = 0; k < 20; ++k) {
      Joints q;
      for (int j = 0; j < 6; ++j) q[j] = stream.Uniform(arm.lower[j], arm.upper[j]);
      const SingularityDistance distance = MeasuredDistance(arm, q);
      const auto at = [&](double AdmissibleBounds::*bound, double value) {
        problem.bounds = {arm.lower, arm.upper};
        problem.bounds.*bound = value;
        return AtJoints(problem, q);
      };
      const std::tuple<double AdmissibleBounds::*, double, double> bounds[] = {
          {&AdmissibleBounds::wrist_min, distance.wrist, kLittle},
          {&AdmissibleBounds::elbow_min, distance.elbow, kLittle},
          {&AdmissibleBounds::shoulder_min_mm, distance.shoulder, 1e3 * kLittle},
          {&AdmissibleBounds::dexterity_min, MeasuredDexterity(problem, q), kLittle}};
      for (const auto& [bound, value, little] : bounds) {
        EXPECT_EQ(at(bound, value - little), Infeasibility::kNone) << arm.name << ' ' << q.transpose();
        EXPECT_EQ(at(bound, value + little), Infeasibility::kSingular) << arm.name << ' ' << q.transpose();
      }
      for (int j = 0; j < 6; ++j) {
        problem.bounds = {arm.lower, arm.upper};
        problem.bounds.upper[j] = q[j] - kLittle;
        problem.bounds.lower[j] = q[j] - kPi;  // no revolution brings it back
        EXPECT_EQ(AtJoints(problem, q), Infeasibility::kLimit) << arm.name << ' ' << j;
        problem.bounds.upper[j] = q[j] + kLittle;
        EXPECT_EQ(AtJoints(problem, q), Infeasibility::kNone) << arm.name << ' ' << j;
      }
    }
  }
}

}  // namespace
}  // namespace millpose
