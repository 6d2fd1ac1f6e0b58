// SPDX-License-Identifier: GPL-3.0-or-later
// What an arm's joints do when its controller has them at given angles: tables of the gears' transmission
// error, and joints that follow others (docs/gear-table.md).
#pragma once

#include <vector>

#include "machine/robot/arm.hpp"

namespace millpose {

/// One wave of a gear's error: the joint is ahead of its controller's angle by amplitude · sin(harmonic ·
/// angle + phase).
struct JointHarmonic {
  int joint = 0;         ///< 1 to 6
  double harmonic = 1;   ///< waves in one turn of the joint
  double amplitude = 0;  ///< rad
  double phase = 0;      ///< rad
};

/// A joint that turns beside its own angle by factor × the angle of another.
struct JointCoupling {
  int joint = 0, follows = 0;  ///< 1 to 6
  double factor = 0;
};

/// From the controller's angles to those of the arm: true = q + Σ a·sin(k·q + φ) + Σ c·q_follows. Angles are
/// the arm's own, rad, full revolutions counted: waves that are no whole number in a turn are others in the
/// next one.
struct JointLaw {
  /// Laws whose SteepestSlope() is not less than this are no gear's: Invert() takes none.
  static constexpr double kSteepest = 0.1;

  std::vector<JointHarmonic> harmonics;
  std::vector<JointCoupling> couplings;

  bool IsNone() const { return harmonics.empty() && couplings.empty(); }

  /// The arm's angles where its controller has them at `q`; the very same where the law is none.
  Joints At(const Joints& q) const;
  /// Its derivative: entry (i, j) of joint i's angle by that of the controller for joint j.
  Matrix6 Slope(const Joints& q) const;
  /// By what, at most and at any angles, the entries of a row of Slope() differ in sum from those of the
  /// identity.
  double SteepestSlope() const;
  /// By how much each joint turns at most while the controller turns them by at most `turn` (rad, ≥ 0).
  Joints MostTurn(const Joints& turn) const;
  /// The controller's angles that bring the arm's to `angles`: the only ones. Precondition: SteepestSlope() <
  /// kSteepest. Each step of Newton's leaves at most 2·s / (1 − s) < 0.23 of what was off, s the steepest
  /// slope, and near the end the square.
  Joints Invert(const Joints& angles) const;

 private:
  Matrix6 LargestSlopes() const;
};

}  // namespace millpose
