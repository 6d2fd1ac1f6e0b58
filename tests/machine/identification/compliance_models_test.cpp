// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/compliance_models.hpp"

#include "tests/machine/identification/drawn_arm.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

TEST(ComplianceModels, FindsWhatTilts) {
  RandomStream stream(3, 0);
  const DrawnArm drawn(KrQuantecR2700(), {{1, 2e-10}, {3, 6e-10}});
  const std::vector<LoadCase> cases = drawn.Measured(40, 0, stream);
  IdentifyOptions options;
  options.beside = TiltingOf(1);
  std::ranges::copy(TiltingOf(3), std::back_inserter(options.beside));
  const Identification found = IdentifyJointStiffness(drawn.arm, cases, options);
  for (int j = 0; j < 6; ++j)
    EXPECT_NEAR(found.joints[j].stiffness / drawn.arm.stiffness[j], 1, 1e-7) << found.joints[j].reason;
  ASSERT_EQ(found.beside.size(), 4u);
  for (const GiveEstimate& give : found.beside) {
    EXPECT_TRUE(give.determined) << give.reason;
    EXPECT_NEAR(give.compliance / (give.give.link == 1 ? 2e-10 : 6e-10), 1, 1e-6);
  }
  EXPECT_LT(found.rms, 1e-10);
}

TEST(ComplianceModels, ARicherModelIsChosenWhereItForetellsBetter) {
  RandomStream stream(4, 0);
  const DrawnArm drawn(KrQuantecR2700(), {{3, 8e-10}});
  const std::vector<LoadCase> cases = drawn.Measured(40, 0.01, stream);
  const ComplianceModels models = TryModels(drawn.arm, cases, {});
  ASSERT_GT(models.tried.size(), 2u);
  EXPECT_EQ(models.tried[models.chosen].steps,
            (std::vector<ComplianceStep>{{ComplianceStep::Kind::kTilting, 3}}));
  EXPECT_LT(models.tried[models.chosen].mean_square, 0.3 * models.tried[0].mean_square);
  for (size_t i = 1; i < models.tried.size(); ++i)
    EXPECT_GT(models.tried[i].unknowns, models.tried[i - 1].unknowns);
  // Alone its error is that of poses which it was not fitted to: some 0.01²·3 and what fitting adds.
  EXPECT_NEAR(models.tried[models.chosen].mean_square, 3e-4, 1.5e-4);
}

// Also with so much noise that A4, A6 or the tilting about x, which act nearly alike, end at 0 in many runs:
// their intervals, cut off at 0, may then hold the truth more often.
TEST(ComplianceModels, IntervalsHoldTheTruth) {
  RandomStream stream(6, 0);
  const DrawnArm drawn(KrQuantecR2700(), {{3, 8e-10}});
  IdentifyOptions options;
  options.beside = TiltingOf(3);
  const std::vector<LoadCase> exact = drawn.Measured(40, 0, stream);
  constexpr int kRuns = 1000;
  for (const auto& [noise, most] : {std::pair(0.01, 0.97), std::pair(0.03, 0.985)}) {
    std::array<int, 8> inside{};
    int at_zero = 0;
    for (int run = 0; run < kRuns; ++run) {
      std::vector<LoadCase> noisy = exact;
      for (LoadCase& load : noisy) load.displacement += noise * RandomNormal3(stream);
      const Identification found = IdentifyJointStiffness(drawn.arm, noisy, options);
      for (size_t j = 0; j < 6; ++j) {
        const double truth = drawn.arm.stiffness[static_cast<Eigen::Index>(j)];
        inside[j] += found.joints[j].lower <= truth && truth <= found.joints[j].upper;
        at_zero += found.joints[j].determined ? 0 : 1;
      }
      for (size_t k = 0; k < 2; ++k)
        inside[6 + k] += found.beside[k].lower <= 8e-10 && 8e-10 <= found.beside[k].upper;
    }
    for (size_t j = 0; j < inside.size(); ++j) {
      EXPECT_GE(inside[j], 0.93 * kRuns) << j << " " << noise;
      EXPECT_LE(inside[j], most * kRuns) << j << " " << noise;
    }
    if (noise > 0.02) {
      EXPECT_GT(at_zero, kRuns / 10);
    }
  }
}

// What single unknowns are 0 is found exactly: no other set of them fits better.
TEST(ComplianceModels, NoSetOfUnknownsFitsBetter) {
  RandomStream stream(7, 0);
  const DrawnArm drawn(KrQuantecR2700(), {});
  IdentifyOptions options;
  options.beside = TiltingOf(2);
  for (int round = 0; round < 20; ++round) {
    const std::vector<LoadCase> cases = drawn.Measured(6, 0.3, stream);
    const Identification found = IdentifyJointStiffness(drawn.arm, cases, options);
    const auto off = [&](const Joints& c, double first, double second) {
      double square = 0;
      for (const LoadCase& load : cases) {
        const Matrix6 J = Jacobian(drawn.arm, load.q, load.load_point);
        Vector3d moved = Vector3d::Zero();
        const Joints torque = J.topRows<3>().transpose() * load.force;
        for (int j = 0; j < 6; ++j) moved += c[j] * torque[j] * J.block<3, 1>(0, j);
        const std::array<Pose, 7> frames = LinkFrames(drawn.arm, load.q);
        for (const auto& [axis, give] : {std::pair(0, first), std::pair(2, second)}) {
          const Vector3d a = frames[2].linear().col(axis),
                         lever = a.cross(frames[6] * load.load_point - frames[2].translation());
          moved += give * lever.dot(load.force) * lever;
        }
        square += (moved - load.displacement).squaredNorm();
      }
      return square;
    };
    Joints c = Joints::Zero();
    for (int j = 0; j < 6; ++j)
      if (found.joints[static_cast<size_t>(j)].determined)
        c[j] = 1 / found.joints[static_cast<size_t>(j)].stiffness;
    const double first = found.beside[0].compliance, second = found.beside[1].compliance;
    const double least = off(c, first, second);
    // A step of any unknown that keeps it above 0 fits no better.
    constexpr double kStep = 1e-12;
    for (int j = 0; j < 6; ++j)
      for (const double step : {kStep, -kStep}) {
        Joints other = c;
        other[j] += step;
        if (other[j] >= 0) {
          EXPECT_GE(off(other, first, second), least * (1 - 1e-12)) << round << j;
        }
      }
    EXPECT_GE(off(c, first + kStep, second), least * (1 - 1e-12));
    EXPECT_GE(off(c, first, second + kStep), least * (1 - 1e-12));
  }
}

}  // namespace
}  // namespace millpose
