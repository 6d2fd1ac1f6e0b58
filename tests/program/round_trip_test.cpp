// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <regex>

#include "base/error.hpp"
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/economy.hpp"
#include "program/krl/krl.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "program/post_entry.hpp"
#include "program/scanner.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

class EachPost : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Post> post = SamplePost(GetParam());
  PostSettings settings = SampleSettings(GetParam());
  PlanResult plan = SamplePlan();
  MotionProgram program = MakeMotionProgram(plan);
  ProgramFiles files = post->Write(program, plan.arm, settings);

  MotionProgram Read(const ProgramFiles& texts) { return post->Read(texts, plan.arm, settings); }
};
INSTANTIATE_TEST_SUITE_P(Controllers, EachPost,
                         testing::Values("krl", "sinumerik", "sinumerik_euler", "linuxcnc",
                                         "linuxcnc_cartesian", "fanuc", "fanuc_held", "fanuc_cnt",
                                         "fanuc_cr"),
                         [](const auto& controller) { return controller.param; });

TEST(Posts, RegistryNamesThem) {
  const std::vector<std::string> names = Posts().Names();
  EXPECT_EQ(std::vector(names.begin(), names.begin() + 3),
            (std::vector<std::string>{"krl", "sinumerik", "linuxcnc"}));
  for (const std::string& name : Posts().Names()) EXPECT_EQ(MakePost(name)->Name(), name);
  try {
    MakePost("krll");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"krl\""), std::string::npos) << error.what();
  }
}

TEST(MotionProgram, FollowsThePlan) {
  const PlanResult plan = SamplePlan();
  const MotionProgram program = MakeMotionProgram(plan);
  ASSERT_TRUE(IsWellFormed(program));
  EXPECT_EQ(program.motions.front().q, plan.home);
  EXPECT_EQ(program.motions.back().q, plan.home);
  // Every point of every pass once, in order; a closed pass returns to its first point.
  for (const PassResult& pass : plan.passes) {
    std::vector<int> visited;
    for (const Motion& motion : program.motions) {
      if (motion.pass == pass.pass && motion.point >= 0) visited.push_back(motion.point);
    }
    std::vector<int> expected(pass.points.size());
    for (size_t i = 0; i < expected.size(); ++i) expected[i] = static_cast<int>(i);
    if (pass.pieces[0].closed) expected.push_back(0);
    EXPECT_EQ(visited, expected);
  }
  // LIN starts and ends exactly, and the pose before its approach is a PTP with S and T.
  for (size_t i = 1; i < program.motions.size(); ++i) {
    const Motion &before = program.motions[i - 1], &motion = program.motions[i];
    if (motion.type == before.type) continue;
    EXPECT_TRUE(before.exact);
    if (motion.type == MotionType::kLinear) {
      EXPECT_EQ(before.status, Status(plan.arm, *before.q));
      EXPECT_EQ(before.turn, Turn(*before.q));
      EXPECT_NEAR((motion.X_PT.translation() - before.X_PT.translation()).norm(), 50, 1e-6);
    }
  }
  ASSERT_EQ(program.events.size(), 8u);
  EXPECT_EQ(program.events[1].kind, ProgramEvent::Kind::kSpindleOn);
  EXPECT_EQ(program.events.back().kind, ProgramEvent::Kind::kSpindleOff);
}

TEST(MotionProgram, ARingThatWindsAJointClosesWithoutTurningBack) {
  PlanResult plan = SamplePlan();
  PassResult& ring = plan.passes.back();
  ASSERT_TRUE(ring.pieces[0].closed);
  const size_t count = ring.points.size();
  for (size_t i = 0; i < count; ++i)
    ring.points[i].q[5] -= 2 * kPi * static_cast<double>(i) / static_cast<double>(count);
  const MotionProgram program = MakeMotionProgram(plan);
  size_t cuts = 0;
  for (size_t i = 1; i < program.motions.size(); ++i) {
    const Motion &before = program.motions[i - 1], &motion = program.motions[i];
    if (motion.pass != ring.pass || motion.point < 0 || before.point < 0) continue;
    EXPECT_LT(std::abs((*motion.q)[5] - (*before.q)[5]), 1) << motion.point;
    ++cuts;
  }
  EXPECT_EQ(cuts, count);
}

