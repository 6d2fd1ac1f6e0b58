// SPDX-License-Identifier: GPL-3.0-or-later
// What plans passes once more: ends without room, points inserted, the other direction; and pairs that always
// touch.
#include "base/counted.hpp"
#include "base/value_bytes.hpp"
#include "job/assemble.hpp"
#include "job/compensate_job.hpp"
#include "job/exclude_pairs.hpp"
#include "job/job_engagement.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/links/job_planner.hpp"
#include "planning/links/retract.hpp"
#include "run/pipeline/programs/program_warnings.hpp"
#include "run/pipeline/stages/finer_passes.hpp"
#include "run/pipeline/stages/other_ways.hpp"
#include "run/pipeline/stages/promising_reversals.hpp"
#include "run/pipeline/stages/repair_ends.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/run/pipeline/small_job.hpp"
#include "toolpath/pass_variants.hpp"

namespace millpose::test {
namespace {

std::string BytesOf(const std::vector<PassResult>& passes) {
  std::string bytes;
  for (const PassResult& pass : passes) bytes += HashOfValues(pass);
  return bytes;
}

TEST(RepairEnds, LeavesPassesWithRoomAlone) {
  std::vector<PassResult> passes = FreshPlan().plan.passes;
  const std::string before = BytesOf(passes);
  const JobInputs inputs = SmallInputs();
  const MemoryCheckpoints kept;
  const PreparedJob& prepared = FreshPlan().prepared;
  RepairEnds({prepared.stations, prepared.toolpath, prepared.external}, MakePathOptions(inputs.job),
             MakeLinkMoveOptions(inputs.job).leave, kept, {.threads = 2}, passes);
  EXPECT_EQ(BytesOf(passes), before);
  EXPECT_EQ(kept.writes, 0);
}

// A block over the spindle's bracket where pass 0 ends: the tool cannot be drawn back in that pose, in others
// it can.
TEST(RepairEnds, GivesAnEndAPoseThatItCanBeLeftIn) {
  const JobInputs inputs = SmallInputs();
  PreparedJob prepared = FreshPlan().prepared;
  std::vector<PassResult> passes = FreshPlan().plan.passes;
  const PassResult& pass = passes[0];
  const Joints end = pass.points[static_cast<size_t>(pass.pieces[0].last)].q;
  prepared.cell.bodies.push_back(
      {"block", BodyClass::kFixture, Mount::kWorld, 0,
       prepared.cell.X_WB * ForwardFlange(prepared.cell.arm, end) * At(160, 0, 100), Box{{20, 60, 60}}});
  prepared.world = World(prepared.cell);
  prepared.stations = Stations(prepared.world, prepared.problem);
  const RetractOptions leave = MakeLinkMoveOptions(inputs.job).leave;
  const Carrier carrier{prepared.cell.arm, prepared.cell.X_WB, prepared.cell.X_FT};
  ASSERT_LT(ShareToLeave(prepared.world, carrier, end, leave), 1);
  RepairEnds({prepared.stations, prepared.toolpath, prepared.external}, MakePathOptions(inputs.job), leave,
             NoCheckpoints(), {.threads = 2}, passes);
  ASSERT_EQ(passes[0].pieces.size(), 1u);
  for (const PlannedPoint& point : passes[0].points) EXPECT_EQ(point.skip, Infeasibility::kNone);
  const Joints now = passes[0].points[static_cast<size_t>(passes[0].pieces[0].last)].q;
  EXPECT_EQ(ShareToLeave(prepared.world, carrier, now, leave), 1);
  EXPECT_FALSE(now.isApprox(end, 1e-3));
}

// A retract that leads out of reach from every pose: what cannot be left is not milled, and says why.
TEST(RepairEnds, APassThatNoPoseCanLeaveIsLeftOutWithItsReason) {
  const JobInputs inputs = SmallInputs();
  PreparedJob prepared = FreshPlan().prepared;
  std::vector<PassResult> passes = FreshPlan().plan.passes;
  RetractOptions leave = MakeLinkMoveOptions(inputs.job).leave;
  leave.height = 3000;  // through the cell and beyond the arm's reach
  const MemoryCheckpoints kept;
  RepairEnds({prepared.stations, prepared.toolpath, prepared.external}, MakePathOptions(inputs.job), leave,
             kept, {.threads = 2}, passes);
  for (const PassResult& pass : passes)
    for (const PlannedPoint& point : pass.points)
      EXPECT_TRUE(point.detail.starts_with("no pose here can be entered or left: ")) << point.detail;
  EXPECT_EQ(kept.writes, 2) << "both were tried";
  const std::string once = BytesOf(passes);
  // What was found out about the ends is not asked again; the plans are read.
  RepairEnds({prepared.stations, prepared.toolpath, prepared.external}, MakePathOptions(inputs.job), leave,
             kept, {.threads = 1}, passes);
  EXPECT_EQ(BytesOf(passes), once);
  EXPECT_EQ(kept.writes, 2);
}

TEST(PlanFiner, InsertsPointsOnTheSurfaceWhereABoundPerStepLosesThem) {
  const PlannedJob job =
      PlanJob(SmallInputs({{"path.max_joint_step_deg", "[1, 1, 1, 4, 4, 4]"}, {"programs", "[]"}}),
              NoCheckpoints(), {.threads = 2});
  const size_t laid = CountPoints(job.prepared.made.toolpath), run = CountPoints(job.prepared.toolpath);
  EXPECT_GT(run, laid);
  for (const PassResult& pass : job.plan.passes) {
    EXPECT_EQ(pass.pieces.size(), 1u);
    for (size_t i = 0; i < pass.points.size(); ++i) {
      const PlannedPoint& point = pass.points[i];
      EXPECT_EQ(point.skip, Infeasibility::kNone) << point.detail;
      EXPECT_LT(job.prepared.surface.mesh.Closest(job.plan.X_WP.inverse() * point.point.position).distance,
                1e-9);
      if (i == 0) continue;
      const Joints step = (point.q - pass.points[i - 1].q).cwiseAbs();
      EXPECT_LE(RadToDeg(step.head<3>().maxCoeff()), 1 + 1e-9);
    }
  }
  size_t longer = 0;
  for (size_t i = 0; i < job.plan.passes.size(); ++i)
    longer += job.plan.passes[i].points.size() > job.prepared.made.toolpath.passes[i].points.size() ? 1 : 0;
  const std::string words =
      fmt::format("toolpath: {} points are inserted in {}, ", run - laid, CountedPasses(longer));
  EXPECT_TRUE(std::ranges::any_of(job.prepared.warnings, [&](const std::string& warning) {
    return warning.starts_with(words);
  })) << words;
}

TEST(PlanFiner, PathsFromAFileKeepTheirPoints) {
  JobInputs inputs = LoadJobInputs(SamplePath("toolpaths/support_cam/job.yaml"));
  PreparedJob prepared = FreshPlan().prepared;
  std::vector<PassResult> passes = FreshPlan().plan.passes;
  for (PassResult& pass : passes) pass.points[1].skip = Infeasibility::kStep;  // would ask for more
  const std::string before = BytesOf(passes);
  const MemoryCheckpoints kept;
  PlanFiner(
      inputs, prepared, kept, [](size_t) { return true; }, {.threads = 1}, passes);
  EXPECT_EQ(BytesOf(passes), before);
  EXPECT_EQ(kept.writes, 0);
}

TEST(FreeDirections, AreThoseOfAZigzagWithAnUprightTool) {
  JobInputs inputs = SmallInputs();
  EXPECT_TRUE(FreeDirections(inputs.job));
  EXPECT_TRUE(DependsOnFeed(inputs.job, *FreshPlan().prepared.problem.objective));
  inputs.job.toolpath.tilt = 0.1;
  EXPECT_FALSE(FreeDirections(inputs.job));
  EXPECT_FALSE(FreeDirections(SmallInputs({{"toolpath.direction", "one_way"}}).job));
  EXPECT_FALSE(FreeDirections(LoadJobInputs(SamplePath("toolpaths/support_curve/job.yaml")).job));
  inputs.job.cutting.reset();
  EXPECT_FALSE(DependsOnFeed(inputs.job, *MakeObjective("chen2021", {})));
  EXPECT_TRUE(DependsOnFeed(inputs.job, *MakeObjective("process_force", {{"feed_N", 1}})));
}

TEST(PlanBestWays, ATurnedPassIsBetterAndNamed) {
  const JobInputs inputs =
      LoadJobInputs(SamplePath("toolpaths/support_pad/job.yaml"),
                    {{"toolpath.stepover_mm", "16"}, {"toolpath.spacing_mm", "40"}, {"programs", "[]"}});
  const PlannedJob job = PlanJob(inputs, NoCheckpoints(), {.threads = 2});
  const Toolpath laid =
      PlacedToolpath(inputs, MakeJobToolpath(inputs, job.prepared.surface.mesh, {}).toolpath, job.plan.X_WP);
  std::vector<size_t> turned;
  for (size_t i = 0; i < laid.passes.size(); ++i)
    if (laid.passes[i].points.front().position != job.prepared.toolpath.passes[i].points.front().position) {
      turned.push_back(i);
      EXPECT_EQ(laid.passes[i].points.front().position,
                job.prepared.toolpath.passes[i].points.back().position);
    }
  const auto warned = std::ranges::find_if(job.prepared.warnings, [](const std::string& warning) {
    return warning.find("run from their other end") != std::string::npos;
  });
  ASSERT_EQ(warned != job.prepared.warnings.end(), !turned.empty());
  if (turned.empty()) return;
  EXPECT_NE(warned->find(fmt::format("toolpath: passes {} run", fmt::join(turned, ", "))), std::string::npos)
      << *warned;
}

// The slow way to the same end: every pass planned both ways, and the better plan kept.
TEST(PlanBestWays, KeepsTheDirectionsThatPlanningEveryPassBothWaysKeeps) {
  const JobInputs inputs =
      LoadJobInputs(SamplePath("toolpaths/support_pad/job.yaml"),
                    {{"toolpath.stepover_mm", "14"}, {"toolpath.spacing_mm", "30"}, {"programs", "[]"}});
  const Execution execution{.threads = 2};
  PreparedJob prepared = PrepareJob(inputs, NoCheckpoints(), execution);
  const PreparedJob laid = prepared;
  const auto all = [](size_t) { return true; };
  const auto best = PlanBestWays(inputs, prepared, NoCheckpoints(), all, execution).passes;

  Toolpath turned = laid.made.toolpath;
  std::vector<std::vector<char>> points;
  for (Pass& pass : turned.passes) {
    if (pass.reversible) pass = RunFromEnd(pass);
    points.emplace_back(pass.points.size(), 1);
  }
  SetEngagementOf(points, laid.laying.inputs, laid.laying.mesh, execution, turned);
  const PathOptions options = MakePathOptions(inputs.job);
  const auto plan = [&](const Toolpath& toolpath) {
    return PlanPasses(laid.stations, {toolpath, laid.external, all}, options, NoCheckpoints(), execution)
        .passes;
  };
  const auto one = plan(laid.toolpath),
             other = plan(AtStations(inputs, turned, laid.stations, laid.external));
  std::vector<char> expected;
  for (size_t i = 0; i < one.size(); ++i) {
    expected.push_back(turned.passes[i].reversible &&
                       IsBetter(ValueOf(other[i]), ValueOf(one[i]), options.worst_first, kGainOfTurning));
    EXPECT_EQ(HashOfValues(best[i]), HashOfValues(expected[i] != 0 ? other[i] : one[i])) << "pass " << i;
  }
  EXPECT_EQ(prepared.turned, expected);
  EXPECT_GT(std::ranges::count(expected, 1), 0);
  EXPECT_GT(std::ranges::count(expected, 0), 0);
}

TEST(PromisingReversals, APlanSettlesWhatNoPlanOfThePromiseCouldBeat) {
  const Promise promise{.worst = 10, .sum = 0, .mean = 4};
  EXPECT_TRUE(IsBetterThanAny({0, 1, 9.4, 5}, promise, true)) << "the worst point decides";
  EXPECT_FALSE(IsBetterThanAny({0, 1, 9.6, 4}, promise, true));
  EXPECT_TRUE(IsBetterThanAny({0, 1, 10.4, 3.7}, promise, true)) << "the worst tells nothing, the mean does";
  EXPECT_FALSE(IsBetterThanAny({0, 1, 10.6, 3.7}, promise, true));
  EXPECT_TRUE(IsBetterThanAny({0, 1, 99, 3.7}, promise, false));
  EXPECT_FALSE(IsBetterThanAny({1, 1, 9, 3}, promise, true)) << "as laid it may skip less";
  EXPECT_FALSE(IsBetterThanAny({0, 2, 9, 3}, promise, true)) << "as laid it may be one piece";
}

/// kr500_r2830 with two more bodies on links 4 and 6, `apart` mm between wrist centre and the second.
CellSettings CellWithCollar(double radius) {
  std::map<std::string, std::string> bytes;
  CellSettings cell = LoadCell(SamplePath("cells/kr500_r2830.yaml"), &bytes);
  const auto add = [&](const char* name, int link) {
    BodySettings& body = cell.bodies.emplace_back();
    body.name = name;
    body.body_class = BodyClass::kLink;
    body.mount = {Mount::kLink, link};
    body.shape.kind = ShapeKind::kSphere;
    body.shape.diameter = 2 * radius;
  };
  add("collar", 4);  // at the wrist centre, 290 mm from the flange in every pose
  add("cap", 6);
  return cell;
}

TEST(ExcludeTouchingNeighbours, FindsWhatTouchesInEveryPoseAndNothingElse) {
  const auto has = [](const CellSettings& cell) {
    return std::ranges::count(cell.excluded_pairs, std::pair<std::string, std::string>("collar", "cap"));
  };
  CellSettings cell = CellWithCollar(150);
  const size_t before = cell.excluded_pairs.size();
  ExcludeTouchingNeighbours({}, false, &cell);
  EXPECT_EQ(cell.excluded_pairs.size(), before) << "not asked for";
  cell.auto_excluded_pairs = true;
  ExcludeTouchingNeighbours({}, false, &cell);
  EXPECT_EQ(has(cell), 1);
  EXPECT_FALSE(cell.auto_excluded_pairs);
  for (const auto& [a, b] : cell.excluded_pairs) EXPECT_NE(a, "platform") << b;
  CellSettings apart = CellWithCollar(140);  // 10 mm between them in every pose
  apart.auto_excluded_pairs = true;
  ExcludeTouchingNeighbours({}, false, &apart);
  EXPECT_EQ(has(apart), 0);
}

TEST(ExcludeTouchingNeighbours, ProposesThemForAnArmFromAUrdf) {
  CellSettings cell = CellWithCollar(150);
  ExcludeTouchingNeighbours({}, true, &cell);
  EXPECT_TRUE(std::ranges::any_of(cell.warnings, [](const std::string& warning) {
    return warning.find("'collar' and 'cap' touch in each of 200 poses") != std::string::npos &&
           warning.find("excluded_pairs: [[collar, cap]]") != std::string::npos;
  }));
  const size_t warnings = cell.warnings.size();
  cell.excluded_pairs.emplace_back("cap", "collar");  // either way round
  ExcludeTouchingNeighbours({}, true, &cell);
  EXPECT_EQ(std::ranges::count_if(
                cell.warnings,
                [](const std::string& w) { return w.find("'collar' and 'cap'") != std::string::npos; }),
            1);
  EXPECT_LT(cell.warnings.size(), 2 * warnings + 1);
}

TEST(CheckCompensation, RefusesWhatJobAndCellCannotHaveTogether) {
  JobSettings job;
  job.file = "job.yaml";
  CellSettings cell;
  cell.name = "c";
  EXPECT_TRUE(CheckCompensation(job, cell).empty());
  job.compensation.weight = true;
  cell.arm.absolute_accuracy = true;
  cell.stiffness_at = StiffnessOrigin::kFlange;
  const std::vector<Problem> problems = CheckCompensation(job, cell);
  ASSERT_EQ(problems.size(), 3u);
  for (const Problem& problem : problems) {
    EXPECT_EQ(problem.place.file, "job.yaml");
    EXPECT_TRUE(problem.message.starts_with("compensation"));
    EXPECT_NE(problem.message.find("cell c"), std::string::npos);
  }
  job.compensation.weight = false;
  EXPECT_TRUE(CheckCompensation(job, cell).empty());
  job.compensation.deflection = TakeOut::kNormal;
  EXPECT_EQ(CheckCompensation(job, cell).size(), 1u);
}

TEST(MakeCompensationOptions, TheJobsUncertaintyHoldsElseTheCellsElseTheDefault) {
  JobSettings job;
  CellSettings cell;
  EXPECT_TRUE(MakeCompensationOptions(job, cell).stiffness.joints.isConstant(kStiffnessUncertainty));
  cell.arm.stiffness_uncertainty << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6;
  EXPECT_EQ(MakeCompensationOptions(job, cell).stiffness.joints, cell.arm.stiffness_uncertainty);
  EXPECT_EQ(MakeCompensationOptions(job, cell).stiffness.beside, kStiffnessUncertainty);
  job.compensation.stiffness_uncertainty = 0.07;
  EXPECT_TRUE(MakeCompensationOptions(job, cell).stiffness.joints.isConstant(0.07));
  EXPECT_EQ(MakeCompensationOptions(job, cell).stiffness.beside, 0.07);
}

TEST(FeedsOf, AreThoseOfEveryPoint) {
  const auto feeds = FeedsOf(FreshPlan().plan);
  ASSERT_EQ(feeds.size(), FreshPlan().plan.passes.size());
  for (size_t p = 0; p < feeds.size(); ++p)
    for (size_t i = 0; i < feeds[p].size(); ++i)
      EXPECT_EQ(feeds[p][i], FreshPlan().plan.passes[p].points[i].point.feed_rate);
}

TEST(ProgramWarnings, NameTheSlowestPlacesFirstAndCountTheRest) {
  PathSpeed speed;
  EXPECT_EQ(SpeedWarning(speed), "");
  for (int i = 0; i < 7; ++i) speed.slow.push_back({i, 10 * i, 10, 9.0 - i, i == 6 ? "corner" : "motion"});
  const std::string warning = SpeedWarning(speed);
  EXPECT_TRUE(
      warning.starts_with("the feed is not held at 7 places, estimated: pass 6 point 60: 180 of 600 mm/min "
                          "(corner), pass 5 point 50: 240 of 600 mm/min (short motion), "))
      << warning;
  EXPECT_EQ(warning.find("pass 1 point"), std::string::npos) << "five are named";
  EXPECT_NE(warning.find(", ...; at corners"), std::string::npos);
}

TEST(ProgramWarnings, MemoryCountsAllFilesTogether) {
  const ProgramFiles files{{"a.src", std::string(600, 'x')}, {"a.dat", std::string(500, 'x')}};
  EXPECT_EQ(MemoryWarning(files, 0), "") << "no such bound";
  EXPECT_EQ(MemoryWarning(files, 1100), "");
  EXPECT_TRUE(MemoryWarning(files, 1099).starts_with("all files together take 1 kB"));
}

}  // namespace
}  // namespace millpose::test
