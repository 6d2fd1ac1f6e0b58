// SPDX-License-Identifier: GPL-3.0-or-later
// What reports say beyond the plan: what is withheld and why, splits, lifts, feeds; and that what is withheld
// is not written.
#include "run/pipeline/outputs/write_results.hpp"

#include "report/samples/sample_curves.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

/// What WriteResults is handed, of the small job; tests change some of it.
struct Handed {
  JobInputs inputs = SmallInputs();
  PlanResult plan = FreshPlan().plan;
  JobPrograms programs = FreshPlan().programs;
  JobStarts starts = FreshPlan().starts;
  FeedReduction reduction;
  std::vector<std::string> warnings, findings;
};

struct Written {
  ReportInputs report;
  std::vector<std::string> files;  ///< below programs/
};

Written Write(const Handed& handed) {
  static const Execution execution{.threads = 2};
  static const ReportParts parts =
      MakeReportParts(SmallInputs(), FreshPlan(), {}, false, NoCheckpoints(), execution);
  const PreparedJob& prepared = FreshPlan().prepared;
  const std::optional<AuditFigures> audit;
  const Timeline timeline;
  const TestFolder home("write_results");
  const OutputFolder folder(home.path() / "out", FolderUse::kResults);
  Written written;
  {
    ResultSet set(folder, kPlanNames);
    written.report = WriteResults({.inputs = handed.inputs,
                                   .cell = prepared.cell,
                                   .plan = handed.plan,
                                   .programs = handed.programs,
                                   .starts = handed.starts,
                                   .audit = audit,
                                   .reduction = handed.reduction,
                                   .warnings = handed.warnings,
                                   .findings = handed.findings,
                                   .grid = CurveGrid(),
                                   .parts = parts,
                                   .timeline = timeline,
                                   .fixed = FreshPlan().fixed,
                                   .faces = FreshPlan().faces,
                                   .heaviest = prepared.heaviest,
                                   .compensation_remains = {},
                                   .face = {},
                                   .execution = execution},
                                  set);
    set.AddManifest("key");
    set.Publish();
  }
  const std::filesystem::path below = folder.path() / kProgramsFolder;
  if (!std::filesystem::exists(below)) return written;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(below))
    if (entry.is_regular_file()) written.files.push_back(entry.path().lexically_relative(below).string());
  std::ranges::sort(written.files);
  return written;
}

struct GeometryBudget {
  std::optional<double> largest;  ///< mm
  std::string basis;
};

bool Says(const std::vector<std::string>& sentences, const std::string& words) {
  return std::ranges::any_of(
      sentences, [&](const std::string& sentence) { return sentence.find(words) != std::string::npos; });
}

TEST(WriteResults, OfASoundPlanNothingIsFoundAndEveryProgramIsWritten) {
  const Written written = Write({});
  EXPECT_TRUE(written.report.findings.empty());
  ASSERT_EQ(written.files.size(), 3u) << "the whole, and a start of each piece";
  EXPECT_EQ(written.files[2], "linuxcnc/support_pad.ngc");
  EXPECT_TRUE(written.files[0].starts_with("linuxcnc/starts/"));
  ASSERT_EQ(written.report.programs.size(), 1u);
  EXPECT_TRUE(written.report.programs[0].verified);
  for (const int motions : written.report.programs[0].motions_per_pass)
    EXPECT_GE(motions, 3) << "its points, and the way down to the first";
}

/// The small job's budget of geometry on an arm one of whose frames is off.
GeometryBudget GeometryOf(size_t frame, const Eigen::Vector3d& shift, const Eigen::Vector3d& turn) {
  Handed handed;
  DeviationSettings& deviations = handed.inputs.cell.arm.deviations.emplace();
  deviations.shifts.assign(7, Eigen::Vector3d::Zero());
  deviations.turns.assign(7, Eigen::Vector3d::Zero());
  deviations.shifts[frame] = shift;
  deviations.turns[frame] = turn;
  const Budget budget = Write(handed).report.budget.value();
  const auto row = std::ranges::find(budget.rows, "geometry", &BudgetRow::key);
  return {row->largest, row->basis};
}