TEST(MotionProgram, SaysWhyThereIsNone) {
  PlanResult plan = SamplePlan();
  EXPECT_EQ(WhyNotProgrammable(plan), "");
  plan.gaps[1].planned = false;
  plan.gaps[1].detail = "spindle meets fixture";
  EXPECT_EQ(WhyNotProgrammable(plan),
            "the way from pass 0 piece 0 to pass 1 piece 0 could not be planned: spindle meets fixture");
  plan.gaps.clear();
  EXPECT_EQ(WhyNotProgrammable(plan), "no piece was planned");
}

TEST_P(EachPost, WritesTheSameAgainAfterReading) {
  EXPECT_EQ(post->Write(Read(files), plan.arm, settings), files);
}

TEST_P(EachPost, TextIsPlain) {
  for (const auto& [name, text] : files) {
    const size_t width = ControllerOf(GetParam()) == "sinumerik" ? 110 : 100;  // six joints with SUPA
    for (const std::string_view line : SplitLines(text)) EXPECT_LE(line.size(), width) << line;
    for (const char c : text) ASSERT_TRUE(c == '\n' || (c >= ' ' && c <= '~'));
    EXPECT_TRUE(text.ends_with('\n'));
  }
}

TEST_P(EachPost, RoundingKeepsTheTipAndTheMarks) {
  const MotionProgram read = Read(files);
  EXPECT_EQ(read.header, program.header);
  std::vector<ProgramEvent> events = read.events;  // those that no plan has are of texts alone
  std::erase_if(events, [](const ProgramEvent& event) { return event.kind >= ProgramEvent::Kind::kText; });
  ASSERT_EQ(events.size(), program.events.size());
  for (size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].kind, program.events[i].kind);
    EXPECT_NEAR(events[i].value, program.events[i].value, 1e-9);
    EXPECT_EQ(events[i].piece, program.events[i].piece);
  }
  if (ControllerOf(GetParam()) == "linuxcnc") return;  // has more motions, see below
  ASSERT_EQ(read.motions.size(), program.motions.size());
  const Pose X_BP = read.X_BP.value_or(*program.X_BP);
  const Pose X_FT = read.X_FT.value_or(*program.X_FT);
  const bool ls = ControllerOf(GetParam()) == "fanuc";  // three decimals; J by joints, L with CONFIG
  int last_line = 0;
  for (size_t i = 0; i < read.motions.size(); ++i) {
    const Motion &given = program.motions[i], &motion = read.motions[i];
    EXPECT_EQ(motion.type, given.type);
    EXPECT_EQ(motion.exact, given.exact);
    if (!ls) {
      EXPECT_EQ(motion.status, given.status);
      EXPECT_EQ(motion.turn, given.turn);
    }
    EXPECT_EQ(motion.pass, given.pass);
    EXPECT_GT(std::exchange(last_line, motion.line), -1);
    EXPECT_GT(motion.line, 0);
    if (motion.type == MotionType::kLinear) {
      EXPECT_NEAR(motion.feed, given.feed, 1e-5);
    }
    const Pose wanted = *program.X_BP * given.X_PT;
    const Pose written = motion.q ? ForwardFlange(plan.arm, *motion.q) * X_FT : X_BP * motion.X_PT;
    EXPECT_LT((wanted.translation() - written.translation()).norm(), ls && motion.q ? 0.06 : 0.001)
        << motion.line;
    EXPECT_LT(Eigen::AngleAxisd(wanted.linear().transpose() * written.linear()).angle(),
              (ls ? 0.002 : 0.0002) * kRadPerDeg);
    if (ls && !motion.q) {
      EXPECT_EQ(motion.status, Status(plan.arm, *given.q));
      EXPECT_TRUE(((settings.axes.FromArm(*given.q) - *motion.least).array() >= 0).all());
    }
    if (motion.turn) {
      const auto q = AnglesAt(plan.arm, read.axes, written * X_FT.inverse(), *motion.status, *motion.turn);
      ASSERT_TRUE(q);
      EXPECT_LT((*q - *given.q).norm(), 1e-4);
    }
  }
}

