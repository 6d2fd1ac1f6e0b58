// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <sstream>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/program_time.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

TEST(ProgramTime, PartsAddUpAndFollowTheFeeds) {
  const PlanResult plan = SamplePlan();
  const MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
  const ProgramTime time = MeasureTime(program, plan.arm, {});
  double sum = 0;
  for (const TimeLaw& law : TimeMotions(program, plan.arm, {})) sum += law.duration;
  EXPECT_NEAR(time.all.Total(), sum, 1e-9);
  // Two lines of 20 mm, a ring of chords; three times 45 mm down, 5 mm in, 50 mm out.
  const double ring = 12 * 2 * 20 * std::sin(kPi / 12), feed = 80.0 / 60;
  EXPECT_NEAR(time.all.cuts, (40 + ring) / feed, 1e-6);
  EXPECT_NEAR(time.all.approaches, 3 * (45 * 60 / 1000.0 + 5 * 60 / 40.0 + 50 * 60 / 2000.0), 1e-6);
  EXPECT_GT(time.all.stops, 0);
  ASSERT_EQ(time.passes.size(), 3u);
  CycleTime passes;
  for (const CycleTime& pass : time.passes) passes += pass;
  EXPECT_NEAR(passes.cuts, time.all.cuts, 1e-9);
  EXPECT_NEAR(passes.approaches, time.all.approaches, 1e-9);
  EXPECT_NEAR(passes.stops, time.all.stops, 1e-9);
  // The way home belongs to no pass: it lasts as long as its joints need.
  std::vector<Joints> home = plan.gaps.back().joints;
  EXPECT_NEAR(time.all.gaps - passes.gaps, PathDuration(home, plan.arm.speed, plan.arm.acceleration), 1e-9);
}

TEST(ProgramTime, SlowerWaysAndTurningTakeLonger) {
  const PlanResult plan = SamplePlan();
  const MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
  const CycleTime full = MeasureTime(program, plan.arm, {}).all;
  const CycleTime slow = MeasureTime(program, plan.arm, {.way_speed_share = 0.3}).all;
  EXPECT_GT(slow.gaps, full.gaps);
  EXPECT_EQ(slow.cuts, full.cuts);
  const CycleTime stiff = MeasureTime(program, plan.arm, {.orientation_speed = 1e-4}).all;
  EXPECT_GT(stiff.cuts, 2 * full.cuts);
}

std::vector<std::vector<double>> Rows(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream stream(csv);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::istringstream cells(line + ",");
    std::vector<double>& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');)
      row.push_back(cell.empty() ? -1 : std::stod(cell));
  }
  return rows;
}

TEST(ProgramTime, TheTrajectoryIsWhereTheArmIs) {
  const PlanResult plan = SamplePlan();
  const MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
  const double total = MeasureTime(program, plan.arm, {}).all.Total();
  const std::string csv =
      TrajectoryCsv(program, plan.arm, plan.X_WB, {ExternalColumn{"e1_mm", {}, 500}}, {}, 0.02);
  EXPECT_TRUE(
      csv.starts_with("t_s,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,e1_mm,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,"
                      "speed_mm_s,pass,point\n"));
  const auto rows = Rows(csv);
  EXPECT_NEAR(rows.back()[0], total, 1e-4);
  EXPECT_GT(rows.size(), total / 0.02);
  const auto joints = [&](size_t i) {
    Joints q;
    for (int k = 0; k < 6; ++k) q[k] = rows[i][1 + k] * kRadPerDeg;
    return q;
  };
  const auto tip = [&](size_t i) { return Eigen::Vector3d(rows[i][8], rows[i][9], rows[i][10]); };
  size_t motion = 0;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Pose X_WT = plan.X_WB * ForwardFlange(plan.arm, joints(i)) * plan.X_FT;
    EXPECT_LT((X_WT.translation() - tip(i)).norm(), 1e-3) << i;
    EXPECT_EQ(rows[i][7], 500);
    while (motion < program.motions.size() && (joints(i) - *program.motions[motion].q).norm() < 1e-7)
      ++motion;
    if (i == 0) continue;
    const double step = rows[i][0] - rows[i - 1][0];
    EXPECT_GE(step, 0);
    EXPECT_LE(step, 0.0201);
    if (step < 0.005) continue;  // times have four decimals
    const Joints speed = (joints(i) - joints(i - 1)).cwiseAbs() / step;
    EXPECT_LE(speed.cwiseQuotient(plan.arm.speed).maxCoeff(), 1.02) << i;
    // The way of the tip is its speed over time.
    EXPECT_NEAR((tip(i) - tip(i - 1)).norm(), step * (rows[i][14] + rows[i - 1][14]) / 2,
                0.02 * (rows[i][14] + rows[i - 1][14]) + 2e-3)
        << i;
  }
  EXPECT_EQ(motion, program.motions.size()) << "every programmed point is there, in order";
}

TEST(ProgramTime, IsToldInHoursMinutesAndSeconds) {
  EXPECT_EQ(TimeText({3600, 61, 2, 0.6}),
            "1:01:04 (cuts 1:00:00, approaches 0:01:01, gaps 0:00:02, stops 0:00:01)");
}

}  // namespace
}  // namespace millpose