TEST(WriteResults, DeviationsOfTheArmAreABudgetsLineOnceThePartsFrameHasTakenUpWhatItCan) {
  const std::optional<double> none = GeometryOf(0, {0, 0, 0}, {0, 0, 0}).largest;
  ASSERT_TRUE(none.has_value());
  EXPECT_NEAR(*none, 0, 1e-9);
  // The pad's normal is the base's -x: the shift shows in full, and a frame measured with the arm has it too.
  const GeometryBudget base = GeometryOf(0, {0.7, 0, 0}, {0, 0, 0});
  EXPECT_NEAR(base.largest.value(), 0, 1e-9);
  EXPECT_NE(base.basis.find("from elsewhere 700 µm"), std::string::npos) << base.basis;
  // A joint's offset turns the arm on a circle, of which no frame takes out the bend.
  const GeometryBudget joint = GeometryOf(2, {0, 0, 0}, {0, 5e-3, 0});
  EXPECT_GT(joint.largest.value(), 1e-4);
  EXPECT_LT(joint.largest.value(), 1);
}

TEST(WriteResults, GearTablesAreTheGearsLineAndNoneOfTheGeometrys) {
  Handed handed;
  DeviationSettings& deviations = handed.inputs.cell.arm.deviations.emplace();
  deviations.shifts.assign(7, Eigen::Vector3d::Zero());
  deviations.turns.assign(7, Eigen::Vector3d::Zero());
  deviations.gears = {{2, 150, 5e-5, 0}};
  const Budget budget = Write(handed).report.budget.value();
  EXPECT_NEAR(*std::ranges::find(budget.rows, "geometry", &BudgetRow::key)->largest, 0, 1e-9);
  const auto gears = std::ranges::find(budget.rows, "gear_error", &BudgetRow::key);
  EXPECT_GT(gears->largest.value(), 1e-3);
  EXPECT_LT(gears->largest.value(), 0.3);
  EXPECT_NE(gears->basis.find("by the tables of arm"), std::string::npos) << gears->basis;
}

TEST(WriteResults, WhatIsNotConfirmedIsWithheldWithItsCausesAndAFewOfTheirPlaces) {
  Handed handed;
  handed.findings = {"NOT MACHINED: a hole"};
  for (int i = 1; i <= 7; ++i)
    handed.programs.programs[0].findings.push_back({"a.ngc", i, fmt::format("{} mm off", i), Cause::kOther});
  handed.starts.programs.clear();  // as where no whole program stands
  const Written written = Write(handed);
  EXPECT_TRUE(written.files.empty());
  const std::vector<std::string>& findings = written.report.findings;
  ASSERT_EQ(findings.size(), 8u) << fmt::format("{}", fmt::join(findings, "\n"));
  EXPECT_TRUE(findings[0].starts_with("no linuxcnc program is written, its read-back does not confirm it: "));
  EXPECT_TRUE(Says({findings[1]}, "; what helps: "));
  EXPECT_EQ(findings[2], "linuxcnc a.ngc:1: 1 mm off");
  EXPECT_EQ(findings[5], "linuxcnc a.ngc:4: 4 mm off");
  EXPECT_EQ(findings[6], "linuxcnc: 3 more like these");
  EXPECT_EQ(findings[7], "NOT MACHINED: a hole") << "what is withheld comes first";
  EXPECT_FALSE(written.report.programs[0].verified);
}

