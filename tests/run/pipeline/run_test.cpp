// SPDX-License-Identifier: GPL-3.0-or-later
// From a job file to an output folder: what is in it, when it is up to date, where its job was.
#include "run/pipeline/outputs/run.hpp"

#include <nlohmann/json.hpp>

#include "base/process.hpp"
#include "job/origin.hpp"
#include "run/pipeline/outputs/run_record.hpp"
#include "run/pipeline/outputs/up_to_date.hpp"
#include "run/pipeline/outputs/write_results.hpp"
#include "run/pipeline/programs/verify_programs.hpp"
#include "store/manifest.hpp"
#include "store/result_swap.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

using Json = nlohmann::json;

/// The small job planned into its folder, once for all tests, which leave it as it is.
class PlannedFolder {
 public:
  PlannedFolder() {
    CopySmallJob(folder_);
    arguments_.job = folder_.path() / "job.yaml";
    arguments_.threads = 2;
    outcome = RunPlan(arguments_, Silent(), {});
  }
  std::filesystem::path job() const { return folder_.path(); }
  std::filesystem::path out() const { return folder_.path() / "support_pad.out"; }
  const PlanArguments& arguments() const { return arguments_; }
  PlanOutcome outcome;

 private:
  TestFolder folder_{"run"};
  PlanArguments arguments_;
};

const PlannedFolder& Planned() {
  static const PlannedFolder planned;
  return planned;
}

/// A copy of it, to be damaged.
class Copy {
 public:
  Copy() { std::filesystem::copy(Planned().job(), folder_.path(), std::filesystem::copy_options::recursive); }
  std::filesystem::path out() const { return folder_.path() / "support_pad.out"; }
  PlanArguments arguments() const {
    PlanArguments arguments = Planned().arguments();
    arguments.job = folder_.path() / "job.yaml";
    return arguments;
  }
  const TestFolder& folder() const { return folder_; }

 private:
  TestFolder folder_{"run_copy"};
};

TEST(RunPlan, LeavesWhatTheManifestNames) {
  EXPECT_EQ(Planned().outcome.exit_status, 0) << Planned().outcome.text;
  const Manifest manifest = CheckManifest(Planned().out());
  EXPECT_EQ(manifest.key, LoadJobInputs(Planned().arguments().job).hash);
  for (const char* name :
       {"job.yaml", "cell.yaml", "plan.cbor.gz", "starts.cbor", "points.csv", "deflection.csv", "path.vtp",
        "summary.json", "report.html", "programs/linuxcnc/support_pad.ngc"})
    EXPECT_TRUE(manifest.files.contains(name)) << name;
  EXPECT_EQ(
      std::ranges::count_if(
          manifest.files, [](const auto& file) { return file.first.find("/starts/") != std::string::npos; }),
      2);
  EXPECT_FALSE(manifest.files.contains("run.json"));
  const Json summary = Json::parse(ReadFile(Planned().out() / "summary.json"));
  EXPECT_EQ(summary["points"]["total"], 6);
  EXPECT_EQ(summary["points"]["planned"], 6);
  EXPECT_EQ(summary["programs"][0]["verified"], true);
  EXPECT_EQ(std::ranges::count(ReadFile(Planned().out() / "points.csv"), '\n'), 7);
}

TEST(RunPlan, RunJsonSaysWhatDiffersFromRunToRun) {
  const Json run = Json::parse(ReadFile(Planned().out() / "run.json"));
  EXPECT_EQ(run["threads"], 2);
  EXPECT_EQ(run["program_id"], ProgramId());
  EXPECT_EQ(run["exit_status"], 0);
  EXPECT_EQ(run["told"], Planned().outcome.text);
  EXPECT_EQ(run["job"]["file"], "../job.yaml");
  EXPECT_EQ(run["job_folder"]["relative"], "..");
  double sum = 0;
  for (const auto& [name, stage] : run["stages"].items()) sum += stage["wall_s"].get<double>();
  EXPECT_NEAR(run["wall_s"], sum, 1e-6);
  EXPECT_GT(run["peak_memory_MB"], 10);
}

