// SPDX-License-Identifier: GPL-3.0-or-later
// A job's plan as a value: what holds of every plan, and that neither threads nor checkpoints change it.
#include "job/assemble.hpp"
#include "job/narrow_inputs.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/links/job_planner.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

TEST(PlanJob, EveryPointIsOnTheToolPathInAnAdmissiblePose) {
  const PlannedJob& job = FreshPlan();
  const Carrier carrier{job.plan.arm, job.plan.X_WB, job.plan.X_FT};
  const AdmissibleBounds bounds = MakeBounds(SmallInputs().job, job.plan.arm);
  ASSERT_EQ(job.plan.passes.size(), job.prepared.toolpath.passes.size());
  size_t cuts = 0;
  for (const PassResult& pass : job.plan.passes) {
    const std::vector<MillingPoint>& laid =
        job.prepared.toolpath.passes[static_cast<size_t>(pass.pass)].points;
    for (const PlannedPoint& planned : pass.points) {
      ASSERT_EQ(planned.skip, Infeasibility::kNone) << planned.detail;
      const Pose X_WT = carrier.ToolPose(planned.q);
      EXPECT_LT((X_WT.translation() - planned.point.position).norm(), 1e-6);
      EXPECT_LT((X_WT.linear().col(2) - planned.point.tool_axis).norm(), 1e-9);
      EXPECT_TRUE(((planned.q - bounds.lower).array() >= 0).all());
      EXPECT_TRUE(((bounds.upper - planned.q).array() >= 0).all());
      EXPECT_EQ(Status(job.plan.arm, planned.q), planned.branch);
      // Where the cutter leaves the part it cuts nothing, and every pose is as good.
      EXPECT_EQ(planned.own_optimum > 0, !planned.point.engagement.force.isZero());
      EXPECT_EQ(planned.objective > 0, planned.own_optimum > 0);
      if (planned.point.kind != PointKind::kCut) continue;
      ++cuts;
      EXPECT_TRUE(
          std::ranges::any_of(laid, [&](const MillingPoint& p) { return IsSamePlace(p, planned.point); }));
    }
  }
  EXPECT_EQ(cuts, CountPoints(job.prepared.toolpath));
}

TEST(PlanJob, LinkMovesJoinHomeThePiecesAndHome) {
  const PlannedJob& job = FreshPlan();
  const Carrier carrier{job.plan.arm, job.plan.X_WB, job.plan.X_FT};
  const auto ends = LinkMoveEnds(HomeOf(job.plan), job.plan.passes);
  ASSERT_EQ(job.plan.gaps.size(), ends.size());
  for (size_t i = 0; i < ends.size(); ++i) {
    const LinkMove& gap = job.plan.gaps[i];
    ASSERT_TRUE(gap.planned) << gap.detail;
    EXPECT_EQ(gap.from_pass, ends[i].first.pass);
    EXPECT_EQ(gap.to_pass, ends[i].second.pass);
    if (gap.from_pass < 0)
      EXPECT_EQ(gap.joints.front(), job.plan.home);
    else
      EXPECT_TRUE(carrier.ToolPose(gap.joints.front()).isApprox(gap.X_WT_retracted, 1e-9));
    if (gap.to_pass < 0)
      EXPECT_EQ(gap.joints.back(), job.plan.home);
    else
      EXPECT_TRUE(carrier.ToolPose(gap.joints.back()).isApprox(gap.X_WT_approach, 1e-9));
    EXPECT_GT(gap.duration, 0);
    Checker checker(job.prepared.world);
    for (size_t k = 1; k < gap.joints.size(); ++k)
      EXPECT_FALSE(checker.Between(gap.joints[k - 1], gap.joints[k], Phase::kFree, 0.5));
  }
}

