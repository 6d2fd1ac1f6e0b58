// SPDX-License-Identifier: GPL-3.0-or-later
// Closed-form inverse kinematics of an arm with a spherical wrist: the wrist centre fixes q1..q3 (two choices
// of shoulder × two of elbow), the remaining rotation q4..q6 (two choices of wrist). Derivation:
// docs/kinematics.md.
#include <cassert>

#include "base/units.hpp"
#include "robot/angles.hpp"
#include "robot/kinematics.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAxisTolerance = 1e-6;      // mm: the wrist centre counts as on axis 1
constexpr double kStretchTolerance = 1e-12;  // on the elbow's cosine: below 1e-8 mm of reach
constexpr double kWristTolerance = 1e-10;    // on sin q5

/// Sines and cosines of q1..q3 for one choice of shoulder and elbow.
struct ArmChoice {
  bool reached = false;
  bool singular = false;
  SineCosine first, second, elbow;
};

/// Unit vector (cos, sin) of (x, y), or angle 0 where the vector vanishes.
SineCosine Direction(double x, double y, double length) {
  return length > 0 ? SineCosine{y / length, x / length} : SineCosine{0, 1};
}

ArmChoice SolveArm(const Arm& arm, const Vector3d& wrist, bool behind, bool elbow_positive) {
  ArmChoice choice;
  const double distance = std::sqrt(wrist.x() * wrist.x() + wrist.y() * wrist.y());
  choice.singular = distance < kAxisTolerance;
  choice.first = Direction(wrist.x(), wrist.y(), distance);
  if (behind) choice.first = {-choice.first.sin, -choice.first.cos};

  // In the arm's vertical plane, angles count from the horizontal downwards (Ry), hence the sign of y.
  const double x = (behind ? -distance : distance) - arm.a1, y = arm.d1 - wrist.z();
  const double forearm = std::sqrt(arm.d4 * arm.d4 + arm.dz * arm.dz);
  const double square = x * x + y * y;
  const double raw = (square - arm.a2 * arm.a2 - forearm * forearm) / (2 * arm.a2 * forearm);
  if (!(std::abs(raw) <= 1 + kStretchTolerance)) return choice;
  choice.reached = true;
  const double cosine = std::clamp(raw, -1.0, 1.0);
  const double sine = std::sqrt((1 - cosine) * (1 + cosine)) * (elbow_positive ? 1 : -1);
  choice.singular |= 1 - std::abs(cosine) < kStretchTolerance;

  // (x, y) = e^{i·q2}·(u + i·v) with u + i·v the wrist centre seen from the upper arm.
  const double u = arm.a2 + forearm * cosine, v = forearm * sine;
  const double length = std::sqrt((u * u + v * v) * square);
  choice.second = Direction(x * u + y * v, y * u - x * v, length);
  const double cos_phi = arm.d4 / forearm, sin_phi = arm.dz / forearm;
  choice.elbow = {sine * cos_phi + cosine * sin_phi, cosine * cos_phi - sine * sin_phi};
  return choice;
}

/// R_06 = X_BF's rotation before the last Ry(90°), seen from the forearm: Rx(q4)·Ry(q5)·Rx(q6).
Matrix3d WristRotation(const ArmChoice& choice, const Matrix3d& R_BF) {
  Matrix3d R6;
  R6 << R_BF.col(2), R_BF.col(1), -R_BF.col(0);
  const SineCosine sum{choice.second.sin * choice.elbow.cos + choice.second.cos * choice.elbow.sin,
                       choice.second.cos * choice.elbow.cos - choice.second.sin * choice.elbow.sin};
  Matrix3d R3;
  R3 << choice.first.cos * sum.cos, -choice.first.sin, choice.first.cos * sum.sin,  //
      choice.first.sin * sum.cos, choice.first.cos, choice.first.sin * sum.sin,     //
      -sum.sin, 0, sum.cos;
  return R3.transpose() * R6;
}

