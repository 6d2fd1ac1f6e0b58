// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/revolutions.hpp"

#include <bit>

#include "tests/machine/collision/sample_cell.hpp"

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
  ChooseRevolutions(passes, {HomePose(), arm.lower, arm.upper, false});
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
  ChooseRevolutions(passes, {HomePose(), arm.lower, arm.upper, false});
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
    ChooseRevolutions(passes, {HomePose(), arm.lower, arm.upper, false});
    EXPECT_NEAR(Turning(passes, HomePose(), 5), best, 1e-9);
  }
}

TEST(Turns, RingsThatWindRunTheOtherWayWhereDirectionsAreFree) {
  const Arm arm = SampleArm();
  // The inner skin of a cabin: every ring turns A6 by 360°, from −180° on, and starts again at the same
  // place.
  const auto rings = [] {
    std::vector<PassResult> passes;
    for (int p = 0; p < 6; ++p) {
      std::vector<std::pair<double, double>> wrist;
      for (int i = 0; i < 36; ++i) wrist.emplace_back(0, -180 + 10 * i);
      passes.push_back(Course(p, wrist, true));
      for (int i = 0; i < 36; ++i) {
        MillingPoint& point = passes.back().points[i].point;
        const double angle = DegToRad(10.0 * i);
        point.position = {0, 500 * std::cos(angle), 500 * std::sin(angle)};
        point.feed = {0, -std::sin(angle), std::cos(angle)};
        point.arc_length = 500 * angle;
      }
    }
    return passes;
  };
  const auto turning = [&](const std::vector<PassResult>& passes) {  // a ring ends a turn from where it began
    double sum = 0, at = 0;
    for (const PassResult& pass : passes) {
      const double start = pass.points.front().q[5], last = pass.points.back().q[5];
      sum += std::abs(start - at);
      at = start + (last > start ? 2 * kPi : -2 * kPi);
    }
    return RadToDeg(sum + std::abs(at));
  };
  std::vector<PassResult> fixed = rings(), free = rings();
  ChooseRevolutions(fixed, {HomePose(), arm.lower, arm.upper, false});
  ChooseRevolutions(free, {HomePose(), arm.lower, arm.upper, true});
  EXPECT_NEAR(turning(fixed), 180 + 5 * 360 + 180, 1e-9);  // unwound in every gap
  EXPECT_NEAR(turning(free), 180 + 180, 1e-9);             // never
  bool before = free[0].points[1].point.feed.dot(fixed[0].points[1].point.feed) > 0;
  for (int p = 0; p < 6; ++p) {
    const PassResult &pass = free[p], &as_laid = fixed[p];
    const bool reversed = pass.points[1].point.feed.dot(as_laid.points[1].point.feed) < 0;
    EXPECT_NE(reversed, before) << p;  // every second one
    before = reversed;
    EXPECT_EQ(pass.points[0].point.position, as_laid.points[0].point.position);
    for (int i = 0; i < 36; ++i) {
      const PlannedPoint& point = pass.points[i];
      EXPECT_EQ(point.point.position, as_laid.points[reversed ? (36 - i) % 36 : i].point.position);
      if (i > 0) {
        const Eigen::Vector3d way = point.point.position - pass.points[i - 1].point.position;
        EXPECT_GT(way.dot(point.point.feed), 0);
        EXPECT_NEAR(point.point.arc_length - pass.points[i - 1].point.arc_length, 500 * DegToRad(10), 2);
        EXPECT_NEAR(std::abs(point.q[5] - pass.points[i - 1].q[5]), DegToRad(10), 1e-9);
      }
      EXPECT_GE(point.q[5], arm.lower[5]);
      EXPECT_LE(point.q[5], arm.upper[5]);
    }
  }
}

TEST(Turns, ChoosesDirectionsOfLeastTurningOfAllCombinations) {
  RandomStream random(29, 0);
  int reversed = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<PassResult> passes;
    for (int p = 0; p < 5; ++p) {
      const double a4 = random.Uniform(-100, 100), a6 = random.Uniform(-60, 60),
                   turn = random.Uniform(-80, 80);
      passes.push_back(Course(p, {{a4, a6}, {a4, a6 + turn / 2}, {a4, a6 + turn}}));
    }
    const auto cost = [](const std::vector<PassResult>& tried, int reversals) {
      return Turning(tried, HomePose(), 3) + Turning(tried, HomePose(), 5) + kReversal * reversals;
    };
    double best = 1e9;
    for (int code = 0; code < 32; ++code) {
      std::vector<PassResult> tried = passes;
      for (int p = 0; p < 5; ++p) {
        if (code >> p & 1) std::reverse(tried[p].points.begin(), tried[p].points.end());
      }
      best = std::min(best, cost(tried, std::popcount(static_cast<unsigned>(code))));
    }
    const std::vector<PassResult> before = passes;
    // No full revolution fits beside another.
    ChooseRevolutions(passes,
                      {HomePose(), Joints::Constant(DegToRad(-179)), Joints::Constant(DegToRad(179)), true});
    int reversals = 0;
    for (int p = 0; p < 5; ++p) reversals += passes[p].points[0].q != before[p].points[0].q;
    EXPECT_NEAR(cost(passes, reversals), best, 1e-9);
    reversed += reversals;
  }
  EXPECT_GT(reversed, 20);
}

// Limits of ±178 "radians" on six axes: 57^6 combinations of full revolutions.
TEST(Turns, OfMoreCombinationsThanMatterThoseNearestHomeAreCompared) {
  std::vector<PassResult> passes{Course(0, {{10, 20}, {12, 24}}), Course(1, {{170, -160}, {175, -165}})};
  const std::vector<PassResult> given = passes;
  const Joints wide = Joints::Constant(178);
  EXPECT_EQ(ChooseRevolutions(passes, {HomePose(), -wide, wide, false}), 2u);
  for (size_t p = 0; p < passes.size(); ++p)
    for (size_t i = 0; i < passes[p].points.size(); ++i)
      EXPECT_LT((passes[p].points[i].q - given[p].points[i].q).cwiseAbs().maxCoeff(), 2 * kPi + 1e-9);
  EXPECT_LE(Turning(passes, HomePose(), 3), Turning(given, HomePose(), 3) + 1e-9);
  const Arm arm = SampleArm();
  EXPECT_EQ(ChooseRevolutions(passes, {HomePose(), arm.lower, arm.upper, true}), 0u);
}

}  // namespace
}  // namespace millpose::test