TEST(WriteResults, APieceThatCannotBeStartedAloneCostsItsOwnProgram) {
  Handed handed;
  std::vector<StartProgram>& starts = handed.starts.programs.at("linuxcnc");
  ASSERT_EQ(starts.size(), 2u);
  starts[0].obstacle = "spindle touches clamp";
  const Written blocked = Write(handed);
  EXPECT_EQ(blocked.files.size(), 2u);
  EXPECT_TRUE(blocked.report.findings.empty()) << "the plan itself is milled whole";
  EXPECT_TRUE(Says(blocked.report.warnings,
                   fmt::format("linuxcnc: pass {} piece 0 cannot be started by itself: spindle touches clamp",
                               starts[0].pass)));
  starts[0].obstacle.clear();
  starts[0].findings.push_back({"a.ngc", 4, "0.3 mm off", Cause::kOther});
  const Written deviating = Write(handed);
  EXPECT_EQ(deviating.files.size(), 2u);
  EXPECT_TRUE(Says(deviating.report.findings, "cannot be started by itself: "));
}

TEST(WriteResults, SplitsThatCutNothingAreFindingsLiftsThatPayAreWarnings) {
  Handed handed;
  PassResult &split = handed.plan.passes[0], &lifted = handed.plan.passes[1];
  split.uncut = {0, 1};
  lifted.lifts = {0};
  lifted.lift_gain = 0.125;
  const Written written = Write(handed);
  const auto place = [](const PlannedPoint& point) {
    const Eigen::Vector3d& p = point.point.position;
    return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x(), p.y(), p.z());
  };
  EXPECT_TRUE(Says(written.report.findings, "pass 0 is split and not cut from the point at " +
                                                place(split.points[0]) + ", " + place(split.points[1]) +
                                                " to the next"));
  EXPECT_TRUE(Says(written.report.warnings, "pass 1 is lifted and entered again at " +
                                                place(lifted.points[0]) + ": that gains 12.5 %"));
  EXPECT_FALSE(Says(written.report.warnings, "pass 0 is lifted"));
}

TEST(WriteResults, FeedsThatFallAreToldSlowestFirstAndTheRestCounted) {
  Handed handed;
  handed.inputs.job.min_feed_share = 0.5;
  for (size_t i = 0; i < 10; ++i)  // ten below the least share, nine above it
    handed.reduction.slow.push_back({0, i, i, 4, true, 0.4 + 0.005 * static_cast<double>(i % 3), 1});
  for (size_t i = 20; i < 29; ++i) handed.reduction.slow.push_back({1, i, i + 1, 2, false, 0.6, 1});
  const Written written = Write(handed);
  const auto told = [](const std::vector<std::string>& sentences) {
    return std::ranges::count_if(sentences,
                                 [](const std::string& s) { return s.starts_with("the feed falls to "); });
  };
  EXPECT_EQ(told(written.report.findings), 8);
  EXPECT_EQ(told(written.report.warnings), 8);
  EXPECT_TRUE(
      Says({written.report.findings[0]},
           "the feed falls to 40 % (24.0 of 60.0 mm/min) at point 0 of pass 0: the acceleration of A5"));
  EXPECT_TRUE(Says({written.report.findings[0]}, "below 50 % (process.min_feed_share)"));
  EXPECT_TRUE(Says(written.report.findings, "the feed falls like this in 2 stretches more"));
  EXPECT_TRUE(Says(written.report.warnings, "at points 20 to 21 of pass 1: the speed of A3 allows no more"));
  EXPECT_TRUE(Says(written.report.warnings, "the feed falls like this in 1 stretches more"));
}

TEST(WriteResults, AFeedThatIsKeptAndCannotBeHeldIsAFinding) {
  Handed handed;
  for (PlannedPoint& point : handed.plan.passes[1].points) point.point.feed_rate = 2e4;
  handed.inputs.job.feed_policy = FeedPolicy::kReduce;
  EXPECT_FALSE(Says(Write(handed).report.findings, "cannot be held")) << "then it was reduced";
  handed.inputs.job.feed_policy = FeedPolicy::kKeep;
  EXPECT_TRUE(Says(Write(handed).report.findings, "the feed cannot be held at "));
}

}  // namespace
}  // namespace millpose::test