TEST_P(EachPost, AxisConventionIsUndoneWhenReading) {
  // FANUC's third axis counts against the second: couplings go the same way.
  Matrix6 matrix = Matrix6::Identity();
  matrix.diagonal() << 1, -1, 1, -1, 1, -1;
  matrix(2, 1) = -1;
  settings.axes = AxisConvention(matrix, (Joints() << 0, 0.5, 0, 0, -0.25, 1).finished());
  const ProgramFiles other = post->Write(program, plan.arm, settings);
  EXPECT_NE(other, files);
  const MotionProgram read = Read(other);
  EXPECT_EQ(post->Write(read, plan.arm, settings), other);
  EXPECT_LT((*read.motions.front().q - plan.home).norm(), ControllerOf(GetParam()) == "fanuc" ? 4e-5 : 1e-7);
}

TEST_P(EachPost, SplitsBehindRetractsOnly) {
  settings.max_motions = 12;
  const ProgramFiles parts = post->Write(program, plan.arm, settings);
  if (ControllerOf(GetParam()) == "linuxcnc") {
    EXPECT_EQ(parts, files);  // reads from disk, has no such limit
    return;
  }
  EXPECT_EQ(parts.size(), files.size() + 3);
  const MotionProgram read = Read(parts), whole = Read(files);
  EXPECT_EQ(post->Write(read, plan.arm, settings), parts);
  ASSERT_EQ(read.motions.size(), whole.motions.size());
  for (size_t i = 0; i < read.motions.size(); ++i) {
    EXPECT_EQ(read.motions[i].feed, whole.motions[i].feed);
    EXPECT_EQ(read.motions[i].X_PT.matrix(), whole.motions[i].X_PT.matrix());
    if (i > 0 && read.motions[i].file != read.motions[i - 1].file) {
      EXPECT_TRUE(read.motions[i - 1].exact);
      EXPECT_EQ(read.motions[i].type, MotionType::kJoint);
    }
  }
  // Sub-programs as large as allowed, never more files than passes.
  settings.max_motions = 18;
  EXPECT_EQ(post->Write(program, plan.arm, settings).size(), files.size() + 2);
  settings.max_motions = 1400;
  settings.max_kbytes = 1;
  EXPECT_GT(post->Write(program, plan.arm, settings).size(), files.size());
}

TEST_P(EachPost, ReadsSubprogramsAsCalled) {
  settings.max_motions = 12;
  if (ControllerOf(GetParam()) == "linuxcnc" || ControllerOf(GetParam()) == "fanuc") return;
  ProgramFiles parts = post->Write(program, plan.arm, settings);
  const std::string stem = "Sample_wall_plan",
                    extension = ControllerOf(GetParam()) == "krl" ? ".src" : ".spf";
  ProgramFiles lost = parts;
  lost.erase(stem + "_002" + extension);
  EXPECT_THROW(Read(lost), InputError);
  ProgramFiles uncalled = parts;
  std::string& main = uncalled[stem + (ControllerOf(GetParam()) == "krl" ? ".src" : ".mpf")];
  main.replace(main.find(stem + "_002"), 20, "; ");
  EXPECT_THROW(Read(uncalled), InputError);
  ProgramFiles circle = parts;
  std::string& part = circle[stem + "_002" + extension];
  part.insert(part.rfind(ControllerOf(GetParam()) == "krl" ? "END" : "M17"),
              ControllerOf(GetParam()) == "krl" ? stem + "_003 ( )\n" : stem + "_003\n");
  EXPECT_GT(Read(circle).motions.size(), Read(parts).motions.size());  // called twice
  std::string& other = circle[stem + "_003" + extension];
  other.insert(other.rfind(ControllerOf(GetParam()) == "krl" ? "END" : "M17"),
               ControllerOf(GetParam()) == "krl" ? stem + "_002 ( )\n" : stem + "_002\n");
  EXPECT_THROW(Read(circle), InputError);
}

