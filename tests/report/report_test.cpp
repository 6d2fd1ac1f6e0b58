// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/report.hpp"

#include <nlohmann/json.hpp>
#include <sstream>

#include "small_plan.hpp"

namespace millpose {
namespace {

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

// Whatever there is to tell: twelve lines, the rest counted.
TEST(BriefText, HasTwelveLinesAtMost) {
  const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  for (const size_t count : {0, 1, 3, 4, 5, 8, 60}) {
    ReportInputs inputs;
    for (size_t i = 0; i < count; ++i) {
      inputs.warnings.push_back(fmt::format("warned {}", i));
      inputs.findings.push_back(fmt::format("found {}", i));
    }
    const std::string text = BriefText(SmallPlan(), inputs, "out");
    EXPECT_LE(lines(text), 12) << text;
    EXPECT_TRUE(text.ends_with("report     out/report.html\n")) << text;
    EXPECT_EQ(text.starts_with("done "), count == 0 && text.find("INCOMPLETE") == std::string::npos) << text;
    EXPECT_EQ(text.find("finding    found 0") != std::string::npos, count > 0) << text;
    const std::string more = fmt::format("finding    {} more", count - 2);
    EXPECT_EQ(text.find(more) != std::string::npos, count > 3) << text;
  }
}

TEST(TellSome, CountsWhatThereIsNoRoomFor) {
  const std::vector<std::string> three{"a", "b", "c"};
  const auto told = [&](size_t room) {
    std::vector<std::string> lines;
    TellSome("skipped", three, room, lines, "operations");
    return fmt::format("{}", fmt::join(lines, "|"));
  };
  EXPECT_EQ(told(3), "skipped    a|skipped    b|skipped    c");
  EXPECT_EQ(told(2), "skipped    a|skipped    2 more: plan -v or report.html");
  EXPECT_EQ(told(1), "skipped    3 operations: plan -v or report.html");
  EXPECT_EQ(told(0), "");
}

TEST(Report, FiguresAreThoseOfThePlannedPoints) {
  const PlanFigures figures = Figures(SmallPlan());
  EXPECT_EQ(figures.total, 4u);
  EXPECT_EQ(figures.planned, 3u);
  EXPECT_EQ(figures.gaps_planned, 1u);
  EXPECT_EQ(figures.objective->best, 1);
  EXPECT_EQ(figures.objective->median, 2);
  EXPECT_EQ(figures.objective->worst, 3);
  EXPECT_DOUBLE_EQ(figures.price->ratio.interference, 1.5 * 3 / 3);
  EXPECT_NEAR(*figures.ga_nodes_share, 1.0 / 3, 1e-15);
  EXPECT_EQ(figures.clearance_min, 12);
}

TEST(Report, ThePriceIsRatiosOrMicrometres) {
  PlanResult plan = SmallPlan();
  const nlohmann::json ratios = nlohmann::json::parse(SummaryJson(plan, {}));
  EXPECT_EQ(ratios["schema_version"], 2);
  EXPECT_NEAR(ratios["price_of_continuity"]["ratio"]["total"].get<double>(), 2, 1e-12);
  EXPECT_TRUE(ratios["price_of_continuity"]["worst_um"].is_null());
  EXPECT_NE(
      SummaryText(plan, {}, {}).find("price      2.0000 times each point's own best pose = interference 1.5"),
      std::string::npos);
  plan.objective_unit = "mm";
  plan.passes[0].bound = {6, 5, 3, 2.5};
  const nlohmann::json lengths = nlohmann::json::parse(SummaryJson(plan, {}));
  EXPECT_TRUE(lengths["price_of_continuity"]["ratio"].is_null());
  EXPECT_NEAR(lengths["price_of_continuity"]["worst_um"]["total"].get<double>(), 2000, 1e-9);
  EXPECT_NEAR(lengths["price_of_continuity"]["mean_um"]["interference"].get<double>(), 500, 1e-9);
  EXPECT_NEAR(lengths["price_of_continuity"]["gap_percent"]["worst"].get<double>(), 20, 1e-9);
  EXPECT_NE(
      SummaryText(plan, {}, {}).find("better by more than 20.00 % in the worst value, 20.00 % in the sum"),
      std::string::npos)
      << SummaryText(plan, {}, {});
}

TEST(Report, NothingPlannedGivesNullsNotZeros) {
  PlanResult plan = SmallPlan();
  for (PlannedPoint& point : plan.passes[0].points) point.skip = Infeasibility::kUnreachable;
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
