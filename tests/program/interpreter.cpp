// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/interpreter.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "base/file.hpp"
#include "base/units.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "program/scanner.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMachine =
    "[EMC]\nMACHINE = test\n[TRAJ]\nCOORDINATES = X Y Z A B C\nAXES = 6\nLINEAR_UNITS = mm\nANGULAR_UNITS = "
    "degree\n"
    "[RS274NGC]\nPARAMETER_FILE = machine.var\n[EMCIO]\nTOOL_TABLE = tool.tbl\n";

struct CanonicalMove {
  Joints words;                  // degrees, or mm and degrees of a tool pose
  std::vector<double> external;  // U, V, W, where the machine has them
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
      if (numbers.size() != 6 && numbers.size() != 9) continue;
      moves.push_back({Eigen::Map<Joints>(numbers.data()),
                       {numbers.begin() + 6, numbers.end()},
                       word == "STRAIGHT_FEED(",
                       speed});
    }
  }
  return moves;
}

/// The six words of a motion, and of the pose or joints where it begins.
Joints WordsOf(const Motion& motion) {
  if (motion.type == MotionType::kJoint) return *motion.q * kDegPerRad;
  Joints words;
  words << motion.X_PT.translation(), *motion.angles * kDegPerRad;
  return words;
}

/// What U, V, W move by, mm or degrees.
Eigen::Vector3d ExternalWay(const Motion& from, const Motion& to, const std::vector<ExternalAxis>& axes) {
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  for (size_t k = 0; k < axes.size(); ++k)
    way[static_cast<Eigen::Index>(k)] =
        (to.external[k] - from.external[k]) * (axes[k].kind == AxisKind::kRotary ? kDegPerRad : 1);
  return way;
}

}  // namespace

Interpreted Interpret(const std::string& program, bool nine_axes) {
  const fs::path folder = fs::path(testing::TempDir()) /
                          fmt::format("millpose-rs274-{}", getpid());  // several binaries run at once
  fs::create_directories(folder);
  WriteFileAtomically(folder / "machine.ini", kMachine);
  WriteFileAtomically(folder / "machine.var", "");
  WriteFileAtomically(folder / "tool.tbl", "\n");
  WriteFileAtomically(folder / "program.ngc", program);
  // rs274 maps a tool table in the home folder: runs at the same time must not share it. The module gcode is
  // Debian's.
  const std::string interpreter =
      nine_axes ? fmt::format("PYTHONPATH=/usr/lib/python3/dist-packages /usr/bin/python3 '{}' program.ngc",
                              (fs::path(SourceDir()) / "tests/program/nine_axes.py").string())
                : "rs274 -g -i machine.ini -t tool.tbl program.ngc";
  const std::string command =
      fmt::format("cd '{}' && HOME=. {} > canonical.txt 2>&1 </dev/null", folder.string(), interpreter);
  Interpreted result;
  result.status = std::system(command.c_str());
  result.canonical = ReadFile(folder / "canonical.txt");
  fs::remove_all(folder);
  return result;
}

void ExpectInterpreted(const std::string& text, const MotionProgram& read) {
  const Interpreted result = Interpret(text, !read.external_axes.empty());
  ASSERT_EQ(result.status, 0) << result.canonical;
  const std::vector<CanonicalMove> moves = Moves(result.canonical);
  ASSERT_EQ(moves.size(), read.motions.size());
  for (size_t i = 0; i < moves.size(); ++i) {
    const Motion& motion = read.motions[i];
    const bool pose = motion.type == MotionType::kLinear;
    EXPECT_LT((moves[i].words - WordsOf(motion)).cwiseAbs().maxCoeff(), 0.51e-4) << motion.line;
    for (size_t k = 0; k < read.external_axes.size(); ++k) {
      const bool turns = read.external_axes[k].kind == AxisKind::kRotary;
      EXPECT_NEAR(moves[i].external[k], motion.external[k] * (turns ? kDegPerRad : 1), 0.51e-4)
          << motion.line;
    }
    EXPECT_EQ(moves[i].feed, pose || motion.duration > 0) << motion.line;
    if (pose && motion.duration == 0) {
      EXPECT_NEAR(moves[i].speed, motion.feed * 60, 0.51e-4) << motion.line;
    } else if (motion.duration > 0) {
      const double length = FeedLength(WordsOf(read.motions[i - 1]), WordsOf(motion),
                                       ExternalWay(read.motions[i - 1], motion, read.external_axes));
      EXPECT_NEAR(moves[i].speed, length / motion.duration * 60, 0.51e-4) << motion.line;
    }
  }
}

}  // namespace millpose
