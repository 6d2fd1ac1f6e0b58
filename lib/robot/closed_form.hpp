// SPDX-License-Identifier: GPL-3.0-or-later
// The closed-form inverse of an arm with a spherical wrist, in sines and cosines and without branches, so
// that the scalar code and the loops over lanes share it bit for bit. Derivation: docs/kinematics.md.
// Internal to robot.
#pragma once

#include "base/trig.hpp"
#include "robot/arm.hpp"

namespace millpose::closed_form {

inline constexpr double kAxisTolerance = 1e-6;      // mm: the wrist centre counts as on axis 1
inline constexpr double kStretchTolerance = 1e-12;  // on the elbow's cosine: below 1e-8 mm of reach
inline constexpr double kWristTolerance = 1e-10;    // on sin q5

/// What the inverse needs of an arm.
struct Lengths {
  explicit Lengths(const Arm& arm)
      : d1(arm.d1),
        a1(arm.a1),
        a2(arm.a2),
        forearm(std::sqrt(arm.d4 * arm.d4 + arm.dz * arm.dz)),
        cos_phi(arm.d4 / forearm),
        sin_phi(arm.dz / forearm),
        square_sum(arm.a2 * arm.a2 + forearm * forearm),
        twice_product(2 * arm.a2 * forearm) {}
  double d1, a1, a2, forearm, cos_phi, sin_phi, square_sum, twice_product;
};

/// q1..q3 for one choice of shoulder and elbow.
struct ArmAngles {
  SineCosine first, second, third;
  bool reached;
  double elbow_sine;  ///< of q3 − atan2(dz, d4), with its sign
  double distance;    ///< of the wrist centre from axis 1, mm, positive
};

/// Unit vector (cos, sin) along (x, y) of the given length; angle 0 where it vanishes.
[[gnu::always_inline]] inline SineCosine Direction(double x, double y, double length) {
  const bool some = length > 0;
  const double scale = 1 / (some ? length : 1.0);
  return {some ? y * scale : 0.0, some ? x * scale : 1.0};
}

/// `side` −1 takes the shoulder behind, `elbow` −1 the elbow's other side, else +1; the wrist centre in B,
/// mm. Finite whatever is given; without meaning where not reached.
[[gnu::always_inline]] inline ArmAngles SolveArm(const Lengths& arm, double wrist_x, double wrist_y,
                                                 double wrist_z, double side, double elbow) {
  ArmAngles angles;
  angles.distance = std::sqrt(wrist_x * wrist_x + wrist_y * wrist_y);
  const SineCosine front = Direction(wrist_x, wrist_y, angles.distance);
  angles.first = {side * front.sin, side * front.cos};

  // In the arm's vertical plane, angles count from the horizontal downwards (Ry), hence the sign of y.
  const double x = side * angles.distance - arm.a1, y = arm.d1 - wrist_z;
  const double square = x * x + y * y;
  const double raw = (square - arm.square_sum) / arm.twice_product;
  angles.reached = std::fabs(raw) <= 1 + kStretchTolerance;
  const double below = raw < 1 ? raw : 1.0;
  const double cosine = below > -1 ? below : -1.0;
  const double sine = elbow * std::sqrt((1 - cosine) * (1 + cosine));
  angles.elbow_sine = sine;

  // (x, y) = e^{i·q2}·(u + i·v) with u + i·v the wrist centre seen from the upper arm.
  const double u = arm.a2 + arm.forearm * cosine, v = arm.forearm * sine;
  angles.second = Direction(x * u + y * v, y * u - x * v, std::sqrt((u * u + v * v) * square));
  angles.third = {sine * arm.cos_phi + cosine * arm.sin_phi, cosine * arm.cos_phi - sine * arm.sin_phi};
  return angles;
}

/// Whether the arm part leaves a whole family of solutions.
inline bool IsSingular(const ArmAngles& angles) {
  return angles.distance < kAxisTolerance || angles.elbow_sine * angles.elbow_sine < 2 * kStretchTolerance;
}

/// Columns of the flange's rotation in B.
struct FlangeAxes {
  double x[3], y[3], z[3];
};

/// The unflipped wrist: sin q5 ≥ 0.
struct WristAngles {
  SineCosine fourth, fifth, sixth;
  bool singular;
};

/// q4..q6 of Rx(q4)·Ry(q5)·Rx(q6) = R_03ᵀ·R_BF·Ry(−90°). Where A5 = 0 leaves q4 free it is `free_fourth`.
[[gnu::always_inline]] inline WristAngles SolveWrist(const ArmAngles& arm, const FlangeAxes& flange,
                                                     const SineCosine& free_fourth) {
  const double s23 = arm.second.sin * arm.third.cos + arm.second.cos * arm.third.sin;
  const double c23 = arm.second.cos * arm.third.cos - arm.second.sin * arm.third.sin;
  const double s1 = arm.first.sin, c1 = arm.first.cos;
  const double x3[3] = {c1 * c23, s1 * c23, -s23},
               z3[3] = {c1 * s23, s1 * s23, c23};  // and y3 = (−s1, c1, 0)
  const double m00 = x3[0] * flange.z[0] + x3[1] * flange.z[1] + x3[2] * flange.z[2];
  const double m10 = c1 * flange.z[1] - s1 * flange.z[0];
  const double m20 = z3[0] * flange.z[0] + z3[1] * flange.z[1] + z3[2] * flange.z[2];
  const double m11 = c1 * flange.y[1] - s1 * flange.y[0];
  const double m21 = z3[0] * flange.y[0] + z3[1] * flange.y[1] + z3[2] * flange.y[2];
  const double m12 = s1 * flange.x[0] - c1 * flange.x[1];
  const double m22 = -(z3[0] * flange.x[0] + z3[1] * flange.x[1] + z3[2] * flange.x[2]);
  const double sine = std::sqrt(m10 * m10 + m20 * m20);
  WristAngles wrist;
  wrist.singular = sine < kWristTolerance;
  const double scale = 1 / (wrist.singular ? 1.0 : sine);
  wrist.fourth = {wrist.singular ? free_fourth.sin : m10 * scale,
                  wrist.singular ? free_fourth.cos : -m20 * scale};
  wrist.fifth = {sine, m00};
  // The second row of Rx(−q4)·M is (0, cos q6, −sin q6): well conditioned even at A5 = 0.
  wrist.sixth = {-(wrist.fourth.cos * m12 + wrist.fourth.sin * m22),
                 wrist.fourth.cos * m11 + wrist.fourth.sin * m21};
  return wrist;
}

}  // namespace millpose::closed_form
