// SPDX-License-Identifier: GPL-3.0-or-later
// Edits of a text that change what the machine does and were once confirmed, or once took minutes.
#include <gtest/gtest.h>

#include <ctime>
#include <regex>

#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/economy.hpp"
#include "tests/program/program_lines.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

struct HandEdit : ProgramLines {
  using ProgramLines::ProgramLines;

  /// Findings and problems, as "line: message".
  std::string Said(bool with_plan = true) const {
    std::string said;
    try {
      const MotionProgram read = Read();
      const World world(SampleCell(plan));
      for (const Finding& finding :
           Verify(read, world, with_plan ? &program : nullptr, SampleOptions(plan), {.threads = 2}))
        said += fmt::format("{}: {}\n", finding.line, finding.message);
    } catch (const InputError& error) {
      for (const Problem& problem : error.problems())
        said += fmt::format("{}: {}\n", problem.place.line, problem.message);
    }
    return said;
  }

  testing::AssertionResult SaidAt(size_t index) const {
    const std::string said = Said();
    if (("\n" + said).find(fmt::format("\n{}: ", index + 1)) != std::string::npos)
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << "line " << index + 1 << " '" << lines[index] << "' said: " << said;
  }
};

/// A controller rounds a way-point by as much as it likes, up to half of both ways.
TEST(HandEdits, RoundedWaysAreReplayed) {
  for (const char* place : {"^PTP \\{A1", "^PTP .*,S "}) {
    for (const int nth : {1, 2}) {
      HandEdit edit("krl");
      const size_t at = edit.Find(place, nth);
      edit.lines[at] += " C_PTP";
      EXPECT_TRUE(edit.SaidAt(at));
    }
  }
  // Between points of one straight way nothing can be cut short.
  HandEdit straight("krl");
  const size_t at = straight.Find("^PTP \\{A1", 1);
  std::array<double, 6> a{}, b{};
  const auto read = [&](size_t line, std::array<double, 6>& angles) {
    std::sscanf(straight.lines[line].c_str(), "PTP {A1 %lf,A2 %lf,A3 %lf,A4 %lf,A5 %lf,A6 %lf}", &angles[0],
                &angles[1], &angles[2], &angles[3], &angles[4], &angles[5]);
  };
  read(straight.Find("^PTP \\{A1", 0), a);
  read(at, b);
  std::string middle = "PTP {";
  for (size_t i = 0; i < 6; ++i)
    middle += fmt::format("{}A{} {:.6f}", i ? "," : "", i + 1, (a[i] + b[i]) / 2);
  straight.lines.insert(straight.lines.begin() + static_cast<long>(at), middle + "} C_PTP");
  EXPECT_EQ(straight.Said(), "");
}

/// The stops at both ends of a cut are planned.
TEST(HandEdits, PlannedStopsStay) {
  for (const int nth : {0, 1}) {  // the end of the approach, the last point or the retract
    HandEdit edit("krl");
    const size_t at = nth == 0 ? edit.Find("^LIN ") : edit.Find("ENDFOLD .PASS 0") - 1;
    edit.lines[at] += " C_DIS";
    EXPECT_TRUE(edit.SaidAt(at));
  }
}

/// A limit that couples axes is asked of every replayed pose.
TEST(HandEdits, LimitsThatCoupleAxesAreAsked) {
  const HandEdit as_written("krl");
  const World world(SampleCell(as_written.plan));
  VerifyOptions options = SampleOptions(as_written.plan);
  const auto findings = [&] {
    return Verify(as_written.Read(), world, &as_written.program, options, {.threads = 2});
  };
  CoupledLimit limit{(Joints() << 0, -1, 1, 0, 0, 0).finished(), -1e9};
  for (const Motion& motion : as_written.program.motions)
    if (motion.q) limit.at_most = std::max(limit.at_most, limit.factors.dot(*motion.q));
  limit.at_most += DegToRad(0.2);
  options.coupled = {limit};
  EXPECT_TRUE(findings().empty());
  options.coupled[0].at_most -= DegToRad(0.5);
  const std::vector<Finding> found = findings();
  ASSERT_FALSE(found.empty());
  EXPECT_NE(found[0].message.find("A3 = "), std::string::npos) << found[0].message;
  EXPECT_NE(found[0].message.find("is above"), std::string::npos) << found[0].message;
}

