// SPDX-License-Identifier: GPL-3.0-or-later
// What stands of a job's raw part, and what hangs on the tool.
#include <nlohmann/json.hpp>

#include "job/assemble.hpp"
#include "planning/standing/leave_in_stock.hpp"
#include "run/pipeline/operations/check_job.hpp"
#include "run/pipeline/operations/run_job.hpp"
#include "run/pipeline/outputs/report_parts.hpp"
#include "run/pipeline/programs/plan_timeline.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

/// The pad is 80 × 80 mm, its face at z = 0; the cutter is 20 mm wide and cuts with 40 of its 60 mm, above
/// which the holder is 63 mm wide.
PlannedJob PlanWith(const std::string& stock, std::vector<Override> more = {}) {
  more.emplace_back("workpiece.stock", stock);
  return PlanJob(SmallInputs(std::move(more)), NoCheckpoints(), {.threads = 2});
}

std::string StockBoxStl(double top, double half = 60) {
  return fmt::format("{{box: {{lower_mm: [{0}, {0}, -20], upper_mm: [{1}, {1}, {2}]}}}}", -half, half, top);
}

size_t CountOf(const PlanResult& plan, Infeasibility why) {
  size_t count = 0;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) count += point.skip == why;
  return count;
}

// Two passes 40 mm apart along the whole pad: two slots 20 mm wide, 3 mm deep, each with half a disc at its
// ends.
TEST(StockOfAJob, IsMilledAway) {
  const PlannedJob job = PlanWith(StockBoxStl(3));
  EXPECT_EQ(CountOf(job.plan, Infeasibility::kStock), 0u);
  ASSERT_TRUE(job.stock);
  EXPECT_NEAR(job.stock->blank, 120 * 120 * 23, 0.01 * 120 * 120 * 23);
  const double slots = 2 * 3 * (80 * 20 + kPi * 100);
  EXPECT_NEAR(job.stock->removed, slots, 0.01 * slots);
  EXPECT_EQ(job.stock->left_out, 0);
  EXPECT_FALSE(job.programs.programs.empty());
}

// What report.html plays ends with what the summary tells, and every moment of it lies within the run.
TEST(StockOfAJob, IsWatchedWhileItGoes) {
  const std::vector<Override> more{{"workpiece.stock", StockBoxStl(3)}};
  const JobInputs inputs = SmallInputs(more);
  const PlannedJob job = PlanJob(inputs, NoCheckpoints(), {.threads = 2});
  const Timeline timeline = PlanTimeline(job.plan, inputs);
  const auto removal = RemovalOf(inputs, job, timeline, {.threads = 2});
  ASSERT_TRUE(removal);
  EXPECT_NEAR(removal->volume - removal->frames.back().volume, job.stock->removed, 0.02 * job.stock->removed);
  double time = 0, volume = removal->volume;
  for (const Removal::Frame& frame : removal->frames) {
    EXPECT_GE(frame.time, time);
    EXPECT_LE(frame.volume, volume);
    time = frame.time, volume = frame.volume;
  }
  EXPECT_LT(time, timeline.back().time);  // the way home cuts nothing
  const auto first_cut = std::ranges::find(timeline, RunPart::kCut, &RunInstant::stretch);
  EXPECT_GE(removal->frames.front().time, std::prev(first_cut)->time);
  EXPECT_FALSE(RemovalOf(SmallInputs({}), job, timeline, {}));
  // What operations before have taken off is not there from the beginning.
  JobInputs later = inputs;
  later.cut_before = {CutsOf(job.plan, MakeCutterShape(inputs.cell.tool))};
  const auto nothing_left = RemovalOf(later, job, timeline, {.threads = 2});
  ASSERT_TRUE(nothing_left);
  EXPECT_NEAR(nothing_left->volume, removal->frames.back().volume, 1e-6 * removal->volume);
  EXPECT_NEAR(nothing_left->frames.back().volume, nothing_left->volume, 1e-6 * removal->volume);
}

// 75 mm over the face: the holder would go down into it with the first point.
TEST(StockOfAJob, NothingIsMilledWhereTheHolderWouldMeetIt) {
  const PlannedJob job = PlanWith(StockBoxStl(75));
  EXPECT_EQ(CountOf(job.plan, Infeasibility::kStock), 6u);
  EXPECT_EQ(job.stock->removed, 0);
  EXPECT_EQ(job.stock->left_out, 2);
  EXPECT_TRUE(job.programs.programs.empty());
  const std::string& why = job.plan.passes.front().points.front().detail;
  EXPECT_NE(why.find("would meet material that still stands"), std::string::npos) << why;
}

