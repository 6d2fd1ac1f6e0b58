// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_planner.hpp"

#include <gtest/gtest.h>

#include "base/value_bytes.hpp"
#include "machine/robot/angles.hpp"
#include "planning/pass/face_search.hpp"
#include "tests/planning/pass/pass_problem.hpp"
#include "tests/planning/pose/lean_problems.hpp"

namespace millpose {
namespace {

PoseProblem FaceProblem() {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("face_error", {});
  return problem;
}

FacePlanOptions FacesOptions() {
  FacePlanOptions options;
  options.path = Options();
  options.path.worst_first = true;
  options.gears.lost.width.head<6>().setConstant(DegToRad(0.3 / 60));
  options.gears.known.fill(true);
  return options;
}

Pass Forced(Pass pass) {
  for (MillingPoint& point : pass.points)
    point.engagement = {20 * point.feed - 10 * point.normal, 8, 1, CutSide::kUp};
  return pass;
}

PassResult Planned(const PoseProblem& problem, const World& world, const Pass& pass) {
  return PlanPass(problem, world, {pass}, FacesOptions().path, {.threads = 2});
}

/// The least worst displacement of all fixed rotations that serve a pass in an empty cell, by the gears' own
/// model.
double LeastOfFixed(const Stations& stations, const Pass& pass, const FacePlanOptions& options) {
  const PoseProblem& problem = stations.problem();
  const FaceModel model = ModelOf(stations, options.gears);
  double least = kInfinity;
  for (int r = -90; r < 90; ++r) {
    for (int branch = 0; branch < 8; ++branch) {
      std::vector<FacePlace> places;
      Joints last = Joints::Zero();
      for (const MillingPoint& point : pass.points) {
        const Candidate at =
            PointScorer(problem, point, pass.rotation_reference).ScoreOne({r * DegToRad(2)}, branch);
        if (at.obstacle != Infeasibility::kNone) break;
        const Joints q = places.empty() ? at.q : NearestEquivalent(last, at.q);
        if (!places.empty() && (q - last).cwiseAbs().maxCoeff() > DegToRad(5)) break;
        last = q;
        places.push_back(FaceAtPoint(problem, model, point, {}).At(q));
      }
      if (places.size() == pass.points.size())
        least = std::min(least, FiguresOf(options.gears.lost, places, pass.closed).worst);
    }
  }
  return least;
}

void ExpectOnItsPoints(const PoseProblem& problem, const PassResult& result) {
  for (size_t t = 0; t < result.points.size(); ++t) {
    const PlannedPoint& point = result.points[t];
    ASSERT_EQ(point.skip, Infeasibility::kNone) << t;
    const Pose X_WT = problem.X_WB * ForwardFlange(problem.arm, point.q) * problem.X_FT;
    EXPECT_LT((X_WT.translation() - point.point.position).norm(), 1e-8);
    EXPECT_LT((X_WT.linear().col(2) - point.point.tool_axis).norm(), 1e-10);
    EXPECT_TRUE(problem.bounds.Hold(point.q, 1e-12));
    const Candidate own =
        PointScorer(problem, point.point, result.rotation_reference).ScoreOne(point.freedoms, point.branch);
    EXPECT_NEAR(own.objective, point.objective, 1e-12);
    if (t == 0) continue;
    EXPECT_LE((point.q - result.points[t - 1].q).cwiseAbs().maxCoeff(), DegToRad(5) + 1e-12) << t;
  }
}

TEST(PlanFace, IsNeverWorseThanAnyFixedRotation) {
  const PoseProblem problem = FaceProblem();
  const World world(EmptyCell(problem));
  const Stations stations(world, problem);
  const FacePlanOptions options = FacesOptions();
  for (const double z : {-250.0, 150.0}) {
    const Pass pass = Forced(Row(-200, 200, 21, z));
    const PassResult before = Planned(problem, world, pass);
    const PassResult after = PlanFace(stations, before, options, {.threads = 2}).pass;
    const FaceChoiceFigures was = FacesOf(stations, options.gears, before).front();
    const FaceChoiceFigures is = FacesOf(stations, options.gears, after).front();
    EXPECT_LT(is.worst, was.worst) << z;
    EXPECT_LE(is.worst, LeastOfFixed(stations, pass, options) + 1e-12) << z;
    ExpectOnItsPoints(problem, after);
  }
}

TEST(PlanFace, LeansNeverRaiseIt) {
  PoseProblem problem = LeaningProblem();
  problem.objective = MakeObjective("face_error", {});
  const PoseProblem upright = AtOwnAxis(problem);
  const World world(EmptyCell(problem));
  FacePlanOptions options = FacesOptions();
  const Pass pass = Forced(Row(-150, 150, 16));
  const PassResult plan = Planned(problem, world, pass);
  EXPECT_FALSE(IsNominalLean(problem, plan.points[8].freedoms));
  const PassResult after = PlanFace(Stations(world, problem), plan, options, {.threads = 2}).pass;
  const PassResult without =
      PlanFace(Stations(world, upright), Planned(upright, world, pass), options, {.threads = 2}).pass;
  const auto worst = [&](const PoseProblem& of, const PassResult& result) {
    return FacesOf(Stations(world, of), options.gears, result).front().worst;
  };
  EXPECT_LE(worst(problem, after), worst(problem, plan));
  EXPECT_LE(worst(problem, after), 1.05 * worst(upright, without));  // what the search may give up
  for (const PlannedPoint& point : after.points) {
    ASSERT_EQ(point.freedoms.size(), 3u);
    const MillingPoint laid = AtNominalLean(problem, point.point);
    EXPECT_LT((AtLean(problem, laid, point.freedoms).position - point.point.position).norm(), 1e-9);
    const Pose X_WT = problem.X_WB * ForwardFlange(problem.arm, point.q) * problem.X_FT;
    EXPECT_LT((X_WT.translation() - point.point.position).norm(), 1e-8);
    EXPECT_LT((X_WT.linear().col(2) - point.point.tool_axis).norm(), 1e-9);
  }
}

TEST(PlanFace, IsTheSameForAnyThreads) {
  const PoseProblem problem = FaceProblem();
  const World world(EmptyCell(problem));
  const Stations stations(world, problem);
  const PassResult before = Planned(problem, world, Forced(Row(-100, 100, 16)));
  EXPECT_EQ(HashOfValues(PlanFace(stations, before, FacesOptions(), {.threads = 1}).pass),
            HashOfValues(PlanFace(stations, before, FacesOptions(), {.threads = 2}).pass));
}

TEST(PlanFace, GoesRoundWhatIsInTheWay) {
  const PoseProblem problem = FaceProblem();
  const FacePlanOptions options = FacesOptions();
  const Pass pass = Forced(Row(-100, 100, 16));
  const World empty(EmptyCell(problem));
  const PassResult wanted =
      PlanFace(Stations(empty, problem), Planned(problem, empty, pass), options, {.threads = 2}).pass;
  const World world(CellWithBallAt(problem, wanted, 8, 30));
  Checker checker(world);
  ASSERT_TRUE(checker.At(wanted.points[8].q, Phase::kCutting).has_value());
  const PassResult before = Planned(problem, world, pass);
  const Stations stations(world, problem);
  const PassResult after = PlanFace(stations, before, options, {.threads = 2}).pass;
  for (size_t t = 0; t < after.points.size(); ++t) {
    EXPECT_FALSE(checker.At(after.points[t].q, Phase::kCutting).has_value()) << t;
    if (t == 0) continue;
    EXPECT_FALSE(checker.Between(after.points[t - 1].q, after.points[t].q, Phase::kCutting).has_value());
  }
  const double was = FacesOf(stations, options.gears, before).front().worst;
  EXPECT_LT(FacesOf(stations, options.gears, after).front().worst, was);
}

TEST(PlanFace, ARingComesBackToItsStart) {
  const PoseProblem problem = FaceProblem();
  const World world(EmptyCell(problem));
  const Stations stations(world, problem);
  const FacePlanOptions options = FacesOptions();
  const Pass pass = Forced(Ring(150, 24));
  const PassResult before = Planned(problem, world, pass);
  ASSERT_TRUE(before.pieces.size() == 1 && before.pieces[0].closed);
  const PassResult after = PlanFace(stations, before, options, {.threads = 2}).pass;
  ExpectOnItsPoints(problem, after);
  const Joints step =
      NearestEquivalent(after.points.back().q, after.points.front().q) - after.points.back().q;
  EXPECT_LE(step.cwiseAbs().maxCoeff(), DegToRad(5) + 1e-12);
  EXPECT_LT(FacesOf(stations, options.gears, after).front().worst,
            FacesOf(stations, options.gears, before).front().worst);
}

TEST(FaceSearch, RanksFixedRotationsByWhatTheyLeave) {
  const PoseProblem problem = FaceProblem();
  const World world(EmptyCell(problem));
  const Stations stations(world, problem);
  const FacePlanOptions options = FacesOptions();
  for (const Pass& pass : {Forced(Row(-200, 200, 21)), Forced(Ring(150, 24))}) {
    const PassResult plan = Planned(problem, world, pass);
    FaceSegment segment(stations, plan, plan.pieces.at(0), options, {.threads = 2});
    const FaceSearch search(segment, 0);
    const std::vector<FaceSearch::Fixed> all = search.AllFixed();
    EXPECT_GT(all.size(), 100u);
    for (const FaceSearch::Fixed& fixed : all) {
      const std::optional<FaceCandidate> joined = search.AtFixed(fixed.at);
      ASSERT_TRUE(joined);
      EXPECT_NEAR(fixed.figures.worst, joined->figures.worst, 1e-12);
      EXPECT_NEAR(fixed.figures.middle, joined->figures.middle, 1e-12);
      EXPECT_NEAR(fixed.figures.marks, joined->figures.marks, 1e-12);
      EXPECT_EQ(fixed.figures.crossings, joined->figures.crossings);
    }
  }
}

}  // namespace
}  // namespace millpose