/// At 0 a turn bit says nothing: the entry must be stated by joints.
TEST(HandEdits, TurnBitsNearZero) {
  const PlanResult plan = SamplePlan();
  for (const std::string variant : {"krl", "sinumerik"}) {
    PostSettings settings = SampleSettings(variant);
    MotionProgram program = MakeMotionProgram(plan);
    const auto entry = std::find_if(program.motions.begin(), program.motions.end(),
                                    [](const Motion& motion) { return motion.turn.has_value(); });
    ASSERT_NE(entry, program.motions.end());
    const size_t index = static_cast<size_t>(entry - program.motions.begin());
    // The controller counts A4 from where it stands at the entry.
    const AxisConvention& axes = settings.axes;
    Joints offset = axes.offset();
    offset[3] = -axes.matrix()(3, 3) * (*entry->q)[3] + 1e-6;
    settings.axes = AxisConvention(axes.matrix(), offset);
    const auto post = SamplePost(variant);
    const World world(SampleCell(plan));
    const auto findings = [&](const MotionProgram& written) {
      const MotionProgram read = post->Read(post->Write(written, plan.arm, settings), plan.arm, settings);
      return Verify(read, world, &program, SampleOptions(plan), {.threads = 2});
    };
    std::vector<Finding> found = findings(program);
    ASSERT_FALSE(found.empty()) << variant;
    EXPECT_NE(found[0].message.find("A4 is at 0.0000"), std::string::npos) << found[0].message;
    MotionProgram stated = program;
    EXPECT_EQ(StateEntriesByJoints(stated, settings.axes, 2 * kUncertainTurn), std::vector<size_t>{index});
    found = findings(stated);
    EXPECT_TRUE(found.empty()) << variant << ": " << found[0].message;
  }
}

/// Numbers that no program holds are reported in no time: nothing of them is sampled.
TEST(HandEdits, HugeNumbersAreToldAtOnce) {
  struct Case {
    const char *variant, *line, *from, *to;
  };
  for (const auto& [variant, line, from, to] : {
           Case{"krl", "^PTP \\{A1", "A1 [-0-9.]+", "A1 1e12"},
           Case{"krl", "^PTP \\{A1", "A1 [-0-9.]+", "A1 999999999"},
           Case{"krl", "^PTP \\{A1", "A2 ([-0-9]+)", "A2 $010000"},
           Case{"krl", "^LIN \\{X .*C_DIS", "X ([-0-9]+)", "X $010000"},
           Case{"krl", "^LIN .*C [-0-9].*C_DIS", "C ([-0-9]+)", "C $010000"},
           Case{"krl", "^LIN \\{X .*C_DIS", "X [-0-9.]+", "X 500"},
           Case{"sinumerik", "^G0 SUPA RA1", "RA2=[-0-9.]+", "RA2=1e308"},
           Case{"sinumerik", "^G0 SUPA RA1", "RA2=([-0-9]+)\\.", "RA2=$1"},
           Case{"sinumerik", "^G1 X", "X([-0-9]+)\\.", "X$1"},
           Case{"linuxcnc", "^G0 X", "Y([-0-9]+)\\.", "Y$1"},
           Case{"linuxcnc", "^G1 X", "A([-0-9]+)\\.", "A$1"},
           Case{"linuxcnc", "^G0 X", "X[-0-9.]+", "X999999999"},
           Case{"linuxcnc_cartesian", "^G1 X", "A([-0-9]+)\\.", "A$1"},
           Case{"linuxcnc_cartesian", "^G1 X", "B[-0-9.]+", "B999999999"},
       }) {
    HandEdit edit(variant);
    const size_t at = edit.Find(line, 1);
    const std::string before = edit.lines[at];
    edit.lines[at] = std::regex_replace(before, std::regex(from), to);
    ASSERT_NE(edit.lines[at], before) << line;
    const std::clock_t start = std::clock();
    EXPECT_TRUE(edit.SaidAt(at));
    edit.Said(false);  // 500 mm off may be meant where no plan says otherwise
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5) << edit.lines[at];
  }
}

}  // namespace
}  // namespace millpose