TEST_P(EachPost, CellTextsAreWrittenAndExpected) {
  if (ControllerOf(GetParam()) == "fanuc") return;  // whose remarks begin with '!': fanuc_test.cpp
  settings.texts["header"] = "; ready {1}\n; steady";
  settings.texts["footer"] = "; done";
  settings.texts["coolant_on"] = "; COOLANT ON";
  settings.texts["coolant_off"] = "; COOLANT OFF";
  settings.texts["pass_begin"] = "; suction on for {pass}, {piece}";
  settings.texts["pass_end"] = "; suction off";
  settings.texts["tool_change"] = "; take {tool}";
  const ProgramFiles parts = post->Write(program, plan.arm, settings);
  EXPECT_EQ(post->Write(Read(parts), plan.arm, settings), parts);
  for (const std::string line : {"; ready {1}", "; steady", "; done", "; COOLANT ON", "; COOLANT OFF",
                                 "; suction on for 1, 0", "; suction off", "; take SPINDLE_D20"}) {
    ProgramFiles without = parts;
    std::string& text = without.rbegin()->second;
    ASSERT_NE(text.find(line + "\n"), std::string::npos) << line << text;
    text.erase(text.find(line + "\n"), line.size() + 1);
    if (line.find("COOLANT") != std::string::npos) {  // the spindle's text is then not complete, so not known
      try {
        EXPECT_LT(Read(without).events.size(), program.events.size()) << line;
      } catch (const InputError&) {
      }
    } else {
      EXPECT_THROW(Read(without), InputError) << line;
    }
  }
}

MotionOptions RichOptions() {
  MotionOptions options;
  options.header = {{"version", "millpose 0.0.0"}, {"tool_pose", "X -250.000 Y 0.000"}};
  options.approach_feed = 1000.0 / 60;
  options.approach_slow = 5;
  options.retract_feed = 3000.0 / 60;
  options.outputs = {{3, true, 0, true}, {4, true, 0, false}, {3, false, 0, false}};
  return options;
}

TEST_P(EachPost, OutputsAndFeedsOfApproachAndRetract) {
  program = MakeMotionProgram(plan, RichOptions());
  ASSERT_TRUE(IsWellFormed(program));
  files = post->Write(program, plan.arm, settings);
  const MotionProgram read = Read(files);
  EXPECT_EQ(post->Write(read, plan.arm, settings), files);
  const auto outputs_of = [](const MotionProgram& from) {
    std::vector<const ProgramEvent*> list;
    for (const ProgramEvent& event : from.events)
      if (event.kind == ProgramEvent::Kind::kOutput) list.push_back(&event);
    return list;
  };
  const std::vector<const ProgramEvent*> given = outputs_of(read), wanted = outputs_of(program);
  ASSERT_EQ(given.size(), 9u);
  ASSERT_EQ(wanted.size(), 9u);
  for (size_t i = 0; i < given.size(); ++i) {
    EXPECT_EQ(given[i]->output.number, wanted[i]->output.number);
    EXPECT_EQ(given[i]->output.on, wanted[i]->output.on);
    EXPECT_GT(given[i]->line, 0);
    if (ControllerOf(GetParam()) != "linuxcnc") {
      EXPECT_EQ(given[i]->before_motion, wanted[i]->before_motion);
    }
  }
  // Down fast, the last 5 mm at the cutting feed; up fast.
  for (size_t i = 2; i < program.motions.size(); ++i) {
    const Motion& motion = program.motions[i];
    if (motion.type != MotionType::kLinear || motion.point >= 0) continue;
    const double length = (motion.X_PT.translation() - program.motions[i - 1].X_PT.translation()).norm();
    const bool approach = program.motions[i - 1].status.has_value();
    EXPECT_NEAR(length, approach ? 45 : 50, 1e-6);
    EXPECT_NEAR(motion.feed * 60, approach ? 1000 : 3000, 1e-6);
    EXPECT_TRUE(motion.exact);
  }
}

