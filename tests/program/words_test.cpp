// SPDX-License-Identifier: GPL-3.0-or-later
// Single words of programs whose mistakes a symmetric example would hide.
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

std::string MainText(const std::string& controller, const MotionProgram& program,
                     const PostSettings& settings) {
  return MakePost(controller)->Write(program, SampleArm(), settings).rbegin()->second;
}

TEST(Words, BitsOfStatusAndTurnStandInTheirOrder) {
  MotionProgram program = MakeMotionProgram(SamplePlan());
  for (Motion& motion : program.motions) {
    if (!motion.status) continue;
    motion.q.reset();  // as read: nothing is reckoned anew
    motion.status = 1;
    motion.turn = 2;
  }
  EXPECT_NE(MainText("sinumerik", program, SampleSettings("sinumerik")).find("STAT='B001' TU='B000010'"),
            std::string::npos);
  EXPECT_NE(MainText("krl", program, SampleSettings("krl")).find("S 'B001',T 'B000010'"), std::string::npos);
}

TEST(Words, OutputsKeepTheSignOfTheirDelay) {
  MotionOptions options;
  options.outputs = {{3, true, 0.02, true}, {3, false, -0.03, false}};
  const std::string text = MainText("krl", MakeMotionProgram(SamplePlan(), options), SampleSettings("krl"));
  EXPECT_NE(text.find("DELAY=20 DO $OUT[3]=TRUE"), std::string::npos);
  EXPECT_NE(text.find("DELAY=-30 DO $OUT[3]=FALSE"), std::string::npos);
}

TEST(Words, CoolantGoesOnAfterTheSpindleAndOffBefore) {
  PostSettings settings = SampleSettings("sinumerik");
  settings.texts = {
      {"spindle_on", "S{rpm} M3"}, {"spindle_off", "M5"}, {"coolant_on", "M8"}, {"coolant_off", "M9"}};
  const std::string text = MainText("sinumerik", MakeMotionProgram(SamplePlan()), settings);
  EXPECT_NE(text.find(" M3\nM8\n"), std::string::npos);
  EXPECT_NE(text.find("\nM9\nM5\n"), std::string::npos);
}

TEST(Words, AnglesThatRunEvenlyGoOnBeyondHalfATurn) {
  const Eigen::Vector3d near = Eigen::Vector3d(10, 20, 179) * kRadPerDeg;
  const Eigen::Matrix3d R = FromToolAngles(AngleOrder::kRpy, Eigen::Vector3d(10, 20, -179) * kRadPerDeg);
  const Eigen::Vector3d found = ToolAnglesNear(AngleOrder::kRpy, R, near) * kDegPerRad;
  EXPECT_LT((found - Eigen::Vector3d(10, 20, 181)).norm(), 1e-9);
}

}  // namespace
}  // namespace millpose
