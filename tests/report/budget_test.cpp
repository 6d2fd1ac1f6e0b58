// SPDX-License-Identifier: GPL-3.0-or-later
// The budget of the face's error, and what reports say of joints that turn back.
#include "report/budget.hpp"

#include <nlohmann/json.hpp>

#include "report/budget_json.hpp"
#include "report/lost_motion_json.hpp"
#include "report/points_table.hpp"
#include "report/report.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

constexpr double kArcmin = kRadPerDeg / 60;

/// A pass in which A3 turns back at its third point and A1 at its fourth.
PlanResult TurningPlan() {
  PlanResult plan;
  plan.arm = Kr500R2830();
  plan.X_FT.translation() << -250, 0, 250;
  PassResult pass;
  const double a1[] = {0, 0.5, 1, 1.5, 1, 0.5}, a3[] = {0, 1, 2, 1.5, 1, 0.5};
  for (int i = 0; i < 6; ++i) {
    PlannedPoint planned;
    planned.q = Degrees(a1[i], -80, 100 + a3[i], 10, 40, 0);
    planned.freedoms = {0};
    planned.point.position = plan.X_WB * ForwardFlange(plan.arm, planned.q) * plan.X_FT.translation();
    planned.point.normal = planned.point.tool_axis = Eigen::Vector3d(0.8, 0.6, 0);
    planned.point.feed = Eigen::Vector3d(0, 0, 1);
    planned.point.engagement = {Eigen::Vector3d(-10 + i, 30, 50), 6, 1, CutSide::kUp};
    pass.points.push_back(planned);
  }
  pass.pieces = {{0, 0, 0, 5, false}};
  plan.passes = {pass};
  return plan;
}

GearModel Stated(double arcmin) {
  GearModel model;
  model.lost.width.head<6>().setConstant(arcmin * kArcmin);
  std::fill_n(model.known.begin(), 6, true);
  return model;
}

const BudgetRow& RowOf(const Budget& budget, const std::string& key) {
  return *std::ranges::find(budget.rows, key, &BudgetRow::key);
}

TEST(Budget, HasTheLargestOfEverySourceThatIsStated) {
  const PlanResult plan = TurningPlan();
  const DeflectionReport deflection = PredictDeflections(plan, {}, {}, 0, {0.3, DegToRad(20)});
  const LostMotionReport lost = ReportLostMotion(plan, Stated(3), "measured", 0);
  const Budget budget = MakeBudget(&deflection, lost);
  double expected = 0, within = 0, error = 0;
  for (const DeflectedPoint& point : deflection.points) {
    expected = std::max(expected, std::abs(point.deflection.normal));
    within = std::max(within, point.largest_normal);
  }
  for (const auto& one : lost.course.errors) error = std::max(error, std::abs(one.value()));
  EXPECT_EQ(RowOf(budget, "static_compliance").largest, expected);
  EXPECT_DOUBLE_EQ(*RowOf(budget, "force_uncertainty").largest, within - expected);
  EXPECT_EQ(RowOf(budget, "lost_motion").largest, error);
  EXPECT_DOUBLE_EQ(budget.Sum(), expected + (within - expected) + error);
  EXPECT_EQ(budget.Largest().front()->key, "lost_motion");
  EXPECT_EQ(budget.LeftOut(),
            (std::vector<std::string>{"gear error", "geometry", "registration", "thermal", "dynamics"}));
  for (const BudgetRow& row : budget.rows) EXPECT_FALSE(row.basis.empty()) << row.key;
  const nlohmann::json json = nlohmann::json::parse(BudgetJson(budget).dump());
  EXPECT_EQ(json["rows"].size(), 8u);
  EXPECT_TRUE(json["rows"][3]["um"].is_null());
  EXPECT_NEAR(json["sum_um"].get<double>(), 1e3 * budget.Sum(), 1e-9);
}

