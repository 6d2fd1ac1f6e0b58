// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/job_planner.hpp"
#include "tests/cell/sample_cell.hpp"

namespace millpose::test {
namespace {

/// One pass with one piece whose A4 and A6 (degrees) take the given values.
PassResult Course(int number, std::vector<std::pair<double, double>> wrist, bool closed = false) {
  PassResult pass;
  pass.pass = number;
  for (const auto& [a4, a6] : wrist) {
    PlannedPoint point;
    point.q = Degrees(0, -90, 90, a4, 30, a6);
    pass.points.push_back(point);
  }
  pass.pieces.push_back({number, 0, 0, static_cast<int>(wrist.size()) - 1, closed});
  return pass;
}

double Turning(const std::vector<PassResult>& passes, const Joints& home, int j) {
  double sum = 0, at = home[j];
  for (const PassResult& pass : passes) {
    sum += std::abs(pass.points.front().q[j] - at);
    at = pass.points.back().q[j];
  }
  return sum + std::abs(home[j] - at);
}

TEST(Turns, PiecesAreMadeContinuousAndStayWithinLimits) {
  const Arm arm = SampleArm();
  // A6 runs through ±180° in principal angles.
  std::vector<PassResult> passes{Course(0, {{0, 170}, {0, 175}, {0, -180}, {0, -175}})};
  FixTurns(passes, HomePose(), arm.lower, arm.upper);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(RadToDeg(passes[0].points[i].q[5]), 170 + 5 * i, 1e-9);
}

TEST(Turns, ARingThatWindsMustUnwindInTheGap) {
  const Arm arm = SampleArm();
  // Each ring turns A6 by 360° from −180° on: the limits of ±350° admit no ring after another.
  std::vector<PassResult> passes;
  for (int p = 0; p < 3; ++p) {
    std::vector<std::pair<double, double>> wrist;
    for (int i = 0; i < 36; ++i) wrist.emplace_back(0, -180 + 10 * i);
    passes.push_back(Course(p, wrist, true));
  }
  FixTurns(passes, HomePose(), arm.lower, arm.upper);
  for (const PassResult& pass : passes) {
    for (const PlannedPoint& point : pass.points) {
      EXPECT_GE(point.q[5], arm.lower[5]);
      EXPECT_LE(point.q[5], arm.upper[5]);
    }
    EXPECT_NEAR(RadToDeg(pass.points.front().q[5]), -180, 1e-9);
  }
}

TEST(Turns, ChoosesTheLeastTurningOfAllCombinations) {
  const Arm arm = SampleArm();
  RandomStream random(23, 0);
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<PassResult> passes;
    for (int p = 0; p < 4; ++p) {
      double a4 = random.Uniform(-180, 180), a6 = random.Uniform(-180, 180);
      std::vector<std::pair<double, double>> wrist;
      for (int i = 0; i < 10; ++i) {
        wrist.emplace_back(a4, a6);
        a4 += random.Uniform(-3, 9), a6 += random.Uniform(-9, 3);
      }
      passes.push_back(Course(p, wrist));
    }
    // All combinations of −1, 0, 1 turns for A6 that keep the limits, by brute force.
    double best = 1e9;
    for (int code = 0; code < 81; ++code) {
      std::vector<PassResult> tried = passes;
      int rest = code;
      bool inside = true;
      for (PassResult& pass : tried) {
        for (PlannedPoint& point : pass.points) {
          point.q[5] += 2 * kPi * (rest % 3 - 1);
          inside &= point.q[5] >= arm.lower[5] && point.q[5] <= arm.upper[5];
        }
        rest /= 3;
      }
      if (inside) best = std::min(best, Turning(tried, HomePose(), 5));
    }
    FixTurns(passes, HomePose(), arm.lower, arm.upper);
    EXPECT_NEAR(Turning(passes, HomePose(), 5), best, 1e-9);
  }
}

}  // namespace
}  // namespace millpose::test
