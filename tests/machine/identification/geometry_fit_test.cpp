// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/geometry_fit.hpp"

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// An arm with deviations, drawn, and a tracker that sees a reflector on it.
struct Drawn {
  Arm arm = Kr500R2830();
  ArmDeviations deviations;
  Pose X_TB = Pose::Identity();
  std::vector<Vector3d> reflectors = {{60, -40, 210}};

  Drawn(RandomStream& stream, double mm, double rad) {
    for (size_t i = 1; i < 6; ++i) {
      deviations.shift[i] = mm * RandomNormal3(stream);
      deviations.turn[i] = rad * RandomNormal3(stream);
    }
    X_TB.linear() = FromRotationVector(Vector3d(0.3, -0.2, 2.1));
    X_TB.translation() = Vector3d(3000, -1500, 700);
  }

  Joints AnyPose(RandomStream& stream) const {
    Joints q;
    q << stream.Uniform(-1.2, 1.2), stream.Uniform(-1.8, -0.5), stream.Uniform(0.6, 2),
        stream.Uniform(-2.5, 2.5), stream.Uniform(0.3, 1.7), stream.Uniform(-2.5, 2.5);
    return q;
  }
  Vector3d Seen(const Joints& q, size_t k) const {
    return X_TB * (TrueFlange(arm, deviations, q) * reflectors[k]);
  }
  std::vector<TrackedPose> Measured(int poses, double noise, RandomStream& stream) const {
    std::vector<TrackedPose> all;
    for (int i = 0; i < poses; ++i) {
      TrackedPose& pose = all.emplace_back();
      pose.q = AnyPose(stream);
      for (size_t k = 0; k < reflectors.size(); ++k)
        pose.reflectors.push_back(Seen(pose.q, k) + noise * RandomNormal3(stream));
    }
    return all;
  }
};

/// RMS over new poses of where the fit is off, in the tracker's frame, mm.
double OffAtNewPoses(const Drawn& drawn, const GeometryFit& fit, RandomStream& stream) {
  double square = 0;
  for (int i = 0; i < 100; ++i) {
    const Joints q = drawn.AnyPose(stream);
    square += (fit.bases()[0] * fit.Predict(q, 0).position - drawn.Seen(q, 0)).squaredNorm() / 100;
  }
  return std::sqrt(square);
}

TEST(GeometryFit, ForetellsAnArmFromExactReadings) {
  RandomStream stream(11, 0);
  for (int round = 0; round < 5; ++round) {
    const Drawn drawn(stream, 0.5, 1e-3);
    const std::vector<TrackedPose> poses = drawn.Measured(60, 0, stream);
    GeometryFitOptions nominal;
    nominal.deviations = false;
    EXPECT_GT(OffAtNewPoses(drawn, GeometryFit(drawn.arm, poses, nominal), stream), 0.3);
    const GeometryFit fit(drawn.arm, poses, {});
    EXPECT_LT(fit.rms(), 1e-4);
    EXPECT_LT(OffAtNewPoses(drawn, fit, stream), 1e-3);
    EXPECT_LT((fit.reflectors()[0] - drawn.reflectors[0]).norm(), 5);
  }
}

TEST(GeometryFit, KnowsHowSureItIs) {
  RandomStream stream(12, 0);
  constexpr double kNoise = 0.03;
  int inside = 0, all = 0;
  double level = 0, left_out = 0, foretold = 0;
  constexpr int kArms = 20;
  for (int round = 0; round < kArms; ++round) {
    const Drawn drawn(stream, 1, 3e-3);  // as the prior has it
    const GeometryFit fit(drawn.arm, drawn.Measured(60, kNoise, stream), {});
    level += fit.level() / kArms;
    left_out += fit.left_out() / kArms;
    foretold += std::hypot(OffAtNewPoses(drawn, fit, stream), std::sqrt(3.0) * kNoise) / kArms;
    const std::vector<TrackedPose> others = drawn.Measured(50, kNoise, stream);
    const std::vector<GeometryFit::Foretold> foretold_set = fit.PredictSet(others);
    const auto X_BT = FitBase(fit, others).inverse();
    for (size_t i = 0; i < others.size(); ++i) {
      const Vector3d off = X_BT * others[i].reflectors[0] - foretold_set[i].position;
      for (int axis = 0; axis < 3; ++axis) {
        const double variance = foretold_set[i].covariance(axis, axis) + fit.level() * fit.level();
        inside += std::abs(off[axis]) <= 1.96 * std::sqrt(variance);
        ++all;
      }
    }
  }
  EXPECT_NEAR(level, kNoise, 0.1 * kNoise);
  EXPECT_NEAR(left_out, foretold, 0.1 * foretold);  // leaving one out says what new poses will
  EXPECT_GE(inside, 0.93 * all);
  EXPECT_LE(inside, 0.97 * all);
}

