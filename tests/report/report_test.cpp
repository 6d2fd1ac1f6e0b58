// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/report.hpp"

#include <nlohmann/json.hpp>
#include <sstream>

namespace millpose {
namespace {

// Three planned points and a skipped one with the plainest numbers.
PlanResult SmallPlan() {
  PlanResult plan;
  plan.job = "small";
  plan.objective_unit = "mm/N";
  PassResult pass;
  for (int i = 0; i < 4; ++i) {
    PlannedPoint point;
    point.point.position = Eigen::Vector3d(i, 0, 0);
    point.point.normal = point.point.tool_axis = Eigen::Vector3d::UnitZ();
    point.point.feed = Eigen::Vector3d::UnitX();
    point.freedoms = {0.5};
    point.objective = i + 1;
    point.exhaustive_optimum = 1;
    point.indices.lambda_n = 1.0 / (i + 1);
    point.from_genetic = i == 0;
    point.clearance = 40 - i;
    pass.points.push_back(point);
  }
  pass.points[3].skip = SkipReason::kLimit;
  pass.points[3].detail = "A5 beyond 117 deg";
  pass.pieces = {{0, 0, 0, 2, false}};
  plan.passes = {pass};
  Gap gap;
  gap.planned = true;
  gap.clearance = 12;
  Gap blocked;
  blocked.detail = "link3 against platform";
  plan.gaps = {gap, blocked};
  return plan;
}

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

TEST(Report, FiguresAreThoseOfThePlannedPoints) {
  const PlanFigures figures = Figures(SmallPlan());
  EXPECT_EQ(figures.total, 4u);
  EXPECT_EQ(figures.planned, 3u);
  EXPECT_EQ(figures.gaps_planned, 1u);
  EXPECT_EQ(figures.objective->best, 1);
  EXPECT_EQ(figures.objective->median, 2);
  EXPECT_EQ(figures.objective->worst, 3);
  EXPECT_EQ(figures.price_of_continuity, 2);
  EXPECT_NEAR(*figures.ga_nodes_share, 1.0 / 3, 1e-15);
  EXPECT_EQ(figures.clearance_min, 12);
}

TEST(Report, NothingPlannedGivesNullsNotZeros) {
  PlanResult plan = SmallPlan();
  for (PlannedPoint& point : plan.passes[0].points) point.skip = SkipReason::kUnreachable;
  const nlohmann::json json = nlohmann::json::parse(SummaryJson(plan, {}));
  EXPECT_TRUE(json["price_of_continuity"].is_null());
  EXPECT_TRUE(json["clearance_min_mm"].is_null());
  EXPECT_TRUE(json["stiffness"]["lambda_n"]["worst"].is_null());
  EXPECT_TRUE(json["audit"].is_null());
}

TEST(Report, EveryRowHasEveryColumnAndSkippedOnesAreEmpty) {
  std::istringstream csv(PointsCsv(SmallPlan()));
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  const std::vector<std::string> header = Cells(line);
  std::vector<std::vector<std::string>> rows;
  while (std::getline(csv, line)) rows.push_back(Cells(line));
  ASSERT_EQ(rows.size(), 4u);
  for (const auto& row : rows) EXPECT_EQ(row.size(), header.size());
  const auto column = [&](const std::string& name) {
    return static_cast<size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  EXPECT_EQ(rows[2][column("x_mm")], "2");
  EXPECT_EQ(rows[2][column("objective")], "3");
  EXPECT_EQ(rows[2][column("fx")], "1");
  EXPECT_EQ(rows[3][column("a1_deg")], "");
  EXPECT_EQ(rows[3][column("clearance_mm")], "");
  EXPECT_EQ(rows[3][column("fx")], "1");
  EXPECT_EQ(rows[3][column("reason")], "limit");
}

TEST(Report, TextNamesWhatWentWrong) {
  ReportInputs inputs;
  inputs.findings = {"krl small.src:12: tip 0.05 mm off"};
  const std::string text = SummaryText(SmallPlan(), inputs, {});
  for (const char* part : {"3 planned of 4", "A5 beyond 117 deg", "link3 against platform", "small.src:12"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace millpose
