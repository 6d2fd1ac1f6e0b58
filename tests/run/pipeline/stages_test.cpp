// SPDX-License-Identifier: GPL-3.0-or-later
// What surrounds a plan: measured forces, reach, curves, starts of single pieces, times.
#include "run/pipeline/stages/stages.hpp"

#include <thread>

#include "job/assemble.hpp"
#include "job/measured_forces.hpp"
#include "planning/links/job_planner.hpp"
#include "planning/result/point_clearance.hpp"
#include "planning/result/verdict_map.hpp"
#include "report/samples/axis_map.hpp"
#include "report/samples/sample_curves.hpp"
#include "run/pipeline/commands/explain_pose.hpp"
#include "run/pipeline/commands/find_reach.hpp"
#include "run/pipeline/programs/plan_timeline.hpp"
#include "tests/base/refusal.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

constexpr const char* kForceColumns = "point,x_mm,y_mm,z_mm,force_x_N,force_y_N,force_z_N\n";

/// A row for every point of the small plan, the force i, 2i, 3i N at point i.
std::vector<std::string> ForceRows() {
  std::vector<std::string> rows;
  for (const PassResult& pass : FreshPlan().plan.passes)
    for (const PlannedPoint& point : pass.points) {
      const Eigen::Vector3d& p = point.point.position;
      const size_t i = rows.size();
      rows.push_back(fmt::format("{},{},{},{},{},{},{}\n", i, p.x(), p.y(), p.z(), i, 2 * i, 3 * i));
    }
  return rows;
}

PointForces ReadForces(const std::vector<std::string>& rows) {
  JobInputs inputs;
  inputs.job.force_file = "forces.csv";
  inputs.force_bytes = kForceColumns + fmt::format("{}", fmt::join(rows, ""));
  return ReadMeasuredForces(inputs, FreshPlan().plan);
}

TEST(MeasuredForces, AreTurnedFromThePartIntoTheWorldWhateverTheRowsOrder) {
  std::vector<std::string> rows = ForceRows();
  std::ranges::reverse(rows);
  const PointForces forces = ReadForces(rows);
  ASSERT_EQ(forces.size(), FreshPlan().plan.passes.size());
  size_t number = 0;
  for (const auto& pass : forces)
    for (const Eigen::Vector3d& force : pass) {
      const double i = static_cast<double>(number++);
      EXPECT_LT((force - FreshPlan().plan.X_WP.linear() * Eigen::Vector3d(i, 2 * i, 3 * i)).norm(), 1e-12);
    }
  EXPECT_EQ(number, 6u);
}

TEST(MeasuredForces, OfAnotherPlanOrIncompleteAreRefusedRowByRow) {
  const auto refused = [](const std::function<void(std::vector<std::string>&)>& change) {
    std::vector<std::string> rows = ForceRows();
    change(rows);
    return RefusalOf([&] { ReadForces(rows); });
  };
  EXPECT_EQ(refused([](auto&) {}), "accepted");
  EXPECT_EQ(refused([](auto& rows) { rows.erase(rows.begin() + 2); }),
            "forces.csv: point 2 is cut and has no row");
  EXPECT_EQ(refused([](auto& rows) { rows.push_back(rows[4]); }), "forces.csv:8: point 4 is given twice");
  EXPECT_EQ(refused([](auto& rows) { rows[0] = "6" + rows[0].substr(1); }),
            "forces.csv:2: point: given 6; allowed: 0 to 5, the points of this plan\n"
            "forces.csv: point 0 is cut and has no row");
  EXPECT_TRUE(refused([](auto& rows) {
                rows[1] = "2" + rows[1].substr(1);
              }).starts_with("forces.csv:3: point 2 of this plan is "));
  EXPECT_NE(refused([](auto& rows) {
              rows[3].replace(rows[3].rfind(','), std::string::npos, ",2e6\n");
            }).find("forces.csv:5: a force of 2e+06 N; allowed: up to 1000000 N"),
            std::string::npos);
}