TEST(RunPlan, APlanThatIsUpToDateIsNotMadeAgain) {
  const Copy copy;
  RunPlan(copy.arguments(), Silent(), {});  // the folder has moved: its run.json says where the job was
  const std::string run = ReadFile(copy.out() / "run.json");
  EXPECT_EQ(Json::parse(run)["job_folder"]["absolute"], copy.folder().path().string());
  const PlanOutcome again = RunPlan(copy.arguments(), Silent(), {});
  EXPECT_EQ(again.exit_status, 0);
  EXPECT_TRUE(again.text.ends_with("unchanged  this plan is up to date; nothing was planned again\n"));
  EXPECT_EQ(ReadFile(copy.out() / "run.json"), run);
}

TEST(RunPlan, WhateverIsReusedTheFilesAreTheSame) {
  const Copy copy;
  const Manifest before = CheckManifest(copy.out());
  std::filesystem::remove(copy.out() / "points.csv");  // no plan any more, but its checkpoints
  EXPECT_EQ(RunPlan(copy.arguments(), Silent(), {}).exit_status, 0);
  const auto same = [&] {
    const Manifest now = CheckManifest(copy.out());
    EXPECT_EQ(ManifestJson(now), ManifestJson(before));
    return Json::parse(ReadFile(copy.out() / "run.json"));
  };
  EXPECT_EQ(same()["resumed_passes"], 2);
  PlanArguments fresh = copy.arguments();
  fresh.fresh = true;
  EXPECT_EQ(RunPlan(fresh, Silent(), {}).exit_status, 0);
  EXPECT_EQ(same()["resumed_passes"], 0);
}

TEST(RunPlan, ItsResolvedJobIsPlannedThereAgain) {
  const Copy copy;
  PlanArguments resolved = copy.arguments();
  resolved.job = copy.out() / "job.yaml";
  EXPECT_EQ(DefaultFolder(resolved.job, "support_pad"), copy.out());
  const PlanOutcome again = RunPlan(resolved, Silent(), {});
  EXPECT_NE(again.text.find("this plan is up to date"), std::string::npos) << again.text;
}

TEST(RunPlan, AnotherJobOfTheSameNameIsRefused) {
  const Copy copy;
  copy.folder().Write("other.yaml", copy.folder().Read("job.yaml"));
  PlanArguments other = copy.arguments();
  other.job = copy.folder().path() / "other.yaml";
  const std::string refusal = RefusalOf([&] { RunPlan(other, Silent(), {}); });
  EXPECT_NE(refusal.find("name: support_pad is also the name of"), std::string::npos) << refusal;
  std::filesystem::remove(copy.folder().path() / "job.yaml");  // it was renamed
  EXPECT_NE(RunPlan(other, Silent(), {}).text.find("6 of 6 points"), std::string::npos);
}

TEST(HoldsPlanOf, OnlyWhatIsAsItWasWrittenByThisProgram) {
  const std::string key = CheckManifest(Planned().out()).key;
  EXPECT_TRUE(HoldsPlanOf(Planned().out(), key));
  EXPECT_FALSE(HoldsPlanOf(Planned().out(), key + "0"));
  EXPECT_FALSE(HoldsPlanOf(Planned().job(), key));
  const auto after = [&](const std::function<void(const std::filesystem::path&)>& change) {
    const Copy copy;
    EXPECT_TRUE(HoldsPlanOf(copy.out(), key));
    change(copy.out());
    return HoldsPlanOf(copy.out(), key);
  };
  EXPECT_FALSE(after([](const auto& out) { std::filesystem::remove(out / "report.html"); }));
  EXPECT_FALSE(after([](const auto& out) { WriteFileAtomically(out / "points.csv", "point\n"); }));
  EXPECT_FALSE(after([](const auto& out) { WriteFileAtomically(out / "programs/linuxcnc/b.ngc", "M2\n"); }));
  EXPECT_FALSE(after([](const auto& out) { WriteFileAtomically(out / "run.json", "{"); }));
  EXPECT_FALSE(after([](const auto& out) {
    Json run = Json::parse(ReadFile(out / "run.json"));
    run["program_id"] = "another build";
    WriteFileAtomically(out / "run.json", run.dump());
  }));
  EXPECT_FALSE(after([](const auto& out) { WriteFileAtomically(out / ".journal", "a swap was begun"); }));
  EXPECT_TRUE(after([](const auto& out) { WriteFileAtomically(out / "note.txt", "the user's"); }));
}

