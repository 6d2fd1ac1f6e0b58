// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl/krl_head.hpp"

#include <gtest/gtest.h>

#include "base/angles.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/krl/krl.hpp"
#include "program/scanner.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// The sample's program, whose head checks the controller's frame, for a robot that stands there in $WORLD.
struct Checked {
  PlanResult plan = SamplePlan();
  PostSettings settings = SampleSettings("krl");
  MotionProgram program = MakeMotionProgram(plan);
  KrlOptions options;

  explicit Checked(const Pose& X_KB = Pose::Identity()) {
    options.robroot = {X_KB.translation(), AnglesZyx(X_KB.linear())};
    program.frames_checked = true;
  }
  ProgramFiles Write() const { return KrlPost(options).Write(program, plan.arm, settings); }
  std::string Text() const { return Write().rbegin()->second; }
  MotionProgram Read(const std::string& text) const {
    return KrlPost(options).Read({{"Sample_wall_plan.src", text}}, plan.arm, settings);
  }
};

Pose Mounting(const Vector3d& place, double a, double b, double c) {
  Pose pose = Pose::Identity();
  pose.translation() = place;
  pose.linear() =
      (AngleAxisd(a * kRadPerDeg, Vector3d::UnitZ()) * AngleAxisd(b * kRadPerDeg, Vector3d::UnitY()) *
       AngleAxisd(c * kRadPerDeg, Vector3d::UnitX()))
          .toRotationMatrix();
  return pose;
}