TEST(GeometryFit, ParallelAxesAreToldTogetherAlone) {
  RandomStream stream(13, 0);
  const Drawn drawn(stream, 0.5, 1e-3);
  const GeometryFit fit(drawn.arm, drawn.Measured(60, 0.03, stream), {});
  // Axes 2 and 3 are parallel: shifts of frames 2 and 3 along them add up.
  EXPECT_FALSE(fit.Estimate(2, 1).told());
  EXPECT_FALSE(fit.Estimate(3, 1).told());
  EXPECT_FALSE(fit.Estimate(1, 2).told());  // along joint 1's axis: where the base stands
  EXPECT_TRUE(fit.Estimate(2, 0).told());   // length of the upper arm
  EXPECT_TRUE(fit.Estimate(3, 4).told());   // joint 3's offset
  for (size_t frame = 1; frame < 6; ++frame)
    for (size_t component = 0; component < 6; ++component) {
      const DeviationEstimate one = fit.Estimate(frame, component);
      if (!one.told()) continue;
      const auto axis = static_cast<Eigen::Index>(component % 3);
      const double truth =
          component < 3 ? drawn.deviations.shift[frame][axis] : drawn.deviations.turn[frame][axis];
      EXPECT_NEAR(one.value, truth, 4 * one.deviation) << frame << ' ' << component;
    }
  EXPECT_GT(fit.condition(), 1);
}

TEST(GeometryFit, TakesSeveralReflectorsAndTrackersThatWereMoved) {
  RandomStream stream(14, 0);
  Drawn drawn(stream, 0.5, 1e-3);
  drawn.reflectors = {{60, -40, 210}, {-120, 30, 180}, {20, 150, 60}};
  std::vector<TrackedPose> poses = drawn.Measured(20, 0.03, stream);
  Drawn moved = drawn;
  moved.X_TB.linear() = FromRotationVector(Vector3d(-0.5, 0.1, -1));
  moved.X_TB.translation() = Vector3d(-2000, 400, 100);
  for (TrackedPose pose : moved.Measured(20, 0.03, stream)) {
    pose.set = 1;
    poses.push_back(pose);
  }
  const GeometryFit fit(drawn.arm, poses, {});
  EXPECT_NEAR(fit.level(), 0.03, 0.006);
  EXPECT_LT(OffAtNewPoses(drawn, fit, stream), 0.06);
  EXPECT_NEAR(fit.RmsOf(0), fit.RmsOf(1), 0.02);
  EXPECT_EQ(fit.readings(), 120u);
}

TEST(GeometryFit, ProposedPosesHelpMoreThanOthers) {
  RandomStream stream(15, 0);
  const Drawn drawn(stream, 0.5, 1e-3);
  const GeometryFit fit(drawn.arm, drawn.Measured(15, 0.03, stream), {});
  std::vector<Joints> candidates;
  for (int i = 0; i < 100; ++i) candidates.push_back(drawn.AnyPose(stream));
  GeometryFit best = fit, any = fit;
  const auto spread = [&](const GeometryFit& of) {
    double sum = 0;
    for (const Joints& q : candidates) sum += of.Predict(q, 0).covariance.trace();
    return sum;
  };
  for (int i = 0; i < 5; ++i) {
    best.Add(*std::ranges::max_element(candidates, {}, [&](const Joints& q) { return best.Gain(q); }));
    any.Add(candidates[static_cast<size_t>(i)]);
  }
  EXPECT_LT(spread(best), spread(any));
  EXPECT_LT(spread(any), spread(fit));
}

