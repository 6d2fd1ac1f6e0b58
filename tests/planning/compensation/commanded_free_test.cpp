// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/commanded_free.hpp"

#include <gtest/gtest.h>

#include "tests/planning/compensation/forced_plan.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

constexpr double kJustFree = 10.6;  // mm: the cell asks for 10

/// The sample's cell with a long bar above the cutter, `height` (mm) over the first pass.
Cell WithBar(const PlanResult& plan, double height) {
  Cell cell = SampleCell(plan);
  Body bar;
  bar.name = "bar";
  bar.body_class = BodyClass::kFixture;
  bar.shape = Box{Eigen::Vector3d(30, 400, 4)};
  bar.X_MG.translation() = plan.passes[0].points[0].point.position + Eigen::Vector3d(-40, 0, height);
  cell.bodies.push_back(bar);
  return cell;
}

double ClearanceUnder(const PlanResult& plan, double height) {
  const World world(WithBar(plan, height));
  Checker checker(world);
  double least = 50;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points)
      least = std::min(least, checker.Clearance(point.q, Phase::kCutting, 50));
  return least;
}

TEST(CommandedFree, APieceThatItsShiftsBringTooNearRunsAtItsNominalPoses) {
  PlanResult plan = Forced();
  CompensationOptions options;
  options.most = 2;
  options.weight = [&](const Joints&) -> Eigen::Vector3d {
    return plan.X_WB.linear().transpose() * Eigen::Vector3d(0, 0, -1.9);
  };
  Compensate(options, ForcesOf(plan), plan);  // lifts the tip by 1.9 mm
  double low = 20, high = 600;
  ASSERT_LT(ClearanceUnder(plan, low), kJustFree);
  ASSERT_GT(ClearanceUnder(plan, high), kJustFree);
  while (high - low > 0.01) {
    const double middle = (low + high) / 2;
    (ClearanceUnder(plan, middle) < kJustFree ? low : high) = middle;
  }
  struct Silent final : Progress {
    void Begin(std::string_view, size_t) override {}
    void Advance(size_t) override {}
    void End(std::string_view) override {}
  } progress;
  const Execution execution{1, progress, {}};
  PlanResult far = plan, near = plan;
  EXPECT_TRUE(
      KeepCommandedFree(Stations(World(WithBar(plan, high + 10)), {}), {}, 0.5, execution, far).empty());
  EXPECT_EQ(Serialise(far), Serialise(plan));
  const std::vector<std::string> told =
      KeepCommandedFree(Stations(World(WithBar(plan, high)), {}), {}, 0.5, execution, near);
  ASSERT_FALSE(told.empty());
  EXPECT_NE(told[0].find("is not compensated"), std::string::npos) << told[0];
  EXPECT_NE(told[0].find("bar"), std::string::npos) << told[0];
  size_t nominal = 0;
  for (const PassResult& pass : near.passes) nominal += pass.points[1].compensation->q == pass.points[1].q;
  EXPECT_EQ(nominal, told.size());
  EXPECT_LT(nominal, near.passes.size());
}

}  // namespace
}  // namespace millpose