TEST(FindReach, SaysTheBestThatAnyRotationAndBranchGives) {
  const PreparedJob& prepared = FreshPlan().prepared;
  const double step = DegToRad(10);
  const std::vector<PointReach> reach = FindReach(prepared, step, {.threads = 2});
  size_t number = 0;
  for (const Pass& pass : prepared.toolpath.passes)
    for (const MillingPoint& point : pass.points) {
      const PointScorer scorer(prepared.problem, point, pass.rotation_reference);
      const PointReach& found = reach[number++];
      ASSERT_EQ(found.best, Infeasibility::kNone);
      double most = -10;
      for (int i = 0; i < 36; ++i)
        for (int branch = 0; branch < 8; ++branch) {
          const Candidate candidate = scorer.ScoreOne({i * step}, branch);
          if (candidate.obstacle != Infeasibility::kNone) continue;
          const Joints room = (candidate.q - prepared.problem.bounds.lower)
                                  .cwiseMin(prepared.problem.bounds.upper - candidate.q);
          most = std::max(most, room.minCoeff());
        }
      EXPECT_NEAR(found.reserve, most, 1e-9);
      const AdmissibleBounds& bounds = prepared.problem.bounds;
      EXPECT_NEAR(std::min(found.q[found.axis] - bounds.lower[found.axis],
                           bounds.upper[found.axis] - found.q[found.axis]),
                  found.reserve, 1e-9);
    }
  EXPECT_EQ(number, reach.size());
  const std::vector<PointReach> alone = FindReach(prepared, step, {.threads = 1});
  for (size_t i = 0; i < reach.size(); ++i) EXPECT_EQ(reach[i].q, alone[i].q);
}

TEST(FindReach, TellsWhatForbidsAPointThatHasNoPose) {
  PreparedJob prepared = FreshPlan().prepared;
  prepared.toolpath.passes.resize(1);
  prepared.toolpath.passes[0].points[0].position.x() += 10000;
  const auto with = [&](const std::function<void(AdmissibleBounds&)>& change) {
    PoseProblem problem = FreshPlan().prepared.problem;
    change(problem.bounds);
    prepared.stations = Stations(prepared.world, problem);
    return FindReach(prepared, DegToRad(10), {.threads = 1});
  };
  std::vector<PointReach> reach = with([](AdmissibleBounds&) {});
  EXPECT_EQ(reach[0].best, Infeasibility::kUnreachable);
  EXPECT_EQ(reach[0].axis, -1);
  EXPECT_EQ(reach[1].best, Infeasibility::kNone);
  reach = with([](AdmissibleBounds& bounds) { bounds.upper[1] = bounds.lower[1] + DegToRad(5); });
  EXPECT_EQ(reach[1].best, Infeasibility::kLimit);
  EXPECT_EQ(reach[1].axis, 1);
  EXPECT_LT(reach[1].reserve, 0);
  EXPECT_EQ(with([](AdmissibleBounds& bounds) { bounds.wrist_min = 1; })[1].best, Infeasibility::kSingular);
}

TEST(PlannedPoint, NearestPairIsThatOfItsPose) {
  const PlannedJob& job = FreshPlan();
  Checker checker(job.prepared.world);
  size_t named = 0;
  for (const PassResult& pass : job.plan.passes)
    for (const PlannedPoint& point : pass.points) {
      const auto found = checker.Nearest(point.q, Phase::kCutting, kPointClearanceBound);
      ASSERT_EQ(point.nearest.has_value(), found.has_value());
      EXPECT_EQ(point.clearance, found ? found->distance : kPointClearanceBound);
      if (!found) continue;
      EXPECT_EQ(pass.bodies.at(static_cast<size_t>(point.nearest->first)), found->first);
      EXPECT_EQ(pass.bodies.at(static_cast<size_t>(point.nearest->second)), found->second);
      EXPECT_EQ(point.nearest->first_end, found->ends[0]);
      EXPECT_EQ(point.nearest->second_end, found->ends[1]);
      ++named;
    }
  EXPECT_GT(named, 0u);
}

