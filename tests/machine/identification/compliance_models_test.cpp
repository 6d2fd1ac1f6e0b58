// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/compliance_models.hpp"

#include "machine/stiffness/compliance.hpp"
#include "machine/stiffness/series.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// An arm whose links 1 to 6 tilt by `tilt` (rad/(N·mm), about both axes across the joint's) and whose base
/// moves by `base` (mm/N).
struct DrawnArm {
  Arm arm;
  std::vector<SeriesCompliance> elements;

  DrawnArm(const Arm& nominal, const std::vector<std::pair<int, double>>& tilts, double base = 0)
      : arm(nominal) {
    constexpr int kOwn[] = {2, 1, 1, 0, 1, 2};
    for (const auto& [link, tilt] : tilts) {
      SeriesCompliance element;
      element.link = link;
      for (int axis = 0; axis < 3; ++axis)
        if (axis != kOwn[link - 1]) element.C(3 + axis, 3 + axis) = tilt;
      elements.push_back(element);
    }
    SeriesCompliance foot;
    foot.C.topLeftCorner<3, 3>() = base * Eigen::Matrix3d::Identity();
    elements.push_back(foot);
  }

  /// By the stiffness module's own compliance, at the point where the load acts.
  LoadCase Loaded(const Joints& q, const Vector3d& force, double noise, RandomStream& stream) const {
    LoadCase load;
    load.q = q;
    load.force = force;
    load.load_point = load.measured_point = Vector3d(-120, 90, 260);
    const Matrix6 C = Compliance(Jacobian(arm, q, load.load_point), arm.stiffness) +
                      SeriesComplianceAt(arm, q, load.load_point, elements);
    load.displacement = C.topLeftCorner<3, 3>() * force + noise * RandomNormal3(stream);
    return load;
  }

  std::vector<LoadCase> Measured(int poses, double noise, RandomStream& stream) const {
    std::vector<LoadCase> cases;
    for (int i = 0; i < poses; ++i) {
      Joints q;
      q << stream.Uniform(-1, 1), stream.Uniform(-1.7, -0.6), stream.Uniform(0.8, 2), stream.Uniform(-2, 2),
          stream.Uniform(0.4, 1.6), stream.Uniform(-2, 2);
      cases.push_back(Loaded(q, 500 * RandomNormal3(stream).normalized(), noise, stream));
    }
    return cases;
  }
};

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
  EXPECT_EQ(models.tried[models.chosen].tilting, std::vector<int>{3});
  EXPECT_FALSE(models.tried[models.chosen].base);
  EXPECT_LT(models.tried[models.chosen].mean_square, 0.3 * models.tried[0].mean_square);
  for (size_t i = 1; i < models.tried.size(); ++i)
    EXPECT_GT(models.tried[i].unknowns, models.tried[i - 1].unknowns);
  // Alone its error is that of poses which it was not fitted to: some 0.01²·3 and what fitting adds.
  EXPECT_NEAR(models.tried[models.chosen].mean_square, 3e-4, 1.5e-4);
}

// A model richer than the data supports: springs alone are drawn, springs alone are chosen.
TEST(ComplianceModels, SpringsAloneWhereNothingElseGives) {
  RandomStream stream(5, 0);
  const DrawnArm drawn(KrQuantecR2700(), {});
  int springs = 0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run)
    springs += TryModels(drawn.arm, drawn.Measured(30, 0.02, stream), {}).chosen == 0;
  EXPECT_GE(springs, kRuns * 95 / 100);
  EXPECT_EQ(TryModels(drawn.arm, drawn.Measured(8, 0.02, stream), {}).tried.size(), 1u);
}

TEST(ComplianceModels, IntervalsHoldTheTruth) {
  RandomStream stream(6, 0);
  const DrawnArm drawn(KrQuantecR2700(), {{3, 8e-10}});
  IdentifyOptions options;
  options.beside = TiltingOf(3);
  const std::vector<LoadCase> exact = drawn.Measured(40, 0, stream);
  constexpr int kRuns = 1000;
  std::array<int, 8> inside{};
  for (int run = 0; run < kRuns; ++run) {
    std::vector<LoadCase> noisy = exact;
    for (LoadCase& load : noisy) load.displacement += 0.01 * RandomNormal3(stream);
    const Identification found = IdentifyJointStiffness(drawn.arm, noisy, options);
    for (size_t j = 0; j < 6; ++j) {
      const double truth = drawn.arm.stiffness[static_cast<Eigen::Index>(j)];
      inside[j] += found.joints[j].lower <= truth && truth <= found.joints[j].upper;
    }
    for (size_t k = 0; k < 2; ++k)
      inside[6 + k] += found.beside[k].lower <= 8e-10 && 8e-10 <= found.beside[k].upper;
  }
  for (size_t j = 0; j < inside.size(); ++j) {
    EXPECT_GE(inside[j], 0.93 * kRuns) << j;
    EXPECT_LE(inside[j], 0.97 * kRuns) << j;
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