// Between the cutting length, 40 mm, and the holder the shank would rub; below it nothing is met.
TEST(StockOfAJob, TheShankCutsNothing) {
  EXPECT_EQ(PlanWith(StockBoxStl(39)).stock->left_out, 0);
  const PlannedJob deep = PlanWith(StockBoxStl(50));
  EXPECT_EQ(deep.stock->left_out, 2);
  const std::string& why = deep.plan.passes.front().points.front().detail;
  EXPECT_EQ(why.find("cutter's shank"), 0u) << why;
}

// What a layer has taken off is gone for the next: 50 mm in two layers.
TEST(StockOfAJob, LayersMakeRoomForTheNext) {
  const std::vector<Override> layers{{"toolpath.depth", "{total_mm: 50, per_layer_mm: 25}"},
                                     {"toolpath.stepover_mm", "8"},
                                     {"process.cutting", "{material: 5A06, teeth: 4}"}};
  const PlannedJob job = PlanWith(StockBoxStl(50, 39), layers);
  EXPECT_EQ(CountOf(job.plan, Infeasibility::kStock), 0u) << job.plan.passes.back().points.front().detail;
  EXPECT_NEAR(job.stock->removed, 78 * 78 * 50, 0.02 * 78 * 78 * 50);
}

TEST(StockOfAJob, ACylinderIsOneToo) {
  const PlannedJob job = PlanWith("{cylinder: {centre_mm: [0, 0, -20], radius_mm: 50, length_mm: 23}}");
  EXPECT_NEAR(job.stock->blank, kPi * 2500 * 23, 0.01 * kPi * 2500 * 23);
}

/// The pad under 75 mm of stock, in the given operations: depth of all their layers, of one, and what is
/// left.
std::string JobOf(const std::vector<std::array<double, 3>>& operations) {
  std::string text = fmt::format(R"(millpose_job: 1
name: stock
cell: {0}/cells/kr500_r2830.yaml
workpiece:
  mesh: {0}/toolpaths/support_pad/support_pad.stl
  unit: mm
  frame: robot_base
  pose: {{xyz_mm: [2076, 0, 1006], abc_deg: [0, -90, 0]}}
  stock: {{box: {{lower_mm: [-39, -39, -20], upper_mm: [39, 39, 75]}}, resolution_mm: 1}}
process: {{feed_mm_min: 80, spindle_rpm: 7000, cutting: {{material: 5A06, teeth: 4}}, stock: mesh}}
pose: {{objective: {{name: surface_error}}}}
programs: []
operations:
)",
                                 SourceDir());
  for (const auto& [total, per_layer, allowance] : operations)
    text += fmt::format(R"(  - name: deep_{}
    toolpath:
      strategy: parallel_planes
      region: {{facing: {{direction: [0, 0, 1], within_deg: 1}}}}
      planes: {{normal: [0, 1, 0]}}
      stepover_mm: 8
      spacing_mm: 40
      chord_tolerance_mm: 0.01
      rotation_reference: [0, 0, 1]
      depth: {{total_mm: {}, per_layer_mm: {}, allowance_mm: {}}}
)",
                        allowance, total, per_layer, allowance);
  return text;
}

// What operations before have taken off is gone for the next, for its holder and its forces; without them the
// holder would be in it.
TEST(StockOfAJob, OperationsHandItOn) {
  const TestFolder home("stock_operations");
  const auto plan = [&](const std::vector<std::array<double, 3>>& operations) {
    home.Write("job.yaml", JobOf(operations));
    PlanArguments arguments;
    arguments.job = home.path() / "job.yaml";
    arguments.out = home.path() / "out";
    arguments.threads = 2;
    return RunJob(arguments, Silent(), {});
  };
  const auto summary = [&](const std::string& folder) {
    return nlohmann::json::parse(home.Read("out/operations/" + folder + "/summary.json"));
  };
  EXPECT_EQ(plan({{73, 36.5, 2}, {2, 2, 0}}).exit_status, 0);
  const auto rough = summary("01_deep_2"), finish = summary("02_deep_0");
  EXPECT_NEAR(rough["stock"]["removed_cm3"], 78 * 78 * 73 / 1e3, 0.02 * 444);
  EXPECT_NEAR(finish["stock"]["blank_cm3"], 78 * 78 * 22 / 1e3, 0.02 * 134);
  EXPECT_NEAR(finish["stock"]["removed_cm3"], 78 * 78 * 2 / 1e3, 0.02 * 12);
  // 2 mm deep, not 40.
  EXPECT_LT(finish["deflection"]["peak_force_N"], 0.2 * rough["deflection"]["peak_force_N"].get<double>());

  EXPECT_EQ(plan({{73, 36.5, 2}, {2, 2, 0}}).text.find("nothing was planned again") == std::string::npos,
            false);
  // Less taken off before: the second is planned anew, and is in what still stands.
  EXPECT_EQ(plan({{10, 5, 65}, {2, 2, 0}}).exit_status, 1);
  EXPECT_EQ(summary("02_deep_0")["stock"]["pieces_left_out"], 10);
}