TEST(KrlHead, StopsWhereTheControllersFrameIsAnother) {
  const std::string text = Checked(Mounting({100, 0, 1500}, 0, 0, 180)).Text();
  // The data before the first statement, the check before the first frame, tool and motion.
  EXPECT_LT(text.find("DECL FRAME MP_OFF"), text.find(";FOLD INI"));
  const size_t check = text.find(
      "MP_OFF = {FRAME: X 100,Y 0,Z 1500,A 0,B 0,C 180}\n"
      "MP_OFF = INV_POS(MP_OFF):$ROBROOT\n");
  ASSERT_NE(check, std::string::npos) << text.substr(0, 2500);
  EXPECT_LT(check, text.find("$BASE"));
  for (const char* part : {"IF (ABS(MP_OFF.X)>0.01) OR (ABS(MP_OFF.Y)>0.01) OR (ABS(MP_OFF.Z)>0.01) THEN",
                           "IF (ABS(MP_OFF.A)>0.001) OR (ABS(MP_OFF.B)>0.001) OR (ABS(MP_OFF.C)>0.001) THEN",
                           "SET_KRLMSG(#QUIT,", "LOOP\nHALT\nENDLOOP\nENDIF"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
    EXPECT_LT(text.find(part), text.find("PTP ")) << part;
  }
  for (const std::string_view line : SplitLines(text)) EXPECT_LE(line.size(), 100u) << line;
}

TEST(KrlHead, IsReadBackAndMissed) {
  const Checked checked;
  const std::string text = checked.Text();
  EXPECT_TRUE(checked.Read(text).frames_checked);
  EXPECT_EQ(KrlPost(checked.options).Write(checked.Read(text), checked.plan.arm, checked.settings),
            checked.Write());
  const size_t begin = text.find("MP_OFF = {"), end = text.rfind("ENDIF\n") + 6;
  std::string without = text;
  without.erase(begin, end - begin);
  EXPECT_FALSE(checked.Read(without).frames_checked);
  // Without the declarations it would not run; changed it is no check that is known.
  std::string undeclared = text;
  undeclared.erase(undeclared.find("DECL FRAME"),
                   undeclared.find(";FOLD INI") - undeclared.find("DECL FRAME"));
  EXPECT_THROW(checked.Read(undeclared), InputError);
  for (const auto& [from, to] : {std::pair{">0.01)", ">0.1)"},
                                 {"Z 0,A", "Z 5,A"},
                                 {"HALT\nENDLOOP", "ENDLOOP"},
                                 {"DECL INT MP_ID\n", ""}}) {
    std::string changed = text;
    changed.replace(changed.find(from), std::string(from).size(), to);
    EXPECT_THROW(checked.Read(changed), InputError) << from;
  }
}

TEST(KrlHead, TheBaseIsGivenInTheControllersWorld) {
  const Pose X_KB = Mounting({-300, 40, 2000}, 20, 90, 0);
  const Checked upright, hanging(X_KB);
  const std::string text = hanging.Text();
  const MotionProgram read = hanging.Read(text);
  EXPECT_LT((read.X_BP->matrix() - hanging.program.X_BP->matrix()).cwiseAbs().maxCoeff(), 1e-4);
  // The same text on a robot that stands at $WORLD is another place.
  const Pose stated = *upright
                           .Read([&] {
                             std::string other = text;
                             const std::string own = upright.Text();
                             const auto part = [](const std::string& all) {
                               return std::pair(all.find("MP_OFF = {"), all.find("MP_OFF = INV"));
                             };
                             const auto [a, b] = part(other);
                             const auto [c, d] = part(own);
                             return other.replace(a, b - a, own.substr(c, d - c));
                           }())
                           .X_BP;
  const Pose expected = X_KB * *hanging.program.X_BP;
  EXPECT_LT((stated.translation() - expected.translation()).norm(), 1e-3);
  EXPECT_LT(AngleAxisd(stated.linear().transpose() * expected.linear()).angle(), 1e-7);
}

TEST(KrlHead, ARailIsCheckedByItsRoot) {
  Checked checked;
  checked.options.ersysroot = KrlRail{{{0, 0, 600}, Vector3d::Zero()}, FrameAxis::kX};
  checked.settings.controller_axes = {{"E1", "", AxisKind::kLinear, 1500, true}};
  const std::string text = checked.Text();
  EXPECT_NE(text.find("Z 600,A 0,B 0,C 0}\nMP_OFF = INV_POS(MP_OFF):$ERSYSROOT"), std::string::npos);
  EXPECT_EQ(text.find(":$ROBROOT"), std::string::npos);
}

TEST(KrlHead, LoadIsWrittenAndExpected) {
  Checked checked;
  checked.settings.load = ToolLoad{182.5, {-30, 0, 140.25}, {9.5, 11, 4.25}};
  const std::string text = checked.Text();
  const std::string line = "$LOAD = {M 182.5,CM {X -30,Y 0,Z 140.25,A 0,B 0,C 0},J {X 9.5,Y 11,Z 4.25}}\n";
  ASSERT_NE(text.find(line), std::string::npos);
  EXPECT_NO_THROW(checked.Read(text));
  std::string lost = text;
  lost.erase(lost.find(line), line.size());
  EXPECT_THROW(checked.Read(lost), InputError);
  std::string heavier = text;
  heavier.replace(heavier.find("M 182"), 5, "M 192");
  EXPECT_THROW(checked.Read(heavier), InputError);
  std::string spaced = text;
  spaced.replace(spaced.find("{M 182.5,CM {X"), 14, "{ M 182.5 , CM { X");
  EXPECT_NO_THROW(checked.Read(spaced));
  // Where the cell says so, or the tool is one of the controller's own, its load data hold.
  checked.options.write_load = false;
  EXPECT_EQ(checked.Text().find("$LOAD"), std::string::npos);
  checked.options.write_load.reset();
  checked.options.tool_number = 7;
  EXPECT_EQ(checked.Text().find("$LOAD"), std::string::npos);
}

TEST(KrlHead, NumberedFramesMustBeTheCells) {
  Checked checked;
  checked.options.base_number = 3;
  checked.options.tool_number = 7;
  const std::string text = checked.Text();
  EXPECT_FALSE(checked.Read(text).X_BP);
  for (const auto& [from, to] :
       {std::pair{"#BASE,3", "#BASE,4"}, {"#TOOL,7", "#TOOL,17"}, {"BAS (#TOOL,7 )\n", ""}}) {
    std::string changed = text;
    changed.replace(changed.find(from), std::string(from).size(), to);
    EXPECT_THROW(checked.Read(changed), InputError) << from;
  }
  Checked values;
  std::string numbered = values.Text();
  numbered.insert(numbered.find("$BASE"), "BAS (#BASE,3 )\n");
  EXPECT_THROW(values.Read(numbered), InputError);
}

}  // namespace
}  // namespace millpose