TEST(Budget, PeriodicErrorOfTheGearsAddsUpByTheirLevers) {
  GearModel model = Stated(0.3);
  model.error.emplace();
  model.error->amplitude << 0, 0, 1e-4, 0, 0, 0;
  const PlanResult plan = TurningPlan();
  const LostMotionReport lost = ReportLostMotion(plan, model, "measured", 0);
  double largest = 0;
  for (const PlannedPoint& planned : plan.passes[0].points) {
    const Matrix6 J = Jacobian(plan.arm, planned.q, plan.X_FT.translation());
    const Eigen::Vector3d normal = plan.X_WB.linear().transpose() * planned.point.normal;
    largest = std::max(largest, 1e-4 * std::abs(normal.dot(J.col(2).head<3>())));
  }
  const Budget budget = MakeBudget(nullptr, lost);
  EXPECT_NEAR(RowOf(budget, "gear_error").largest.value(), largest, 1e-12);
  EXPECT_EQ(std::ranges::count(budget.LeftOut(), "gear error"), 0);
}

TEST(Budget, AMeasuredArmIsStated) {
  const LostMotionReport lost = ReportLostMotion(TurningPlan(), Stated(0.3), "measured", 0);
  const GeometryFigures geometry{0.2, 1.5, "A17", "2026-11-26"};
  const Budget budget = MakeBudget(nullptr, lost, nullptr, &geometry);
  EXPECT_EQ(RowOf(budget, "geometry").largest.value(), 0.2);
  EXPECT_NE(RowOf(budget, "geometry").basis.find("arm A17 as measured on 2026-11-26"), std::string::npos);
  EXPECT_NE(RowOf(budget, "geometry").basis.find("1500 µm"), std::string::npos);
  EXPECT_EQ(std::ranges::count(budget.LeftOut(), "geometry"), 0);
}

TEST(Budget, GearsTablesCountUntilTheyAreTakenOutAndThenWhatTheyLeaveDoes) {
  GearModel model = Stated(0.3);
  const LostMotionReport silent = ReportLostMotion(TurningPlan(), model, "measured", 0);
  model.error.emplace();
  model.error->amplitude << 0, 0, 1e-5, 0, 0, 0;
  const LostMotionReport lost = ReportLostMotion(TurningPlan(), model, "measured", 0);
  const double rest = *RowOf(MakeBudget(nullptr, lost), "gear_error").largest;
  GeometryFigures geometry{0.2, 1.5, "A17", "2026-11-26"};
  geometry.gears = 0.07;
  EXPECT_DOUBLE_EQ(*RowOf(MakeBudget(nullptr, lost, nullptr, &geometry), "gear_error").largest, 0.07 + rest);
  EXPECT_DOUBLE_EQ(*RowOf(MakeBudget(nullptr, silent, nullptr, &geometry), "gear_error").largest, 0.07);
  geometry.taken_out = true;
  geometry.gears = 0.004;  // between points
  EXPECT_DOUBLE_EQ(*RowOf(MakeBudget(nullptr, lost, nullptr, &geometry), "gear_error").largest, 0.004 + rest);
  const BudgetRow row = RowOf(MakeBudget(nullptr, silent, nullptr, &geometry), "gear_error");
  EXPECT_DOUBLE_EQ(*row.largest, 0.004);
  EXPECT_NE(row.basis.find("take out the tables of arm A17"), std::string::npos) << row.basis;
  EXPECT_NE(row.basis.find("what they leave nothing states"), std::string::npos) << row.basis;
}

TEST(Budget, ARegisteredPlaceIsStated) {
  const LostMotionReport lost = ReportLostMotion(TurningPlan(), Stated(0.3), "measured", 0);
  RegistrationFigures registration;
  registration.off_95 = 0.4;
  const Budget budget = MakeBudget(nullptr, lost, &registration);
  EXPECT_EQ(RowOf(budget, "registration").largest, 0.4);
  EXPECT_EQ(budget.Largest().front()->key, "registration");
  EXPECT_DOUBLE_EQ(budget.Sum(), 0.4 + *RowOf(budget, "lost_motion").largest);
  EXPECT_FALSE(RowOf(budget, "static_compliance").largest);
}