TEST(TryJob, PlansASampleOfThePassesAndSaysWhatThePlanWouldFind) {
  const Execution execution{.threads = 2};
  const TriedJob all = TryJob(SmallInputs(), 1000, NoCheckpoints(), execution);
  EXPECT_EQ(all.problem, "");
  EXPECT_EQ(all.passes, 2u);
  EXPECT_EQ(all.of_passes, 2u);
  EXPECT_EQ(all.points, all.of_points);
  const TriedJob some = TryJob(SmallInputs(), 3, NoCheckpoints(), execution);
  EXPECT_EQ(some.problem, "");
  EXPECT_EQ(some.passes, 1u);
  EXPECT_EQ(some.of_points, all.of_points);
  EXPECT_LT(some.points, all.points);
  EXPECT_EQ(TryJob(SmallInputs(), 0, NoCheckpoints(), execution).passes, 1u);
  const std::string far =
      TryJob(SmallInputs({{"workpiece.pose.xyz_mm", "[9000, 0, 1000]"}}), 1000, NoCheckpoints(), execution)
          .problem;
  EXPECT_EQ(far.substr(0, 7), "pass 0:") << far;
  // The way there: home touches the part.
  const PlannedJob& job = FreshPlan();
  const Pose X_WT = Carrier{job.plan.arm, job.plan.X_WB, job.plan.X_FT}.ToolPose(job.plan.home);
  const std::string body = fmt::format("[{:.1f}, {:.1f}, {:.1f}]", X_WT.translation().x(),
                                       X_WT.translation().y(), X_WT.translation().z());
  EXPECT_NE(TryJob(SmallInputs({{"workpiece.pose.xyz_mm", body}}), 1000, NoCheckpoints(), execution).problem,
            "");
}

TEST(PlanJob, ProgramsAreConfirmedAndEachPieceHasItsStart) {
  const PlannedJob& job = FreshPlan();
  ASSERT_EQ(job.programs.programs.size(), 1u);
  const CheckedProgram& program = job.programs.programs[0];
  EXPECT_EQ(program.controller, "linuxcnc");
  EXPECT_TRUE(program.Confirmed()) << program.WhyWithheld();
  EXPECT_EQ(program.WhyWithheld(), "");
  ASSERT_EQ(program.files.size(), 1u);
  // It names what it depends on, and no more: other controllers of the job change nothing in it.
  const std::string named = InputsOfProgram(SmallInputs(), "linuxcnc").hash;
  EXPECT_NE(program.files.begin()->second.find("\n; inputs: " + named + '\n'), std::string::npos);
  EXPECT_EQ(InputsOfProgram(SmallInputs({{"programs", "[linuxcnc, krl]"}}), "linuxcnc").hash, named);
  size_t pieces = 0;
  for (const PassResult& pass : job.plan.passes) pieces += pass.pieces.size();
  ASSERT_EQ(job.starts.programs.at("linuxcnc").size(), pieces);
  EXPECT_EQ(job.starts.ways.gaps.size(), pieces - 1);
  for (const StartProgram& start : job.starts.programs.at("linuxcnc"))
    EXPECT_TRUE(start.Confirmed()) << start.name << start.obstacle;
}

TEST(PlanJob, ThreadsDoNotChangeAByte) {
  const JobInputs inputs = SmallInputs();
  for (const int threads : {1, 4})
    EXPECT_EQ(test::BytesOf(PlanJob(inputs, NoCheckpoints(), {.threads = threads})),
              test::BytesOf(FreshPlan()))
        << threads;
}

TEST(PlanJob, LaidPointsMayGoBeforeProgramsAreMade) {
  const PlannedJob job = PlanJob(SmallInputs(), NoCheckpoints(), {.threads = 2}, LaidPoints::kGo);
  EXPECT_EQ(test::BytesOf(job), test::BytesOf(FreshPlan()));
  EXPECT_EQ(CountPoints(job.prepared.made.toolpath) + CountPoints(job.prepared.toolpath), 0u);
}