TEST(SampleCurves, HoldEveryPoseOfTheGridAsTheScorerHasIt) {
  const PlannedJob& job = FreshPlan();
  const RotationGrid grid = CurveGrid();
  EXPECT_EQ(grid.count, kAxisRotations);
  EXPECT_DOUBLE_EQ(grid.first, -kPi);
  const GeneticOptions genetic = SmallInputs().job.path.genetic;
  const std::vector<PointCurves> curves =
      SampleCurves(job.plan, job.prepared.stations, genetic, 100, {.threads = 2});
  ASSERT_EQ(curves.size(), 6u);
  for (const PointCurves& curve : curves) {
    const PassResult& pass = job.plan.passes[static_cast<size_t>(curve.pass)];
    const PlannedPoint& point = pass.points[static_cast<size_t>(curve.point)];
    const PointScorer scorer(job.prepared.problem, point.point, pass.rotation_reference);
    for (int i = 0; i < grid.count; i += 11)
      for (int branch = 0; branch < 8; ++branch) {
        const Candidate candidate = scorer.ScoreOne({grid.first + i * grid.step}, branch);
        const auto at = static_cast<size_t>(i), on = static_cast<size_t>(branch);
        EXPECT_EQ(curve.state[at][on], candidate.obstacle);
        if (candidate.obstacle == Infeasibility::kNone) {
          EXPECT_EQ(curve.objective[at][on], candidate.objective);
        }
        if (candidate.obstacle == Infeasibility::kUnreachable) {
          EXPECT_TRUE(std::isinf(curve.objective[at][on]));
        }
      }
    ASSERT_FALSE(curve.best.empty());
    EXPECT_TRUE(std::ranges::is_sorted(curve.best, std::greater<>())) << "elitism";
    EXPECT_GE(curve.best.back() * (1 + 1e-12), point.genetic_optimum);
    // Also where every pose is as good as any other and the optimum is 0.
    EXPECT_TRUE(std::isfinite(curve.mean.back()));
  }
  const auto alone = SampleCurves(job.plan, job.prepared.stations, genetic, 100, {.threads = 1});
  for (size_t i = 0; i < curves.size(); ++i) EXPECT_EQ(curves[i].objective, alone[i].objective);
}

TEST(SampleCurves, OfManyPointsTheWorstAreAmongThoseKept) {
  const PlannedJob& job = FreshPlan();
  PlanResult plan = job.plan;
  plan.passes[1].points[1].objective = 10;
  const std::vector<PointCurves> curves =
      SampleCurves(plan, job.prepared.stations, SmallInputs().job.path.genetic, 4, {.threads = 2});
  EXPECT_LE(curves.size(), 4u);
  EXPECT_TRUE(std::ranges::any_of(curves, [](const PointCurves& c) { return c.pass == 1 && c.point == 1; }));
}

TEST(WithoutBounds, EveryReachedPoseHasAnObjective) {
  const PlannedJob& job = FreshPlan();
  const PoseProblem free = WithoutBounds(job.prepared.problem);
  const Pass& pass = job.prepared.toolpath.passes[0];
  const PointScorer bounded(job.prepared.problem, pass.points[0], pass.rotation_reference),
      unbounded(free, pass.points[0], pass.rotation_reference);
  int forbidden = 0;
  for (double rotation = -3; rotation < 3; rotation += 0.2)
    for (int branch = 0; branch < 8; ++branch) {
      const Candidate a = bounded.ScoreOne({rotation}, branch), b = unbounded.ScoreOne({rotation}, branch);
      EXPECT_EQ(a.obstacle == Infeasibility::kUnreachable, b.obstacle == Infeasibility::kUnreachable);
      if (a.obstacle == Infeasibility::kNone) {
        EXPECT_EQ(a.objective, b.objective);
      }
      forbidden += a.obstacle == Infeasibility::kLimit && b.obstacle == Infeasibility::kNone ? 1 : 0;
    }
  EXPECT_GT(forbidden, 10);
}

