// SPDX-License-Identifier: GPL-3.0-or-later
#include <functional>

#include "base/random.hpp"
#include "machine/collision/world.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

ArmDeviations Drawn(RandomStream& stream, double mm, double rad) {
  ArmDeviations deviations;
  for (size_t i = 0; i < 7; ++i) {
    deviations.shift[i] = mm * Eigen::Vector3d(stream.Normal(), stream.Normal(), stream.Normal());
    deviations.turn[i] = rad * Eigen::Vector3d(stream.Normal(), stream.Normal(), stream.Normal());
  }
  return deviations;
}

Joints DrawnNear(RandomStream& stream, double reach) {
  Joints q = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  for (double& angle : q) angle += stream.Uniform(-reach, reach);
  return q;
}

/// A cell of the nominal arm whose bodies hang, at `q` alone, where the arm as it is has them.
Cell FrozenAt(Cell cell, const ArmDeviations& deviations, const Joints& q) {
  const std::array<Pose, 7> nominal = LinkFrames(cell.arm, q);
  Pose own = Pose::Identity();
  std::array<Pose, 7> off;
  for (size_t i = 0; i < 7; ++i) {
    own = own * (i == 0 ? nominal[0] : nominal[i - 1].inverse() * nominal[i]) * DeviationOf(deviations, i);
    off[i] = nominal[i].inverse() * own;
  }
  for (Body& body : cell.bodies)
    if (body.mount == Mount::kLink) body.X_MG = off[static_cast<size_t>(body.link)] * body.X_MG;
  cell.X_FT = off[6] * cell.X_FT;
  return cell;
}

Cell WithPart() {
  Cell cell = SampleCell();
  const Joints q = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  cell.X_WP = cell.X_WB * ForwardFlange(cell.arm, q) * cell.X_FT * At(0, 0, -80);
  cell.bodies.push_back({"part", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, Pose::Identity(),
                         Shape(Box{Eigen::Vector3d(300, 300, 100)})});
  return cell;
}

TEST(AsItIs, BodiesHangOnTheTrueLinks) {
  RandomStream stream(31, 0);
  const Cell cell = WithPart();
  const ArmDeviations deviations = Drawn(stream, 3, 3e-3);
  const World own(AsItIs(cell, deviations)), nominal(cell);
  double most = 0;
  for (int round = 0; round < 40; ++round) {
    const Joints q = DrawnNear(stream, 0.15);
    const World frozen(FrozenAt(cell, deviations, q));
    for (const Phase phase : {Phase::kFree, Phase::kCutting}) {
      const double distance = Checker(own).Clearance(q, phase, 500);
      EXPECT_NEAR(distance, Checker(frozen).Clearance(q, phase, 500), 1e-6);
      most = std::max(most, std::abs(distance - Checker(nominal).Clearance(q, phase, 500)));
    }
  }
  EXPECT_GT(most, 1);  // else the test would see nothing
}

/// What is found free along a motion is free in all its poses; `draw`: an arm as it is, anew each time.
void ExpectFreeAllAlong(RandomStream& stream, const std::function<ArmDeviations()>& draw) {
  const Cell cell = WithPart();
  constexpr double kResolution = 0.5;  // mm
  int free = 0, blocked = 0;
  for (int round = 0; round < 60; ++round) {
    const World own(AsItIs(cell, draw()));
    Checker checker(own), dense(own, 1, kResolution + 1e-6);
    const Joints from = DrawnNear(stream, 0.1), to = DrawnNear(stream, 0.1);
    if (checker.Between(from, to, Phase::kFree, kResolution)) {
      ++blocked;
      continue;
    }
    ++free;
    for (int i = 0; i <= 100; ++i)
      EXPECT_FALSE(dense.At(from + 0.01 * i * (to - from), Phase::kFree)) << round << ' ' << i;
  }
  EXPECT_GT(free, 5);
  EXPECT_GT(blocked, 5);
}

// The motion bounds know on which axes the true links turn.
TEST(AsItIs, MotionsFoundFreeAreFreeAllAlong) {
  RandomStream stream(32, 0);
  ExpectFreeAllAlong(stream, [&] { return Drawn(stream, 5, 5e-3); });
}

/// Steeper than any gear: joints go by a tenth of their turn more, or less.
JointLaw Steep(RandomStream& stream) {
  JointLaw law;
  for (int joint = 1; joint <= 6; ++joint)
    law.harmonics.push_back({joint, 20, 0.0045, stream.Uniform(-3.1, 3.1)});
  return law;
}

TEST(AsItIs, BodiesHangWhereTheLawOfTheJointsHasThem) {
  RandomStream stream(34, 0);
  const Cell cell = WithPart();
  ArmDeviations turned;
  turned.law = Steep(stream);
  const World own(AsItIs(cell, turned)), nominal(cell);
  double most = 0;
  for (int round = 0; round < 40; ++round) {
    const Joints q = DrawnNear(stream, 0.15);
    const double distance = Checker(own).Clearance(q, Phase::kFree, 500);
    EXPECT_NEAR(distance, Checker(nominal).Clearance(turned.law.At(q), Phase::kFree, 500), 1e-6);
    most = std::max(most, std::abs(distance - Checker(nominal).Clearance(q, Phase::kFree, 500)));
  }
  EXPECT_GT(most, 1);
}

// Joints go farther than their controller has them.
TEST(AsItIs, MotionsFoundFreeAreFreeAllAlongWhereJointsRunAhead) {
  RandomStream stream(35, 0);
  ExpectFreeAllAlong(stream, [&] {
    ArmDeviations turned;
    turned.law = Steep(stream);
    return turned;
  });
}

TEST(AsItIs, WithoutDeviationsNothingChanges) {
  RandomStream stream(33, 0);
  const Cell cell = WithPart();
  const World own(AsItIs(cell, {})), nominal(cell);
  for (int round = 0; round < 20; ++round) {
    const Joints q = DrawnNear(stream, 0.1);
    EXPECT_NEAR(Checker(own).Clearance(q, Phase::kFree, 500),
                Checker(nominal).Clearance(q, Phase::kFree, 500), 1e-9);
  }
}

}  // namespace
}  // namespace millpose::test
