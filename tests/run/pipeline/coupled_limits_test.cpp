// SPDX-License-Identifier: GPL-3.0-or-later
// Limits that couple axes: what a cell may say, and that a plan keeps them from the predicate to the program.
#include "job/assemble.hpp"
#include "job/config/config.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

const Joints kFold = (Joints() << 0, -1, 1, 0, 0, 0).finished();  // A3 − A2

double MostOf(const PlanResult& plan) {
  double most = -1e9;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      if (point.skip == Infeasibility::kNone) most = std::max(most, kFold.dot(point.q));
  for (const LinkMove& gap : plan.gaps)
    for (const Joints& q : gap.joints) most = std::max(most, kFold.dot(q));
  return most;
}

double MostOfPoints(PlanResult plan) {
  plan.gaps.clear();
  return MostOf(plan);
}

TEST(CoupledLimits, APlanKeepsThem) {
  // Home folds the arm most; above it nothing may be, and the points stay away by the margin.
  JobInputs inputs = SmallInputs();
  const double at_home = kFold.dot(inputs.cell.home), of_points = MostOfPoints(FreshPlan().plan);
  ASSERT_LT(of_points, at_home);
  // Mirrored, so that the points are what it binds: A2 − A3 ≤ …
  double least = 1e9;
  for (const PassResult& pass : FreshPlan().plan.passes)
    for (const PlannedPoint& point : pass.points) least = std::min(least, kFold.dot(point.q));
  const CoupledLimit limit{-kFold, -least - DegToRad(1)};
  inputs.cell.arm.coupled_limits = {limit};
  const double margin = inputs.job.limit_margin;
  size_t outside = 0;
  for (const PassResult& pass : FreshPlan().plan.passes)
    for (const PlannedPoint& point : pass.points) outside += limit.Beyond(point.q) > -margin;
  ASSERT_GT(outside, 0u) << "it binds";
  const PlannedJob job = PlanJob(inputs, NoCheckpoints(), {.threads = 2});
  for (const PassResult& pass : job.plan.passes)
    for (const PlannedPoint& point : pass.points) {
      ASSERT_EQ(point.skip, Infeasibility::kNone) << point.detail;
      EXPECT_LE(limit.Beyond(point.q), -margin + 1e-9);
    }
  for (const LinkMove& gap : job.plan.gaps)
    for (const Joints& q : gap.joints) EXPECT_LE(limit.Beyond(q), 1e-9);
  EXPECT_EQ(ParsePlanResult(Serialise(job.plan), "plan").arm.coupled_limits.size(), 1u);
}

TEST(CoupledLimits, ACellSaysThemOnceAndWithEffect) {
  const auto refusal = [](const std::string& limits) {
    const TestFolder folder("coupled");
    CopySmallJob(folder);
    folder.Change("cell.yaml", "  limits_source:", "  coupled_limits_deg: " + limits + "\n  limits_source:");
    std::map<std::string, std::string> bytes;
    return RefusalOf([&] { LoadCell(folder.path() / "cell.yaml", &bytes); });
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  EXPECT_EQ(refusal("[{a: [0, -1, 1, 0, 0, 0], at_most: 185}]"), "accepted");
  expect(refusal("[{a: [0, -1, 1, 0, 0, 0], at_most: 300}]"),
         "cell.yaml:12: arm.coupled_limits_deg[0]: has no effect: within limits_deg the sum is at most 274°");
  expect(refusal("[{a: [0, -1, 1, 0, 0, 0], at_most: -121}]"), "leaves nothing");
  expect(refusal("[{a: [0, -1, 1, 0, 0, 0], at_most: 67}]"),
         "home_deg is beyond it: −A2 + A3 = 180.000° is above 67.000°");
  expect(refusal("[{a: [0, 0, 1, 1, 0, 0], at_most: 67}]"), "axis 4 has limits of a revolution and more");
  expect(refusal("[{a: [0, 1, 1, 0, 0], at_most: 67}]"), "arm.coupled_limits_deg[0].a");
  expect(refusal("[{a: [0, 1, 1, 0, 0, 0]}]"), "at_most");
  expect(refusal("[{a: [0, 1, 1, 0, 0, 0], at_least: 3, at_most: 67}]"), "at_least");
}

TEST(CoupledLimits, AWrittenCellHoldsThem) {
  std::string text = ReadFile(SamplePath("cells/kr500_r2830.yaml"));
  const size_t at = text.find("  limits_source:");
  text.insert(at, "  coupled_limits_deg: [{a: [0, -1, 1, 0, 0, 0], at_most: 185.5}]\n");
  const CellSettings cell = ParseCell(WriteCell(ParseCell(text, "cell")), "written");
  ASSERT_EQ(cell.arm.coupled_limits.size(), 1u);
  EXPECT_EQ(cell.arm.coupled_limits[0].factors, kFold);
  EXPECT_NEAR(RadToDeg(cell.arm.coupled_limits[0].at_most), 185.5, 1e-12);
}

}  // namespace
}  // namespace millpose::test
