// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/verify.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "tests/verify/sample_cell.hpp"

namespace millpose {
namespace {

std::string Text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings)
    text += fmt::format("{}:{}: {}\n", finding.file, finding.line, finding.message);
  return text;
}

class VerifyPost : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Post> post = MakePost(GetParam());
  PostSettings settings = SampleSettings(GetParam());
  PlanResult plan = SamplePlan();
  MotionProgram program = MakeMotionProgram(plan);
  World world{SampleCell(plan)};
  VerifyOptions options = SampleOptions(plan);

  MotionProgram WrittenAndRead() const {
    return post->Read(post->Write(program, plan.arm, settings), plan.arm, settings);
  }
};
INSTANTIATE_TEST_SUITE_P(Controllers, VerifyPost, testing::Values("krl", "sinumerik", "linuxcnc"),
                         [](const auto& controller) { return controller.param; });

TEST_P(VerifyPost, ConfirmsWhatWasWritten) {
  options.interference = true;
  EXPECT_EQ(Text(Verify(WrittenAndRead(), world, &program, options, 2, {})), "");
}

TEST_P(VerifyPost, ConfirmsWithoutAPlan) {
  EXPECT_EQ(Text(Verify(WrittenAndRead(), world, nullptr, options, 2, {})), "");
}

TEST_P(VerifyPost, SameForAnyNumberOfThreads) {
  MotionProgram read = WrittenAndRead();
  for (size_t i = 6; i < read.motions.size(); i += 3)
    read.motions[i].feed *= 3, read.motions[i].duration /= 3;
  const std::string one = Text(Verify(read, world, &program, options, 1, {}));
  EXPECT_NE(one, "");
  EXPECT_EQ(one, Text(Verify(read, world, &program, options, 4, {})));
}

TEST_P(VerifyPost, SeesAWorkpieceElsewhere) {
  // The program is right, the cell is another: the replay goes through the cell.
  Cell moved = SampleCell(plan);
  moved.X_WP.translation().x() += 0.05;
  EXPECT_NE(Text(Verify(WrittenAndRead(), World(moved), &program, options, 2, {})), "");
}

TEST_P(VerifyPost, SeesAnotherTool) {
  Cell moved = SampleCell(plan);
  moved.X_FT.translation().x() += 0.05;
  const std::string text = Text(Verify(WrittenAndRead(), World(moved), &program, options, 2, {}));
  // SINUMERIK takes the tool from the control's own data, so the program says nothing about it.
  EXPECT_EQ(text.empty(), GetParam() == "sinumerik") << text;
}

TEST_P(VerifyPost, SeesLimits) {
  options.upper[4] = 0.1;
  const std::string text = Text(Verify(WrittenAndRead(), world, &program, options, 2, {}));
  EXPECT_NE(text.find("A5 at"), std::string::npos) << text;
}

TEST_P(VerifyPost, SeesInterference) {
  Cell narrow = SampleCell(plan);
  Body post_body;
  post_body.name = "post";
  post_body.X_MG.translation() = plan.X_WP.translation() + Eigen::Vector3d(-250, 0, 0);
  post_body.shape = Box{{60, 60, 60}};
  narrow.bodies.push_back(post_body);
  const std::string text = Text(Verify(WrittenAndRead(), World(narrow), nullptr, options, 2, {}));
  EXPECT_NE(text.find("post"), std::string::npos) << text;
}

}  // namespace
}  // namespace millpose