TEST(PlanJob, CheckpointsChangeWhatIsDoneAndNothingElse) {
  const JobInputs inputs = SmallInputs();
  const MemoryCheckpoints kept;
  const PlannedJob first = PlanJob(inputs, kept, {.threads = 2});
  EXPECT_EQ(first.resumed_passes + first.resumed_gaps, 0u);
  EXPECT_EQ(test::BytesOf(first), test::BytesOf(FreshPlan()));
  const int writes = kept.writes;
  EXPECT_GE(writes, 5);
  const PlannedJob second = PlanJob(inputs, kept, {.threads = 2});
  EXPECT_EQ(second.resumed_passes, second.plan.passes.size());
  EXPECT_EQ(second.resumed_gaps, second.plan.gaps.size());
  EXPECT_EQ(kept.writes, writes);
  EXPECT_EQ(test::BytesOf(second), test::BytesOf(FreshPlan()));
}

// Programs that have to be made again, of a plan whose cuts were confirmed before.
TEST(PlanJob, CutsThatWereConfirmedAreNotComparedAgainUnlessTheCellHasChanged) {
  const MemoryCheckpoints kept;
  const auto compared = [&](const JobInputs& inputs) {
    kept.stages.erase("programs-linuxcnc");
    const size_t before = kept.stages["runs-linuxcnc"].size();
    const std::string with = test::BytesOf(PlanJob(inputs, kept, {.threads = 2}));
    EXPECT_EQ(with, test::BytesOf(PlanJob(inputs, NoCheckpoints(), {.threads = 2})));
    return kept.stages["runs-linuxcnc"].size() > before;
  };
  EXPECT_TRUE(compared(SmallInputs()));
  EXPECT_FALSE(compared(SmallInputs()));
  kept.stages["runs-linuxcnc"].clear();
  EXPECT_TRUE(compared(SmallInputs()));
  JobInputs other = SmallInputs();
  other.cell.clearance_free += 0.01;  // which changes no motion of a cut
  EXPECT_TRUE(compared(other));
}

// Cut off, of another pass, of another kind, no plan at all: each is as good as none.
TEST(PlanJob, CheckpointsThatAreNotWhatTheySayAreNotUsed) {
  const JobInputs inputs = SmallInputs();
  const MemoryCheckpoints sound;
  PlanJob(inputs, sound, {.threads = 2});
  const auto with = [&](const std::function<void(MemoryCheckpoints&)>& damage) {
    MemoryCheckpoints kept;
    kept.kept = sound.kept;
    damage(kept);
    const PlannedJob job = PlanJob(inputs, kept, {.threads = 2});
    EXPECT_EQ(job.resumed_passes + job.resumed_gaps, 0u);
    EXPECT_EQ(test::BytesOf(job), test::BytesOf(FreshPlan()));
    ASSERT_EQ(kept.kept.size(), sound.kept.size());
    for (const auto& [key, plans] : kept.kept)
      EXPECT_EQ(plans.front(), sound.kept.at(key).front()) << "what is planned anew takes its place";
  };
  with([](MemoryCheckpoints& kept) {
    bool half = false;
    for (auto& [key, plans] : kept.kept)
      plans = {std::exchange(half, !half) ? plans.front().substr(0, 100) : ""};
  });
  with([](MemoryCheckpoints& kept) {  // each under the key of the next
    auto last = kept.kept.rbegin()->second;
    for (auto& [key, plans] : kept.kept) std::swap(last, plans);
  });
}

TEST(PlanJob, SharesOfSeveralMachinesMakeTheSamePlan) {
  const JobInputs inputs = SmallInputs();
  const MemoryCheckpoints kept;
  for (const size_t index : {1u, 0u}) PlanShare(inputs, {index, 2}, kept, {.threads = 1});
  EXPECT_GE(kept.writes, 2) << "a pass each";
  const PlannedJob job = PlanJob(inputs, kept, {.threads = 2});
  EXPECT_EQ(job.resumed_passes, 2u);
  EXPECT_EQ(job.resumed_gaps, 0u);
  EXPECT_EQ(test::BytesOf(job), test::BytesOf(FreshPlan()));
  EXPECT_TRUE((Share{0, 2}).Has(4) && !(Share{1, 2}).Has(4) && Share{}.Has(7));
}

