// SPDX-License-Identifier: GPL-3.0-or-later
// The real interpreter of LinuxCNC reads what the post writes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/file.hpp"
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/linuxcnc.hpp"
#include "program/scanner.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMachine =
    "[EMC]\nMACHINE = test\n[TRAJ]\nCOORDINATES = X Y Z A B C\nAXES = 6\nLINEAR_UNITS = mm\nANGULAR_UNITS = "
    "degree\n"
    "[RS274NGC]\nPARAMETER_FILE = machine.var\n[EMCIO]\nTOOL_TABLE = tool.tbl\n";

struct Interpreted {
  int status = -1;
  std::string canonical;
};

Interpreted Interpret(const std::string& program) {
  const fs::path folder =
      fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
  fs::create_directories(folder);
  WriteFileAtomically(folder / "machine.ini", kMachine);
  WriteFileAtomically(folder / "machine.var", "");
  WriteFileAtomically(folder / "tool.tbl", "\n");
  WriteFileAtomically(folder / "program.ngc", program);
  const std::string command =
      "cd '" + folder.string() +
      "' && rs274 -g -i machine.ini -t tool.tbl program.ngc > canonical.txt 2>&1 </dev/null";
  Interpreted result;
  result.status = std::system(command.c_str());
  result.canonical = ReadFile(folder / "canonical.txt");
  fs::remove_all(folder);
  return result;
}

struct CanonicalMove {
  Joints angles;  // degrees
  bool feed = false;
  double speed = 0;  // per minute along FeedLength()
};

std::vector<CanonicalMove> Moves(const std::string& canonical) {
  std::vector<CanonicalMove> moves;
  double speed = 0;
  for (const std::string_view line : SplitLines(canonical)) {
    const auto numbers_after = [&](std::string_view word) {
      std::vector<double> numbers;
      const size_t begin = line.find(word);
      if (begin == std::string_view::npos) return numbers;
      LineScanner scan(line.substr(begin + word.size()), "canonical", 0);
      do numbers.push_back(scan.ExpectNumber());
      while (scan.Accept(","));
      return numbers;
    };
    if (const auto rate = numbers_after("SET_FEED_RATE("); !rate.empty()) speed = rate[0];
    for (const std::string_view word : {"STRAIGHT_FEED(", "STRAIGHT_TRAVERSE("}) {
      std::vector<double> numbers = numbers_after(word);
      if (numbers.size() != 6) continue;
      moves.push_back({Eigen::Map<Joints>(numbers.data()), word == "STRAIGHT_FEED(", speed});
    }
  }
  return moves;
}

void ExpectAccepted(const PlanResult& plan) {
  const PostSettings settings = SampleSettings("linuxcnc");
  const auto post = MakePost("linuxcnc");
  const ProgramFiles files = post->Write(MakeMotionProgram(plan), plan.arm, settings);
  const Interpreted result = Interpret(files.begin()->second);
  ASSERT_EQ(result.status, 0) << result.canonical;
  const std::vector<CanonicalMove> moves = Moves(result.canonical);
  const MotionProgram read = post->Read(files, plan.arm, settings);
  ASSERT_EQ(moves.size(), read.motions.size());
  for (size_t i = 0; i < moves.size(); ++i) {
    const Motion& motion = read.motions[i];
    EXPECT_LT((moves[i].angles - *motion.q * kDegPerRad).cwiseAbs().maxCoeff(), 0.51e-4) << motion.line;
    EXPECT_EQ(moves[i].feed, motion.duration > 0);
    if (motion.duration == 0) continue;
    const double length = FeedLength(*read.motions[i - 1].q * kDegPerRad, *motion.q * kDegPerRad);
    EXPECT_NEAR(moves[i].speed, length / motion.duration * 60, 0.51e-4) << motion.line;
  }
}

TEST(Rs274, AcceptsTheSample) { ExpectAccepted(SamplePlan()); }

TEST(Rs274, KeepsTheTimeWhereTheArmBarelyMoves) {
  // 0.02 mm apart at 80 mm/min, but turned by the tool's rotation: joints 1 to 3 are slower than G93's floor.
  PlanResult plan = SamplePlan({.points = 3, .spacing = 0.02, .ring = false});
  for (PassResult& pass : plan.passes) {
    for (PlannedPoint& point : pass.points) point.point.feed_rate = 0.01;
  }
  ExpectAccepted(plan);
}

TEST(Rs274, RefusesWhatIsWrong) { EXPECT_NE(Interpret("G21 G90\nG93\nG1 X1 Y2 Z3\nM2\n").status, 0); }

}  // namespace
}  // namespace millpose