/// 20 mm over the whole pad, roughed down to these heights, one operation each.
std::string RoughJobOf(const std::vector<double>& bottoms) {
  std::string text = fmt::format(R"(millpose_job: 1
name: rough
cell: {0}/cells/kr500_r2830.yaml
workpiece:
  mesh: {0}/toolpaths/support_pad/support_pad.stl
  unit: mm
  frame: robot_base
  pose: {{xyz_mm: [2076, 0, 1006], abc_deg: [0, -90, 0]}}
  stock: {{box: {{lower_mm: [-40, -40, -20], upper_mm: [40, 40, 20]}}, resolution_mm: 1}}
process: {{feed_mm_min: 800, spindle_rpm: 7000}}
programs: []
operations:
)",
                                 SourceDir());
  for (const double bottom : bottoms)
    text += fmt::format(R"(  - name: down_to_{1}
    toolpath:
      strategy: rough
      tool_axis: {{rule: fixed, direction: [0, 0, 1]}}
      rough: {{allowance_mm: 0.5, per_layer_mm: 10, bottom_mm: {0}}}
      spacing_mm: 80
      rotation_reference: [0, 0, 1]
)",
                        bottom, std::floor(bottom));
  return text;
}

// Roughing begins where the operation before has ended: nothing of the layers above is laid again.
TEST(StockOfAJob, IsRoughedFromWhereItStands) {
  const TestFolder home("rough_operations");
  const auto plan = [&](const std::vector<double>& bottoms) {
    home.Write("job.yaml", RoughJobOf(bottoms));
    PlanArguments arguments;
    arguments.job = home.path() / "job.yaml";
    arguments.out = home.path() / fmt::format("out{}", bottoms.size());
    arguments.threads = 2;
    const auto ran = RunJob(arguments, Silent(), {});
    EXPECT_EQ(ran.exit_status, 0) << ran.text;
  };
  const auto summary = [&](const std::string& folder) {
    return nlohmann::json::parse(home.Read(folder + "/summary.json"));
  };
  plan({10, 0.5});
  const auto first = summary("out2/operations/01_down_to_10");
  const auto second = summary("out2/operations/02_down_to_0");
  EXPECT_NEAR(first["stock"]["removed_cm3"], 80 * 80 * 10 / 1e3, 0.02 * 64);
  EXPECT_NEAR(second["stock"]["blank_cm3"], 80 * 80 * 30 / 1e3, 0.02 * 192);
  EXPECT_NEAR(second["stock"]["removed_cm3"], 80 * 80 * 9.5 / 1e3, 0.02 * 61);
  EXPECT_EQ(first["stock"]["pieces_left_out"], 0);
  EXPECT_EQ(second["stock"]["pieces_left_out"], 0);
  EXPECT_NEAR(second["points"]["total"], first["points"]["total"].get<double>(), 3);
  // A check lays the same paths: the material goes from one operation to the next there too.
  const std::vector<JobCheck> checks =
      CheckOperations(home.path() / "job.yaml", {.threads = 2}, {}, Silent(), {});
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0].points, first["points"]["total"]);
  EXPECT_EQ(checks[1].points, second["points"]["total"]);
}

TEST(StockOfAJob, IsRefusedByItsKey) {
  const auto refused = [](const std::string& stock) {
    return RefusalOf([&] { SmallInputs({{"workpiece.stock", stock}}); });
  };
  EXPECT_NE(refused("{resolution_mm: 1}").find("give one of mesh, box and cylinder"), std::string::npos);
  EXPECT_NE(refused("{box: {lower_mm: [0, 0, 0], upper_mm: [1, 0, 1]}}").find("is empty"), std::string::npos);
  EXPECT_NE(refused("{unit: mm, box: {lower_mm: [0, 0, 0], upper_mm: [1, 1, 1]}}")
                .find("has no effect without mesh"),
            std::string::npos);
}

}  // namespace
}  // namespace millpose::test