TEST(FindExistingPlan, HoldsForTheSameWishesAlone) {
  const std::string key = CheckManifest(Planned().out()).key;
  const OutputFolder folder(Planned().out(), FolderUse::kCheckpoints);
  const auto found = [&](const std::function<void(PlanArguments&)>& change) {
    PlanArguments arguments = Planned().arguments();
    change(arguments);
    return FindExistingPlan(Planned().out(), key,
                            BeginRun(arguments, "support_pad", Planned().job(), folder));
  };
  const auto standing = found([](PlanArguments&) {});
  ASSERT_TRUE(standing);
  EXPECT_EQ(standing->exit_status, 0);
  EXPECT_EQ(standing->told, Planned().outcome.text);
  EXPECT_TRUE(found([](PlanArguments& a) { a.threads = 7; })) << "results do not depend on it";
  EXPECT_FALSE(found([](PlanArguments& a) { a.audit = true; }));
  EXPECT_FALSE(found([](PlanArguments& a) { a.full_axis_map = true; }));
  EXPECT_FALSE(found([](PlanArguments& a) { a.trajectory = 0.5; }));
  EXPECT_FALSE(found([](PlanArguments& a) { a.max_points = 100; }));
}

TEST(RunRecord, TheSeedIsAnOverrideLikeOthersAndTheLastHolds) {
  PlanArguments arguments;
  arguments.overrides = {{"seed", "3"}, {"name", "n"}};
  arguments.seed = 18446744073709551615U;
  const std::vector<Override> overrides = OverridesOf(arguments);
  ASSERT_EQ(overrides.size(), 3u);
  EXPECT_EQ(overrides[2].path, "seed");
  EXPECT_EQ(overrides[2].value, "18446744073709551615");
  EXPECT_EQ(FolderOf("job.yaml"), ".");
  EXPECT_EQ(FolderOf("a/job.yaml"), "a");
  EXPECT_EQ(DefaultFolder("a/job.yaml", "pad"), "a/pad.out");
}

TEST(Origin, IsTheJobsFolderOrWhereTheFolderSaysItWas) {
  const std::filesystem::path out = Planned().out();
  EXPECT_EQ(OriginOf("a/b.yaml", "cell.yaml", {}), "a");
  EXPECT_EQ(OriginOf("a/job.yaml", "cell.yaml", {}), "a") << "no output folder";
  EXPECT_TRUE(std::filesystem::equivalent(OriginOf(out / "job.yaml", "cell.yaml", {}), Planned().job()));
  // Job and results moved together.
  const TestFolder moved("run_moved");
  std::filesystem::copy(Planned().job(), moved.path(), std::filesystem::copy_options::recursive);
  Json run = Json::parse(ReadFile(moved.path() / "support_pad.out/run.json"));
  run["job_folder"]["absolute"] = "/nowhere";
  WriteFileAtomically(moved.path() / "support_pad.out/run.json", run.dump());
  EXPECT_TRUE(std::filesystem::equivalent(
      OriginOf(moved.path() / "support_pad.out/job.yaml", "cell.yaml", {}), moved.path()));
  std::filesystem::remove(moved.path() / "cell.yaml");
  EXPECT_NE(RefusalOf([&] {
              OriginOf(moved.path() / "support_pad.out/job.yaml", "cell.yaml", {});
            }).find("the files that it names were read from /nowhere, where cell.yaml is not any more"),
            std::string::npos);
  WriteFileAtomically(moved.path() / "support_pad.out/run.json", "{}");
  EXPECT_NE(RefusalOf([&] {
              OriginOf(moved.path() / "support_pad.out/job.yaml", "cell.yaml", {});
            }).find("does not say where the job stood"),
            std::string::npos);
}