TEST_P(EachPost, LongPiecesAreHandedOverAtAStop) {
  if (ControllerOf(GetParam()) == "linuxcnc") return;
  EconomyResult whole = Economise(program, {0, 0, 0});
  const std::vector<size_t> places = AddHandovers(whole.program, 5);
  EXPECT_GE(places.size(), 4u);
  settings.max_motions = 5;
  files = post->Write(whole.program, plan.arm, settings);
  for (const auto& [name, text] : files) {
    const std::regex motion("(^|\n)( *S?LIN|PTP|G0|G1|G9 G1| +[0-9]+:[LJ]) ");
    const auto count = std::distance(std::sregex_iterator(text.begin(), text.end(), motion), {});
    if (name.find("_0") != std::string::npos) {
      EXPECT_LE(count, 5) << name;
    }
  }
  const MotionProgram read = Read(files);
  EXPECT_EQ(post->Write(read, plan.arm, settings), files);
  ASSERT_EQ(read.motions.size(), program.motions.size());
  for (size_t i = 1; i < read.motions.size(); ++i) {
    if (read.motions[i].file != read.motions[i - 1].file) {
      EXPECT_TRUE(read.motions[i - 1].exact);
    }
  }
}

TEST(Krl, NumberedFramesAndExternalAxes) {
  const PlanResult plan = SamplePlan();
  PostSettings settings = SampleSettings("krl");
  settings.controller_axes = {{"E1", "", AxisKind::kLinear, 1200.5}, {"E2", "", AxisKind::kRotary, -90}};
  KrlOptions options;
  options.base_number = 3;
  options.tool_number = 7;
  auto post = std::make_unique<KrlPost>(options);
  const ProgramFiles files = post->Write(MakeMotionProgram(plan), plan.arm, settings);
  std::string text = files.rbegin()->second;
  EXPECT_NE(text.find("BAS (#BASE,3 )\nBAS (#TOOL,7 )\n"), std::string::npos);
  EXPECT_NE(text.find(",E1 1200.5,E2 -90}"), std::string::npos);
  const MotionProgram read = post->Read(files, plan.arm, settings);
  EXPECT_FALSE(read.X_BP || read.X_FT);
  EXPECT_EQ(post->Write(read, plan.arm, settings), files);
  text.replace(text.find("E1 1200.5"), 9, "E1 1200.6");
  EXPECT_THROW(post->Read({{"Sample_wall_plan.src", text}}, plan.arm, settings), InputError);
  options.base_number = 4;
  post = std::make_unique<KrlPost>(options);
  EXPECT_THROW(post->Read(files, plan.arm, settings), InputError);
}

TEST(LinuxCnc, PointsAreDenseEnough) {
  const PlanResult plan = SamplePlan({.points = 4, .spacing = 120});
  const MotionProgram program = MakeMotionProgram(plan);
  const auto post = MakePost("linuxcnc");
  const PostSettings settings = SampleSettings("linuxcnc");
  const MotionProgram read = post->Read(post->Write(program, plan.arm, settings), plan.arm, settings);
  ASSERT_GT(read.motions.size(), program.motions.size());
  // Half-way between two points of the text the tip is on the straight lines of the plan.
  double worst = 0, seconds = 0, planned_seconds = 0;
  for (size_t i = 1; i < read.motions.size(); ++i) {
    if (read.motions[i].duration == 0) continue;
    seconds += read.motions[i].duration;
    const Joints halfway = (*read.motions[i].q + *read.motions[i - 1].q) / 2;
    const Eigen::Vector3d tip =
        (program.X_BP->inverse() * ForwardFlange(plan.arm, halfway) * plan.X_FT).translation();
    double nearest = 1e9;
    for (size_t k = 1; k < program.motions.size(); ++k) {
      if (program.motions[k].type != MotionType::kLinear) continue;
      const Eigen::Vector3d a = program.motions[k - 1].X_PT.translation(),
                            b = program.motions[k].X_PT.translation();
      const double s = std::clamp((tip - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (a + s * (b - a) - tip).norm());
    }
    worst = std::max(worst, nearest);
  }
  for (size_t k = 1; k < program.motions.size(); ++k) {
    if (program.motions[k].type != MotionType::kLinear) continue;
    planned_seconds +=
        (program.motions[k].X_PT.translation() - program.motions[k - 1].X_PT.translation()).norm() /
        program.motions[k].feed;
  }
  EXPECT_LE(worst, kHalfwayDeviation + 1e-4);
  EXPECT_NEAR(seconds, planned_seconds, 1e-4 * planned_seconds);
}

}  // namespace
}  // namespace millpose