TEST(AxisMap, SaysOfEveryPoseWhatForbidsIt) {
  const PlannedJob& job = FreshPlan();
  const auto curves =
      SampleCurves(job.plan, job.prepared.stations, SmallInputs().job.path.genetic, 100, {.threads = 2});
  const AxisMap known = MakeAxisMap(job.plan, job.prepared.stations, curves, false, {.threads = 2}),
                full = MakeAxisMap(job.plan, job.prepared.stations, curves, true, {.threads = 2});
  EXPECT_TRUE(full.full && !known.full);
  int on_path = 0;
  for (size_t k = 0; k < curves.size(); ++k) {
    const PassResult& pass = job.plan.passes[static_cast<size_t>(curves[k].pass)];
    const PlannedPoint& point = pass.points[static_cast<size_t>(curves[k].point)];
    const PointScorer scorer(job.prepared.problem, point.point, pass.rotation_reference);
    for (size_t i = 0; i < kAxisRotations; i += 7)
      for (size_t branch = 0; branch < 8; ++branch) {
        const Candidate candidate = scorer.ScoreOne(
            {CurveGrid().first + static_cast<double>(i) * CurveGrid().step}, static_cast<int>(branch));
        const uint8_t zone = full.zones[k][branch * kAxisRotations + i];
        switch (candidate.obstacle) {
          case Infeasibility::kUnreachable:
            EXPECT_EQ(zone, kOutOfReach);
            break;
          case Infeasibility::kSingular:
            EXPECT_EQ(zone, kSingularZone);
            break;
          case Infeasibility::kLimit:
            EXPECT_EQ(zone, kLimitZone + FarthestBeyond(job.prepared.problem.bounds, candidate.q).joint);
            break;
          default:
            EXPECT_NE(zone, kUncheckedZone);
            EXPECT_GE(zone, kFreeZone);
            break;
        }
      }
    // The rotation of the cell that the path is in may be beyond a limit that the path keeps.
    const auto cell = static_cast<size_t>(AxisCellOf(point.freedoms[0]).index);
    const Candidate there =
        scorer.ScoreOne({CurveGrid().first + static_cast<double>(cell) * CurveGrid().step}, point.branch);
    const uint8_t zone = known.zones[k][static_cast<size_t>(point.branch) * kAxisRotations + cell];
    EXPECT_EQ(zone == kFreeZone, there.obstacle == Infeasibility::kNone) << "where the path is";
    on_path += zone == kFreeZone ? 1 : 0;
  }
  EXPECT_GE(on_path, 1);
}

TEST(ExplainPose, NamesThePathAndTheStiffestPoseThatIsForbidden) {
  const PlannedJob& job = FreshPlan();
  const double scale = 1000;  // µm for mm
  for (size_t p = 0; p < job.plan.passes.size(); ++p)
    for (size_t i = 0; i < job.plan.passes[p].points.size(); ++i) {
      const PlannedPoint& point = job.plan.passes[p].points[i];
      const PoseReason reason = ExplainPose(job.plan, job.prepared.stations, p, i);
      EXPECT_EQ(reason.skipped, "");
      EXPECT_EQ(reason.path.branch, point.branch);
      EXPECT_EQ(reason.path.rotation, point.freedoms[0]);
      EXPECT_NEAR(reason.path.objective, scale * point.objective, 1e-12);
      EXPECT_LE(reason.own.objective, reason.path.objective * (1 + 1e-9));
      EXPECT_FALSE(ReasonSentences(reason).empty());
      if (!reason.forbidden) continue;
      const PointScorer scorer(job.prepared.problem, point.point, job.plan.passes[p].rotation_reference);
      EXPECT_NE(scorer.ScoreOne({reason.forbidden->pose.rotation}, reason.forbidden->pose.branch).obstacle,
                Infeasibility::kNone);
    }
  PlanResult skipped = job.plan;
  skipped.passes[0].points[0].skip = Infeasibility::kGouge;
  skipped.passes[0].points[0].detail = "3 mm deep";
  EXPECT_EQ(ExplainPose(skipped, job.prepared.stations, 0, 0).skipped, "gouge: 3 mm deep");
}

TEST(StartEnds, LeadFromHomeToEveryPieceButTheFirst) {
  const PlanResult& plan = FreshPlan().plan;
  const auto gaps = LinkMoveEnds(HomeOf(plan), plan.passes);
  const auto starts = StartEnds(gaps);
  ASSERT_EQ(starts.size(), gaps.size() - 2);
  for (size_t i = 0; i < starts.size(); ++i) {
    EXPECT_EQ(starts[i].first.pass, -1);
    EXPECT_EQ(starts[i].first.q, plan.home);
    EXPECT_EQ(starts[i].second.pass, gaps[i + 1].second.pass);
    EXPECT_EQ(starts[i].second.q, gaps[i + 1].second.q);
  }
}

