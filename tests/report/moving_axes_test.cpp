// SPDX-License-Identifier: GPL-3.0-or-later
// Reports of a plan along whose pass a rail and a table move: every point is told as if the axes stood still
// where they are at that point.
#include <nlohmann/json.hpp>

#include "base/units.hpp"
#include "planning/result/station.hpp"
#include "report/deflection.hpp"
#include "report/html_data.hpp"
#include "report/step_heights.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/report/read_vtp.hpp"
#include "tests/report/small_plan.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr int kPoints = 5;

/// A pass with the table about a vertical axis and the rail at `positions`; on the part it is the same
/// wherever they are. One position for all points: they stand still.
PlanResult Plan(const std::vector<ExternalPosition>& positions) {
  PlanResult plan;
  plan.arm = Kr500R2830();
  plan.objective_unit = "mm/N";
  plan.X_FT.translation() << -250, 0, 250;
  plan.X_WP.translation() << 1800, 40, 900;
  plan.external_axes = {{.name = "rail", .direction = Vector3d::UnitY(), .compliance = 1e-5},
                        {.name = "table",
                         .kind = AxisKind::kRotary,
                         .carries = Carries::kWorkpiece,
                         .direction = Vector3d::UnitZ(),
                         .origin = Vector3d(1700, 0, 0),
                         .compliance = 2e-11}};
  PassResult pass;
  pass.external = positions.front();
  for (int i = 0; i < kPoints; ++i) {
    PlannedPoint planned;
    const ExternalPosition& external =
        positions[std::min<size_t>(static_cast<size_t>(i), positions.size() - 1)];
    const Pose X_WP = PartAt(plan, external);
    planned.q = Degrees(3 * i, -80, 100, 10, 40, 0);
    planned.freedoms = {0.5};
    planned.point.position = X_WP * Vector3d(8 * i, 2, 0);
    planned.point.normal = planned.point.tool_axis = X_WP.linear() * Vector3d(-1, 0, 0);
    planned.point.feed = X_WP.linear() * Vector3d(0, 1, 0);
    planned.point.engagement = {X_WP.linear() * Vector3d(-10, 30, 50), 6, 1, CutSide::kUp};
    planned.point.arc_length = 8 * i;
    if (positions.size() > 1) planned.external = external;
    pass.points.push_back(planned);
  }
  pass.pieces = {{0, 0, 0, kPoints - 1, false}};
  plan.passes = {pass};
  return plan;
}

std::vector<ExternalPosition> Moving() {
  std::vector<ExternalPosition> positions;
  for (int i = 0; i < kPoints; ++i) positions.push_back({100 + 50.0 * i, DegToRad(10.0 * i)});
  return positions;
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  for (size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    lines.push_back(text.substr(at, end - at));
  return lines;
}

TEST(MovingAxes, EveryRowIsThatOfAxesThatStandStillThere) {
  const std::vector<ExternalPosition> positions = Moving();
  const PlanResult plan = Plan(positions);
  const std::vector<std::string> csv = Lines(PointsCsv(plan));
  const DeflectionReport deflections = PredictDeflections(plan, {}, {});
  ASSERT_EQ(deflections.points.size(), size_t{kPoints});
  for (size_t i = 0; i < kPoints; ++i) {
    const PlanResult standing = Plan({positions[i]});
    EXPECT_EQ(csv[i + 1], Lines(PointsCsv(standing))[i + 1]);
    EXPECT_TRUE(csv[i + 1].ends_with(
        fmt::format(",{:.17g},{:.17g}", 100 + 50.0 * static_cast<double>(i), RadToDeg(positions[i][1]))))
        << csv[i + 1];
    const DeflectedPoint still = PredictDeflections(standing, {}, {}).points[i];
    EXPECT_EQ(deflections.points[i].deflection.normal, still.deflection.normal);
    EXPECT_EQ(deflections.points[i].moved, still.moved);
    EXPECT_EQ(deflections.points[i].force, still.force);
  }
  // The table's give counts with where it is: not all points are alike.
  EXPECT_NE(deflections.points[4].deflection.normal,
            PredictDeflections(Plan({positions[0]}), {}, {}).points[4].deflection.normal);
}

TEST(MovingAxes, ThePathOnThePartIsThatOfAxesAtZero) {
  const PlanResult moving = Plan(Moving()), still = Plan({{0, 0}});
  for (int i = 0; i < kPoints; ++i) {
    const auto& point = moving.passes[0].points[static_cast<size_t>(i)];
    const Vector3d place =
        OnPartAtZero(moving, ExternalAt(moving.passes[0], static_cast<size_t>(i)), point.point.position);
    EXPECT_LT((place - still.passes[0].points[static_cast<size_t>(i)].point.position).norm(), 1e-9);
  }
  const auto numbers = [](const PlanResult& plan) {
    return test::ReadVtp(PathVtp(plan)).values.at("Points/position_mm");
  };
  const std::vector<double> along = numbers(moving), at_zero = numbers(still);
  ASSERT_EQ(along.size(), size_t{3} * kPoints);
  for (size_t i = 0; i < along.size(); ++i) EXPECT_NEAR(along[i], at_zero[i], 1e-9);
}

TEST(MovingAxes, TheSummarySaysFromWhereToWhere) {
  const auto external = [](const PlanResult& plan) {
    return nlohmann::json::parse(SummaryJson(plan, {})).at("external");
  };
  const nlohmann::json told = external(Plan(Moving())), still = external(Plan({{100, 0}}));
  ASSERT_EQ(told.at("along").size(), 1u);
  EXPECT_EQ(told["along"][0]["pass"], 0);
  EXPECT_EQ(told["along"][0]["from"], (std::vector<double>{100, 0}));
  EXPECT_EQ(told["along"][0]["to"][0], 300);
  EXPECT_NEAR(told["along"][0]["to"][1].get<double>(), 40, 1e-12);
  EXPECT_EQ(told["passes"], still["passes"]);
  EXPECT_FALSE(still.contains("along")) << "what stands still is told as ever";
}

TEST(MovingAxes, NeighboursAreThoseOnThePart) {
  // A second pass beside the first, milled with the table turned: far from it in the world.
  PlanResult plan = Plan({{0, 0}});
  PlanResult beside = Plan({{0, DegToRad(90)}});
  PassResult second = beside.passes[0];
  second.pass = 1;
  for (PlannedPoint& point : second.points) {
    point.freedoms = {1.0};
    point.piece = 0;
  }
  second.pieces[0].pass = 1;
  plan.passes.push_back(second);
  const ToolUncertainty tool{.tip = 0.1, .axis = 0, .radius = 10};
  ASSERT_TRUE(FindPoseSteps(plan, tool, 0).neighbours);
  EXPECT_NEAR(FindPoseSteps(plan, tool, 0).neighbours->rotation, 0.5, 1e-12);
}

}  // namespace
}  // namespace millpose