// What it is for: the worst error along the normal on a face, once programs are commanded by the fitted arm
// and the part's frame was measured with it.
TEST(GeometryFit, TakesTheGeometryOutOfAFace) {
  RandomStream stream(16, 0);
  const Vector3d tip(-150, 0, 250);
  std::vector<double> before, after, after_few;
  for (int round = 0; round < 20; ++round) {
    const Drawn drawn(stream, 0.25, 3e-4);
    const GeometryFit many(drawn.arm, drawn.Measured(60, 0.03, stream), {}),
        few(drawn.arm, drawn.Measured(20, 0.03, stream), {});
    const auto worst = [&](const ArmDeviations* known) {
      Eigen::MatrixXd rows(121, 6);
      Eigen::VectorXd off(121);
      const Vector3d n = Vector3d(-1, 0, 0.4).normalized();
      Eigen::Index at = 0;
      for (int i = -5; i <= 5; ++i)
        for (int k = -5; k <= 5; ++k, ++at) {
          const Vector3d place = Vector3d(2100, 0, 900) + 100 * i * Vector3d::UnitY() +
                                 100 * k * Vector3d(0.4, 0, 1).normalized();
          Pose X_BF = Pose::Identity();
          const Vector3d z = -n, x = Vector3d::UnitY();
          X_BF.linear() << x, z.cross(x), z;
          X_BF.linear() = X_BF.linear() * FromRotationVector(Vector3d(0, 0, 0.15 * i + 0.2 * k));
          X_BF.translation() = place - X_BF.linear() * tip;
          const Joints near(0, -1.1, 1.8, 0, 0.9, 0);
          const auto q = known ? TrueInverseNear(drawn.arm, *known, X_BF, 2, near)
                               : InverseNear(drawn.arm, X_BF, 2, near);
          if (!q) return -1.0;
          off[at] = n.dot(TrueFlange(drawn.arm, drawn.deviations, *q) * tip - place);
          rows.row(at) << n.transpose(), ((place - Vector3d(2100, 0, 900)) / 300).cross(n).transpose();
        }
      const Eigen::VectorXd left = off - rows * LeastSquares(rows, off, 1e-6);
      return left.cwiseAbs().maxCoeff();
    };
    before.push_back(worst(nullptr));
    after.push_back(worst(&many.deviations()));
    after_few.push_back(worst(&few.deviations()));
    ASSERT_GT(before.back(), 0);
    ASSERT_GT(after.back(), 0);
  }
  const auto median = [](std::vector<double> values) {
    std::ranges::sort(values);
    return 0.5 * (values[values.size() / 2 - 1] + values[values.size() / 2]);
  };
  RecordProperty("before_um", std::to_string(1e3 * median(before)));
  RecordProperty("after_um", std::to_string(1e3 * median(after)));
  RecordProperty("after_few_um", std::to_string(1e3 * median(after_few)));
  EXPECT_GT(median(before), 0.1);
  EXPECT_LT(median(after), 0.2 * median(before));
  EXPECT_LT(median(after_few), 0.5 * median(before));
}

// Patterns alone say as much of new places as the whole covariance, and hold what arms really differ by.
TEST(GeometryFit, ItsPatternsTellWhatIsLeftAtNewPlaces) {
  RandomStream stream(18, 0);
  int inside = 0, all = 0;
  for (int round = 0; round < 30; ++round) {
    Drawn drawn(stream, 0.25, 3e-4);  // as the prior has it
    // Along and about joint 6's axis: of the tool, which no reflector tells.
    drawn.deviations.shift[5].x() = drawn.deviations.turn[5].x() = 0;
    const std::vector<TrackedPose> poses = drawn.Measured(40, 0.03, stream);
    const GeometryFit fit(drawn.arm, poses, {.shift_prior = 0.25, .turn_prior = 3e-4});
    const std::vector<ArmDeviations> patterns = fit.Patterns();
    const Vector3d tip(-150, 0, 250);
    std::vector<Joints> places;
    for (int i = 0; i < 40; ++i) places.push_back(drawn.AnyPose(stream));
    // Displacements of the tip by `other` against the fit, less the rigid motion that takes up most of it.
    const auto displaced = [&](const ArmDeviations& other) {
      Eigen::MatrixXd base(3 * 40, 6);
      Eigen::VectorXd off(3 * 40);
      for (Eigen::Index i = 0; i < 40; ++i) {
        const Joints& q = places[static_cast<size_t>(i)];
        const Vector3d there = TrueFlange(drawn.arm, fit.deviations(), q) * tip, r = there / 1000;
        off.segment<3>(3 * i) = TrueFlange(drawn.arm, other, q) * tip - there;
        Eigen::Matrix3d turn;
        turn << 0, r.z(), -r.y(), -r.z(), 0, r.x(), r.y(), -r.x(), 0;
        base.middleRows<3>(3 * i) << Eigen::Matrix3d::Identity(), turn;
      }
      return Eigen::VectorXd(off - base * base.colPivHouseholderQr().solve(off));
    };
    Eigen::VectorXd variance = Eigen::VectorXd::Zero(3 * 40);
    for (const ArmDeviations& pattern : patterns) {
      ArmDeviations other = fit.deviations();
      for (size_t k = 0; k < 7; ++k) {
        other.shift[k] += pattern.shift[k];
        other.turn[k] += pattern.turn[k];
      }
      variance += displaced(other).cwiseAbs2();
    }
    const Eigen::VectorXd off = displaced(drawn.deviations);
    for (Eigen::Index i = 0; i < off.size(); ++i, ++all)
      inside += off[i] * off[i] <= 1.96 * 1.96 * variance[i];
  }
  EXPECT_GE(inside, 0.92 * all);
  EXPECT_LE(inside, 0.975 * all);
}

TEST(GeometryFit, SaysWhatIsMissing) {
  RandomStream stream(17, 0);
  const Drawn drawn(stream, 0.5, 1e-3);
  EXPECT_THROW(GeometryFit(drawn.arm, drawn.Measured(3, 0, stream), {}), InputError);
}

}  // namespace
}  // namespace millpose