// Nothing is driven that was not planned: every joint motion of a start is one of the plan's or of the ways',
// there or back.
TEST(SingleStart, IsMadeOfPlannedMotionsAlone) {
  const PlannedJob& job = FreshPlan();
  std::vector<std::pair<Joints, Joints>> planned;
  for (const PlanResult* plan : {&job.plan, &job.starts.ways})
    for (const LinkMove& gap : plan->gaps)
      for (size_t k = 1; k < gap.joints.size(); ++k) {
        planned.emplace_back(gap.joints[k - 1], gap.joints[k]);
        planned.emplace_back(gap.joints[k], gap.joints[k - 1]);
      }
  for (size_t i = 0; i + 1 < job.plan.gaps.size(); ++i) {
    const PlanResult single = SingleStart(job.plan, job.starts.ways, i);
    ASSERT_EQ(single.gaps.size(), 2u);
    EXPECT_EQ(single.gaps[0].joints.front(), job.plan.home);
    EXPECT_EQ(single.gaps[1].joints.back(), job.plan.home);
    EXPECT_EQ(single.gaps[1].to_pass, -1);
    for (const LinkMove& gap : single.gaps)
      for (size_t k = 1; k < gap.joints.size(); ++k)
        EXPECT_NE(std::ranges::find(planned, std::pair(gap.joints[k - 1], gap.joints[k])), planned.end());
    size_t points = 0;
    for (const PassResult& pass : single.passes) points += pass.points.size();
    EXPECT_EQ(points, 3u) << "one pass alone";
    EXPECT_LE(single.job.size(), 20u);
  }
}

TEST(SingleStart, AWayThatWasNotPlannedIsSaid) {
  const PlannedJob& job = FreshPlan();
  PlanResult ways = job.starts.ways;
  ways.gaps[0].planned = false;
  ways.gaps[0].detail = "spindle touches clamp";
  for (const size_t i : {0u, 1u})  // home over it, and from home by it
    EXPECT_NE(WhyNotProgrammable(SingleStart(job.plan, ways, i)).find("spindle touches clamp"),
              std::string::npos)
        << i;
}

TEST(PlanTimeline, RunsFromHomeToHomeAndNeverBack) {
  const Timeline timeline = PlanTimeline(FreshPlan().plan, SmallInputs());
  ASSERT_GT(timeline.size(), 10u);
  EXPECT_EQ(timeline.front().q, FreshPlan().plan.home);
  EXPECT_EQ(timeline.back().q, FreshPlan().plan.home);
  size_t points = 0;
  for (size_t i = 1; i < timeline.size(); ++i) {
    EXPECT_GE(timeline[i].time, timeline[i - 1].time);
    if (timeline[i].point < 0) continue;
    ++points;
    const PlannedPoint& point =
        FreshPlan().plan.passes[static_cast<size_t>(timeline[i].pass)].points[static_cast<size_t>(
            timeline[i].point)];
    EXPECT_LT((timeline[i].tip - point.point.position).norm(), 1e-6);
  }
  EXPECT_EQ(points, 6u);
}

TEST(Stages, TimesEachAndHandsTheRestOn) {
  Stages stages(Silent());
  stages.Begin("surface (STEP: at most 120 s, 2048 MB)", 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  stages.Begin("surface", 0);  // goes on
  stages.End("done");
  stages.Begin("passes", 3);
  stages.End("3 passes");
  stages.Begin("passes", 3);  // another one, now that the first has ended
  stages.End("3 passes");
  ASSERT_EQ(stages.times().size(), 3u);
  EXPECT_EQ(stages.times()[0].name, "surface");
  EXPECT_GE(stages.times()[0].seconds, 0.03);
  EXPECT_LT(stages.times()[1].seconds, 0.03);
}

}  // namespace
}  // namespace millpose::test