/// Outer angles, principal, of inner sines and cosines and wrist rotation M. `fourth` is q4 to take where A5
/// = 0 leaves it free.
Joints OuterAngles(const Arm& arm, const ArmChoice& choice, const Matrix3d& M, bool flipped, double fourth,
                   bool& singular) {
  Joints q;
  q[0] = Atan2(choice.first.sin, choice.first.cos);
  q[1] = Atan2(choice.second.sin, choice.second.cos);
  q[2] = Atan2(choice.elbow.sin, choice.elbow.cos);
  const double flip = flipped ? -1 : 1;
  const double sine = flip * std::sqrt(M(1, 0) * M(1, 0) + M(2, 0) * M(2, 0));
  singular = std::abs(sine) < kWristTolerance;
  const SineCosine turn4 = singular ? SinCos(fourth) : SineCosine{M(1, 0) / sine, -M(2, 0) / sine};
  q[3] = singular ? fourth : Atan2(turn4.sin, turn4.cos);
  q[4] = Atan2(sine, M(0, 0));
  // The second row of Rx(−q4)·M is (0, cos q6, −sin q6): well conditioned even at A5 = 0.
  q[5] = Atan2(-(turn4.cos * M(1, 2) + turn4.sin * M(2, 2)), turn4.cos * M(1, 1) + turn4.sin * M(2, 1));
  for (int i = 0; i < 6; ++i) q[i] = Principal(arm.sign[i] * (q[i] - arm.offset[i]));
  return q;
}

Vector3d WristCentre(const Arm& arm, const Pose& X_BF) {
  return X_BF.translation() - arm.d6 * X_BF.linear().col(2);
}

}  // namespace

InverseResult Inverse(const Arm& arm, const Pose& X_BF) {
  assert(arm.a2 > 0 && arm.d4 * arm.d4 + arm.dz * arm.dz > 0);
  InverseResult result;
  if (!X_BF.matrix().allFinite()) return result;
  const Vector3d wrist = WristCentre(arm, X_BF);
  bool singular = false;
  for (int branch = 0; branch < 8; ++branch) {
    const ArmChoice choice = SolveArm(arm, wrist, (branch & 1) != 0, (branch & 2) != 0);
    if (!choice.reached) continue;
    bool wrist_singular = false;
    const Joints q = OuterAngles(arm, choice, WristRotation(choice, X_BF.linear()), (branch & 4) != 0, 0.0,
                                 wrist_singular);
    singular |= choice.singular || wrist_singular;
    result.solutions[result.count++] = {q, branch};
  }
  if (result.count > 0) result.status = singular ? ReachStatus::kSingular : ReachStatus::kReached;
  return result;
}

std::optional<Joints> InverseNear(const Arm& arm, const Pose& X_BF, int branch, const Joints& near) {
  assert(branch >= 0 && branch < 8 && near.allFinite());
  if (!X_BF.matrix().allFinite()) return std::nullopt;
  const ArmChoice choice = SolveArm(arm, WristCentre(arm, X_BF), (branch & 1) != 0, (branch & 2) != 0);
  if (!choice.reached) return std::nullopt;
  bool singular = false;
  Joints q = OuterAngles(arm, choice, WristRotation(choice, X_BF.linear()), (branch & 4) != 0,
                         InnerAngles(arm, near)[3], singular);
  for (int i = 0; i < 6; ++i) q[i] += 2 * kPi * std::floor((near[i] - q[i]) / (2 * kPi) + 0.5);
  return q;
}

std::vector<Joints> FullTurns(const Joints& q, const Joints& lower, const Joints& upper) {
  std::vector<Joints> all{q};
  for (int i = 0; i < 6; ++i) {
    std::vector<Joints> extended;
    for (const Joints& start : all) {
      for (double turns = std::ceil((lower[i] - q[i]) / (2 * kPi)); q[i] + turns * 2 * kPi <= upper[i];
           ++turns) {
        extended.push_back(start);
        extended.back()[i] = q[i] + turns * 2 * kPi;
      }
    }
    all = std::move(extended);
  }
  return all;
}

}  // namespace millpose