/// Notes the stages, and stops in the middle of one.
class Watching final : public Progress {
 public:
  explicit Watching(std::string last = "") : last_(std::move(last)) {}
  void Begin(std::string_view stage, size_t total) override {
    stages.emplace_back(stage);
    totals.push_back(total);
    done.push_back(0);
  }
  void Advance(size_t count) override {
    const std::lock_guard lock(mutex_);
    done.back() += count;
    if (stages.back() == last_) source.request_stop();
  }
  void End(std::string_view outcome) override { outcomes.emplace_back(outcome); }

  std::vector<std::string> stages, outcomes;
  std::vector<size_t> totals, done;
  std::stop_source source;

 private:
  std::string last_;
  std::mutex mutex_;
};

TEST(PlanJob, SaysHowFarItHasCome) {
  Watching watching;
  PlanJob(SmallInputs(), NoCheckpoints(), {2, watching, {}});
  EXPECT_EQ(watching.outcomes.size(), watching.stages.size());
  std::vector<std::string> counted;
  for (size_t i = 0; i < watching.stages.size(); ++i) {
    if (watching.totals[i] == 0) continue;
    counted.push_back(watching.stages[i]);
    EXPECT_EQ(watching.done[i], watching.totals[i]) << watching.stages[i];
  }
  for (const char* stage : {"passes", "ends", "gaps", "starts"})
    EXPECT_EQ(std::ranges::count(counted, stage), 1) << stage;
}

TEST(PlanJob, WhatIsFinishedWhenItIsStoppedIsNotPlannedAgain) {
  const JobInputs inputs = SmallInputs();
  for (const char* stage : {"passes", "gaps"}) {
    const MemoryCheckpoints kept;
    Watching watching(stage);
    EXPECT_THROW(PlanJob(inputs, kept, {1, watching, watching.source.get_token()}), Interrupted) << stage;
    EXPECT_GE(kept.writes, 1) << stage;
    const PlannedJob job = PlanJob(inputs, kept, {.threads = 2});
    EXPECT_EQ(test::BytesOf(job), test::BytesOf(FreshPlan()));
    EXPECT_GE(job.resumed_passes + job.resumed_gaps, 1u) << stage;
  }
}

TEST(PlanJob, ProgramsThatCannotBeWrittenAreRefusedBeforeAnythingIsPlanned) {
  JobInputs inputs = SmallInputs();
  const MemoryCheckpoints kept;
  inputs.cell.programs_allowed = false;
  EXPECT_NE(RefusalOf([&] { PlanJob(inputs, kept, {}); }).find("reproduction_only"), std::string::npos);
  inputs = SmallInputs();
  inputs.cell.controllers.erase("linuxcnc");
  EXPECT_NE(RefusalOf([&] { PlanJob(inputs, kept, {}); }).find("needs a section controllers.linuxcnc"),
            std::string::npos);
  EXPECT_EQ(kept.writes, 0);
  inputs.job.programs.clear();
  EXPECT_NO_THROW(CheckPrograms(inputs));
}

TEST(PrepareJob, WarnsOfAHomeThatInterferes) {
  JobInputs inputs = SmallInputs();
  inputs.cell.home[2] = DegToRad(144);  // folded into the base
  inputs.cell.home[1] = DegToRad(20);
  const PreparedJob prepared = PrepareJob(inputs, NoCheckpoints(), {.threads = 1});
  EXPECT_TRUE(std::ranges::any_of(prepared.warnings, [](const std::string& warning) {
    return warning.find("home_deg: ") != std::string::npos;
  }));
  EXPECT_EQ(
      HomeWarning("c.yaml", {.first = "link3", .second = "base", .distance = 4}).find("c.yaml: home_deg: "),
      0u);
}

}  // namespace
}  // namespace millpose::test
