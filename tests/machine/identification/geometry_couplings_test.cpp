// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/geometry_couplings.hpp"

#include "tests/base/tier.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Readings of an arm with deviations of which one joint follows another; the tracker's frame is the base's.
std::vector<TrackedPose> Followed(int poses, const JointPair& coupling, double share, double noise,
                                  RandomStream& stream) {
  const Arm arm = Kr500R2830();
  ArmDeviations deviations;
  for (size_t i = 1; i < 6; ++i) {
    deviations.shift[i] = 0.3 * RandomNormal3(stream);
    deviations.turn[i] = 5e-4 * RandomNormal3(stream);
  }
  std::vector<TrackedPose> all;
  for (int i = 0; i < poses; ++i) {
    TrackedPose& pose = all.emplace_back();
    pose.q << stream.Uniform(-1.2, 1.2), stream.Uniform(-1.8, -0.5), stream.Uniform(0.6, 2),
        stream.Uniform(-2.5, 2.5), stream.Uniform(0.3, 1.7), stream.Uniform(-2.5, 2.5);
    Joints turned = pose.q;
    turned[coupling.joint - 1] += share * pose.q[coupling.follows - 1];
    pose.reflectors.push_back(TrueFlange(arm, deviations, turned) * Vector3d(60, -40, 210) +
                              noise * RandomNormal3(stream));
  }
  return all;
}

CouplingModels Tried(const std::vector<TrackedPose>& poses) {
  const Arm arm = Kr500R2830();
  return TryCouplings(arm, poses, {}, GeometryFit(arm, poses, {}));
}

TEST(GeometryCouplings, FindsTheJointThatFollows) {
  RandomStream stream(31, 0);
  for (const auto& [coupling, share] :
       {std::pair(JointPair{3, 2}, 5e-4), std::pair(JointPair{6, 5}, -2e-3)}) {
    const CouplingModels models = Tried(Followed(60, coupling, share, 0.02, stream));
    const CouplingModel& chosen = models.tried[models.chosen];
    ASSERT_EQ(chosen.couplings, std::vector<JointPair>{coupling});
    EXPECT_NEAR(chosen.estimates[0].value, share, 4 * chosen.estimates[0].deviation);
    EXPECT_LT(chosen.estimates[0].deviation, 0.2 * std::abs(share));
    EXPECT_LT(chosen.mean_square, models.tried[0].mean_square);
  }
}

TEST(GeometryCouplings, NoneIsMadeUp) {
  RandomStream stream(32, 0);
  const int draws = OfTier(10, 100);
  int none = 0;
  for (int draw = 0; draw < draws; ++draw)
    none += Tried(Followed(40, {3, 2}, 0, 0.03, stream)).chosen == 0 ? 1 : 0;
  EXPECT_GE(none, draws * 95 / 100);
}

}  // namespace
}  // namespace millpose