TEST(Budget, WhatNothingStatesIsLeftOutAndToldByWhatIsPublished) {
  const PlanResult plan = TurningPlan();
  const LostMotionReport lost = ReportLostMotion(plan, {}, "", 0);
  const Budget budget = MakeBudget(nullptr, lost);
  EXPECT_EQ(budget.LeftOut().size(), 8u);
  EXPECT_EQ(budget.Sum(), 0);
  EXPECT_TRUE(BudgetText(budget).starts_with("nothing is stated of the face's error"));
  // Half of 0.3 and of 0.6 arcmin in every joint, by the largest sum of levers.
  double levers = 0;
  for (const auto& one : lost.course.lever_sums) levers = std::max(levers, one.value());
  const std::string range =
      fmt::format("{:.0f} to {:.0f} µm here", 150 * kArcmin * levers, 300 * kArcmin * levers);
  EXPECT_NE(RowOf(budget, "lost_motion").basis.find(range), std::string::npos)
      << RowOf(budget, "lost_motion").basis << " / " << range;
}

TEST(LostMotionReport, CountsAndPlacesInSummaryAndTable) {
  const PlanResult plan = TurningPlan();
  const LostMotionReport lost = ReportLostMotion(plan, Stated(0.3), "measured", 0);
  const nlohmann::json json = nlohmann::json::parse(ReversalsJson(plan, lost).dump());
  EXPECT_EQ(json["counts"], nlohmann::json({1, 0, 1, 0, 0, 0}));
  EXPECT_EQ(json["total"], 2);
  EXPECT_EQ(json["passes"][0]["counts"], json["counts"]);
  ASSERT_EQ(json["places"].size(), 2u);
  EXPECT_EQ(json["places"][0]["point"], 2);
  EXPECT_EQ(json["places"][0]["joint"], "A3");
  EXPECT_EQ(json["places"][1]["point"], 3);
  EXPECT_EQ(json["places"][1]["joint"], "A1");
  EXPECT_NEAR(json["places"][0]["mark_um"].get<double>(),
              0.3 * json["places"][0]["um_per_arcmin"].get<double>(), 1e-9);
  const std::string text = LostMotionText(plan, lost);
  EXPECT_TRUE(text.starts_with("2 in cuts of the face (A1 1, A3 1); marks along the normal at most "))
      << text;
  EXPECT_TRUE(text.ends_with("lost motion: measured")) << text;

  const std::string csv = BytesOf([&](const ByteSink& sink) { WritePointsCsv(plan, {}, &lost, 1, sink); });
  const PointsTable table(csv, "points.csv");
  for (size_t row = 0; row < 6; ++row) {
    EXPECT_EQ(table.Number(row, "mark_a3_um").has_value(), row == 2) << row;
    EXPECT_EQ(table.Number(row, "mark_a1_um").has_value(), row == 3) << row;
    EXPECT_EQ(table.Text(row, "mark_a5_um"), "");
    EXPECT_EQ(*table.Number(row, "lost_motion_um"), 1e3 * *lost.course.errors[row]);
  }
  EXPECT_EQ(*table.Number(2, "mark_a3_um"), json["places"][0]["mark_um"].get<double>());
}

TEST(LostMotionReport, WithoutLostMotionMarksArePerArcmin) {
  const PlanResult plan = TurningPlan();
  const LostMotionReport lost = ReportLostMotion(plan, {}, "", 0),
                         one = ReportLostMotion(plan, Stated(1), "", 0);
  EXPECT_FALSE(lost.Known());
  const nlohmann::json json = nlohmann::json::parse(ReversalsJson(plan, lost).dump());
  EXPECT_TRUE(json["places"][0]["mark_um"].is_null());
  EXPECT_TRUE(json["largest_error_um"].is_null());
  EXPECT_EQ(json["marks_are_per_arcmin"], true);
  EXPECT_DOUBLE_EQ(lost.tally.sum, one.tally.sum);
  const std::string text = LostMotionText(plan, lost);
  EXPECT_TRUE(text.ends_with(
      "for each arcmin of lost motion, which the cell does not state (arm.lost_motion_arcmin)"))
      << text;
  const std::string csv = BytesOf([&](const ByteSink& sink) { WritePointsCsv(plan, {}, &lost, 1, sink); });
  const PointsTable table(csv, "points.csv");
  EXPECT_TRUE(table.Number(2, "mark_a3_um_per_arcmin"));
  EXPECT_EQ(table.Text(2, "lost_motion_um"), "");
}

}  // namespace
}  // namespace millpose
