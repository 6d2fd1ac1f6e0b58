// SPDX-License-Identifier: GPL-3.0-or-later
// Calls of the plant's programs: planned to and from, replayed, and a finding from anywhere else.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

class CallingProgram : public testing::TestWithParam<std::string> {
 protected:
  CallingProgram() {
    const bool krl = GetParam() == "krl", linuxcnc = ControllerOf(GetParam()) == "linuxcnc";
    const std::string call = krl ? "CHANGE ( )" : linuxcnc ? "O<CHANGE> CALL" : "CHANGE";
    DeclaredCall change{"CHANGE", true, plan.home, plan.home, "tool_change"};
    change.from[0] += 0.2;
    change.to[1] -= 0.1;
    settings.calls = {change};
    settings.texts["tool_change"] = call;
    settings.texts["footer"] = call;
    Joints between = plan.home;
    between[0] += 0.1;
    options.calls = {{change, {plan.home, between, change.from}, {change.to, plan.home}, 1}};
    change.text = "footer";
    options.calls.push_back({change, {plan.home, change.from}, {change.to, plan.home}, 1});
    planned = MakeMotionProgram(plan, options);
    files = post->Write(planned, plan.arm, settings);
  }

  std::string Said(const ProgramFiles& texts, const MotionProgram* against) const {
    std::string said;
    try {
      const MotionProgram read = post->Read(texts, plan.arm, settings);
      for (const Finding& finding : Verify(read, world, against, SampleOptions(plan), {.threads = 2}))
        said += fmt::format("{}: {}\n", finding.line, finding.message);
    } catch (const InputError& error) {
      said = error.what();
    }
    return said;
  }

  /// The main program without its nth line (from 0) that holds `part`.
  ProgramFiles Without(const std::string& part, int nth) const {
    ProgramFiles changed = files;
    std::string& text = changed.rbegin()->second;
    size_t at = text.find(part);
    while (nth-- > 0) at = text.find(part, at + 1);
    const size_t begin = text.rfind('\n', at) + 1, end = text.find('\n', at) + 1;
    text.erase(begin, end - begin);
    return changed;
  }

  PlanResult plan = SamplePlan();
  std::unique_ptr<Post> post = SamplePost(GetParam());
  PostSettings settings = SampleSettings(GetParam());
  MotionOptions options;
  World world{SampleCell(plan)};
  MotionProgram planned;
  ProgramFiles files;
};
INSTANTIATE_TEST_SUITE_P(Controllers, CallingProgram,
                         testing::Values("krl", "sinumerik", "linuxcnc", "linuxcnc_cartesian"),
                         [](const auto& controller) { return controller.param; });

TEST_P(CallingProgram, IsReplayedThroughItsCalls) {
  EXPECT_EQ(Said(files, &planned), "");
  EXPECT_EQ(Said(files, nullptr), "");
  const MotionProgram read = post->Read(files, plan.arm, settings);
  ASSERT_EQ(read.calls.size(), 1u);
  EXPECT_EQ(read.calls[0].name, "CHANGE");
  EXPECT_EQ(std::ranges::count_if(read.motions, [](const Motion& motion) { return motion.call >= 0; }), 2);
}

TEST_P(CallingProgram, IsNotConfirmedWithoutTheWays) {
  const std::string way = GetParam() == "krl"         ? "PTP {A1"
                          : GetParam() == "sinumerik" ? "G0 SUPA RA1"
                                                      : "G0 X";
  // To where the first call begins: between, from_deg; away from where it ends: home.
  EXPECT_NE(Said(Without(way, 2), &planned).find("must be called at its from_deg"), std::string::npos);
  EXPECT_NE(Said(Without(way, 2), nullptr).find("must be called at its from_deg"), std::string::npos);
  EXPECT_NE(Said(Without(way, 3), &planned), "");
  EXPECT_NE(Said(Without("CHANGE", 0), &planned), "");
  MotionOptions without = options;
  without.calls.pop_back();
  const MotionProgram other = MakeMotionProgram(plan, without);
  EXPECT_NE(Said(files, &other), "");  // nobody planned the second call
}

TEST_P(CallingProgram, LimitsHoldWhereACallEnds) {
  settings.calls[0].to[4] = plan.arm.upper[4] + 0.1;
  EXPECT_NE(Said(files, nullptr).find("leaves its limits"), std::string::npos);
}

}  // namespace
}  // namespace millpose