TEST(VerifyPrograms, OfAFolderConfirmsWhatPlanWroteAndNothingElse) {
  VerifyArguments arguments;
  arguments.target = Planned().out();
  const std::vector<VerifiedProgram> programs = VerifyPrograms(arguments, Silent(), {});
  ASSERT_EQ(programs.size(), 3u);  // the whole and two starts
  for (const VerifiedProgram& program : programs) {
    EXPECT_EQ(program.controller, "linuxcnc");
    EXPECT_TRUE(program.findings.empty()) << VerifyText(programs);
  }
  EXPECT_EQ(VerifyText(programs).find("NOT confirmed"), std::string::npos);
  const Json json = Json::parse(VerifyJson(programs));
  EXPECT_EQ(json["programs"][0]["motions"], programs[0].motions);
  EXPECT_EQ(json["programs"][2]["confirmed"], true);
  const Copy copy;
  copy.folder().Change("support_pad.out/programs/linuxcnc/support_pad.ngc", "G93", "G94");
  arguments.target = copy.out();
  // Changed since, so it is held against the plan: feeds in inverse time are none in mm/min.
  const std::vector<VerifiedProgram> edited = VerifyPrograms(arguments, Silent(), {});
  EXPECT_FALSE(edited.at(0).changed.empty());
  EXPECT_FALSE(edited.at(0).findings.empty());
}

TEST(VerifyPrograms, OfOneProgramNeedsItsCellAndSaysWhatItRestsOn) {
  VerifyArguments arguments;
  arguments.target = Planned().out() / "programs/linuxcnc/support_pad.ngc";
  EXPECT_NE(RefusalOf([&] { VerifyPrograms(arguments, Silent(), {}); }).find("--cell CELL.yaml or "),
            std::string::npos);
  arguments.cell = Planned().job() / "cell.yaml";
  const std::vector<VerifiedProgram> alone = VerifyPrograms(arguments, Silent(), {});
  ASSERT_EQ(alone.size(), 1u);
  EXPECT_TRUE(alone[0].findings.empty()) << VerifyText(alone);
  ASSERT_FALSE(alone[0].assumptions.empty());
  EXPECT_NE(VerifyText(alone).find("  assumed: the part is not there: clearance from it is not checked\n"),
            std::string::npos);
  arguments.target = Planned().job() / "cell.yaml";
  EXPECT_NE(RefusalOf([&] {
              VerifyPrograms(arguments, Silent(), {});
            }).find("a folder of millpose plan, or a program ending in"),
            std::string::npos);
}

TEST(RunJson, AStageThatComesTwiceCountsWithBoth) {
  RunFigures run;
  run.stages = {{"passes", 1}, {"finer passes", 2}, {"finer passes", 3}};
  const Json json = Json::parse(RunJson(run));
  EXPECT_EQ(json["stages"]["finer passes"]["wall_s"], 5);
  EXPECT_EQ(json["stages"]["passes"]["wall_s"], 1);
}

TEST(FinishedFrom, IsTheFirstPassOfTheLastLayer) {
  JobSettings job;
  EXPECT_EQ(FinishedFrom(job, 7), 0);
  job.toolpath.layers.total = 6;
  job.toolpath.layers.per_layer = 2;
  EXPECT_EQ(FinishedFrom(job, 12), 8);
  job.toolpath.layers.per_layer = 2.5;  // three layers as well
  EXPECT_EQ(FinishedFrom(job, 9), 6);
}

TEST(UncertaintyOf, IsKnownWhereTheCellSaysAnyOfIt) {
  ToolSettings tool;
  tool.cutter_diameter = 20;
  EXPECT_FALSE(UncertaintyOf(tool));
  tool.axis_uncertainty = 0.001;
  ASSERT_TRUE(UncertaintyOf(tool));
  EXPECT_EQ(UncertaintyOf(tool)->tip, 0);
  EXPECT_EQ(UncertaintyOf(tool)->axis, 0.001);
  EXPECT_EQ(UncertaintyOf(tool)->radius, 10);
}

}  // namespace
}  // namespace millpose::test
