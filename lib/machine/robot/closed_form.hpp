// SPDX-License-Identifier: GPL-3.0-or-later
// The closed-form inverse of both families of arms, in sines and cosines and without branches, so that the
// scalar code and the loops over lanes share it bit for bit. Derivation: docs/kinematics.md.
// Internal to robot.
#pragma once

#include "base/trig.hpp"
#include "machine/robot/arm.hpp"

namespace millpose::closed_form {

inline constexpr double kAxisTolerance = 1e-6;      // mm: the wrist centre counts as above the shoulder
inline constexpr double kStretchTolerance = 1e-12;  // on the elbow's cosine: below 1e-8 mm of reach
inline constexpr double kWristTolerance = 1e-10;    // on sin q5

/// What the inverse needs of an arm.
struct Lengths {
  explicit Lengths(const Arm& arm)
      : d1(arm.d1),
        a1(arm.a1),
        dy(arm.dy),
        a2(arm.a2),
        d5(arm.d5),
        forearm(std::sqrt(arm.d4 * arm.d4 + arm.dz * arm.dz)),
        cos_phi(arm.d4 / forearm),
        sin_phi(arm.dz / forearm),
        square_sum(arm.a2 * arm.a2 + forearm * forearm),
        twice_product(2 * arm.a2 * forearm) {}
  double d1, a1, dy, a2, d5, forearm, cos_phi, sin_phi, square_sum, twice_product;
};

/// q1 for one choice of shoulder.
struct ShoulderAngle {
  SineCosine first;
  bool reached;     ///< the wrist centre is no nearer to axis 1 than dy
  double distance;  ///< of the wrist centre from the plane through axis 1 along axis 2, mm, positive
  bool singular;    ///< both shoulders are one: kAxisTolerance, and kStretchTolerance on the cosine
};

/// q2 and q3 for one choice of elbow.
struct ElbowAngles {
  SineCosine second, third;
  bool reached;
  double sine;  ///< of q3 − atan2(dz, d4), with its sign
};

/// Columns of the flange's rotation in B, and the wrist centre there, mm.
struct FlangeAxes {
  double x[3], y[3], z[3], wrist[3];
};

/// The unflipped wrist: sin q5 ≥ 0. `first` is q4; with parallel axes q2 + q3 + q4.
struct WristAngles {
  SineCosine first, fifth, sixth;
  bool singular;
};

/// A solution. Finite whatever is given; without meaning where not reached.
struct Solution {
  SineCosine q[6];
  bool reached;
  bool singular;  ///< shoulder or wrist leave a whole family of solutions
  double elbow_sine, distance;
};

/// Which of the eight: `side` −1 takes the shoulder behind, `elbow` −1 the elbow's other side, `flip` −1 the
/// wrist flipped, else +1.
struct Choice {
  explicit Choice(int branch)
      : side(branch & 1 ? -1 : 1), elbow(branch & 2 ? 1 : -1), flip(branch & 4 ? -1 : 1) {}
  double side, elbow, flip;
};

/// Unit vector (cos, sin) along (x, y) of the given length; angle 0 where it vanishes.
[[gnu::always_inline]] inline SineCosine Direction(double x, double y, double length) {
  const bool some = length > 0;
  const double scale = 1 / (some ? length : 1.0);
  return {some ? y * scale : 0.0, some ? x * scale : 1.0};
}

/// Sum of two angles.
[[gnu::always_inline]] inline SineCosine Sum(const SineCosine& a, const SineCosine& b) {
  return {a.sin * b.cos + a.cos * b.sin, a.cos * b.cos - a.sin * b.sin};
}

[[gnu::always_inline]] inline ShoulderAngle SolveShoulder(const Lengths& arm, const FlangeAxes& flange,
                                                          double side) {
  const double x = flange.wrist[0], y = flange.wrist[1];
  const double length = std::sqrt(x * x + y * y);
  const bool some = length > 0;
  const double scale = 1 / (some ? length : 1.0);
  const SineCosine front{y * scale, some ? x * scale : 1.0};
  // The wrist centre is (radius, dy) in the turned frame: sine and cosine of the angle between.
  const double raw = arm.dy * scale;
  const double below = raw < 1 ? raw : 1.0;
  const double share = below > -1 ? below : -1.0;
  const double along = std::sqrt((1 - share) * (1 + share));
  const double cosine = side * along;
  return {.first = {front.sin * cosine - front.cos * share, front.cos * cosine + front.sin * share},
          .reached = std::fabs(arm.dy) <= length * (1 + kStretchTolerance),
          .distance = length * along,
          .singular = length * along < kAxisTolerance || along * along < 2 * kStretchTolerance};
}

/// `x` forward and `y` down from axis 2 to the forearm's end, mm.
[[gnu::always_inline]] inline ElbowAngles SolveElbow(const Lengths& arm, double x, double y, double elbow) {
  const double square = x * x + y * y;
  const double raw = (square - arm.square_sum) / arm.twice_product;
  const double below = raw < 1 ? raw : 1.0;
  const double cosine = below > -1 ? below : -1.0;
  const double sine = elbow * std::sqrt((1 - cosine) * (1 + cosine));
  // (x, y) = e^{i·q2}·(u + i·v) with u + i·v the forearm's end seen from the upper arm.
  const double u = arm.a2 + arm.forearm * cosine, v = arm.forearm * sine;
  return {.second = Direction(x * u + y * v, y * u - x * v, std::sqrt((u * u + v * v) * square)),
          .third = {sine * arm.cos_phi + cosine * arm.sin_phi, cosine * arm.cos_phi - sine * arm.sin_phi},
          .reached = std::fabs(raw) <= 1 + kStretchTolerance,
          .sine = sine};
}

/// a, q5 and q6 of M = Rx(a)·Ry(q5)·Rx(q6), of which these entries are given. Where q5 = 0 leaves a free it
/// is `free`.
[[gnu::always_inline]] inline WristAngles SolveWrist(double m00, double m10, double m20, double m11,
                                                     double m21, double m12, double m22,
                                                     const SineCosine& free) {
  const double sine = std::sqrt(m10 * m10 + m20 * m20);
  WristAngles wrist;
  wrist.singular = sine < kWristTolerance;
  const double scale = 1 / (wrist.singular ? 1.0 : sine);
  wrist.first = {wrist.singular ? free.sin : m10 * scale, wrist.singular ? free.cos : -m20 * scale};
  wrist.fifth = {sine, m00};
  // The second row of Rx(−a)·M is (0, cos q6, −sin q6): well conditioned even at q5 = 0.
  wrist.sixth = {-(wrist.first.cos * m12 + wrist.first.sin * m22),
                 wrist.first.cos * m11 + wrist.first.sin * m21};
  return wrist;
}

/// M = R_03ᵀ·R_BF·Ry(−90°).
[[gnu::always_inline]] inline WristAngles SolveSphericalWrist(const SineCosine& first, const SineCosine& sum,
                                                              const FlangeAxes& flange,
                                                              const SineCosine& free) {
  const double s23 = sum.sin, c23 = sum.cos;
  const double s1 = first.sin, c1 = first.cos;
  const double x3[3] = {c1 * c23, s1 * c23, -s23},
               z3[3] = {c1 * s23, s1 * s23, c23};  // and y3 = (−s1, c1, 0)
  const double m00 = x3[0] * flange.z[0] + x3[1] * flange.z[1] + x3[2] * flange.z[2];
  const double m10 = c1 * flange.z[1] - s1 * flange.z[0];
  const double m20 = z3[0] * flange.z[0] + z3[1] * flange.z[1] + z3[2] * flange.z[2];
  const double m11 = c1 * flange.y[1] - s1 * flange.y[0];
  const double m21 = z3[0] * flange.y[0] + z3[1] * flange.y[1] + z3[2] * flange.y[2];
  const double m12 = s1 * flange.x[0] - c1 * flange.x[1];
  const double m22 = -(z3[0] * flange.x[0] + z3[1] * flange.x[1] + z3[2] * flange.x[2]);
  return SolveWrist(m00, m10, m20, m11, m21, m12, m22, free);
}

/// M = (R_01·Rz(90°))ᵀ·R_BF·Ry(−90°): there Ry(q2)·Ry(q3)·Rz(90°)·Rx(q4) is Rz(90°)·Rx(q2 + q3 + q4).
[[gnu::always_inline]] inline WristAngles SolveParallelWrist(const SineCosine& first,
                                                             const FlangeAxes& flange,
                                                             const SineCosine& free) {
  const double s1 = first.sin, c1 = first.cos;
  const double m00 = c1 * flange.z[1] - s1 * flange.z[0];
  const double m10 = -(c1 * flange.z[0] + s1 * flange.z[1]);
  const double m11 = -(c1 * flange.y[0] + s1 * flange.y[1]);
  const double m12 = c1 * flange.x[0] + s1 * flange.x[1];
  return SolveWrist(m00, m10, flange.z[2], m11, flange.y[2], m12, -flange.x[2], free);
}

/// (a + 180°, −q5, q6 + 180°) is the same rotation; but where q5 = 0, −q5 alone already is.
[[gnu::always_inline]] inline WristAngles Flipped(const WristAngles& wrist, double flip) {
  const double half_turn = wrist.singular ? 1.0 : flip;
  return {{half_turn * wrist.first.sin, half_turn * wrist.first.cos},
          {flip * wrist.fifth.sin, wrist.fifth.cos},
          {half_turn * wrist.sixth.sin, half_turn * wrist.sixth.cos},
          wrist.singular};
}

/// Where q5 = 0 leaves q4 free it is `free`.
[[gnu::always_inline]] inline Solution SolveSpherical(const Lengths& arm, const FlangeAxes& flange,
                                                      const ShoulderAngle& shoulder, const Choice& choice,
                                                      const SineCosine& free) {
  // In the arm's vertical plane, angles count from the horizontal downwards (Ry), hence the sign of y.
  const ElbowAngles elbow =
      SolveElbow(arm, choice.side * shoulder.distance - arm.a1, arm.d1 - flange.wrist[2], choice.elbow);
  const WristAngles wrist =
      Flipped(SolveSphericalWrist(shoulder.first, Sum(elbow.second, elbow.third), flange, free), choice.flip);
  return {.q = {shoulder.first, elbow.second, elbow.third, wrist.first, wrist.fifth, wrist.sixth},
          .reached = (shoulder.reached & elbow.reached) != 0,
          .singular = (shoulder.singular | wrist.singular) != 0,
          .elbow_sine = elbow.sine,
          .distance = shoulder.distance};
}

/// A sum q2 + q3 + q4 with which the arm reaches the wrist centre where q5 = 0 leaves it free: axis 5 in line
/// with the wrist centre as the shoulder sees it, pointing away from there, or back where that is too near.
[[gnu::always_inline]] inline SineCosine FreeSum(const Lengths& arm, const FlangeAxes& flange,
                                                 const ShoulderAngle& shoulder, const Choice& choice) {
  const double x = choice.side * shoulder.distance - arm.a1, y = arm.d1 - flange.wrist[2];
  const double length = std::sqrt(x * x + y * y);
  const SineCosine towards = Direction(x, y, length);
  const double out = length - std::fabs(arm.d5) >= std::fabs(arm.a2 - arm.forearm) ? 1.0 : -1.0;
  const double way = arm.d5 < 0 ? -out : out;
  return {way * towards.sin, way * towards.cos};
}

/// Where q5 = 0 leaves q2 + q3 + q4 free it is `free`.
[[gnu::always_inline]] inline Solution SolveParallel(const Lengths& arm, const FlangeAxes& flange,
                                                     const ShoulderAngle& shoulder, const Choice& choice,
                                                     const SineCosine& free) {
  const WristAngles wrist = Flipped(SolveParallelWrist(shoulder.first, flange, free), choice.flip);
  const double x = choice.side * shoulder.distance - arm.a1 - arm.d5 * wrist.first.cos;
  const double y = arm.d1 - flange.wrist[2] - arm.d5 * wrist.first.sin;
  const ElbowAngles elbow = SolveElbow(arm, x, y, choice.elbow);
  const SineCosine sum = Sum(elbow.second, elbow.third);
  const SineCosine fourth = Sum(wrist.first, {-sum.sin, sum.cos});
  return {.q = {shoulder.first, elbow.second, elbow.third, fourth, wrist.fifth, wrist.sixth},
          .reached = (shoulder.reached & elbow.reached) != 0,
          .singular = (shoulder.singular | wrist.singular) != 0,
          .elbow_sine = elbow.sine,
          .distance = shoulder.distance};
}

/// Whether shoulder, elbow or wrist leave a whole family of solutions.
inline bool IsSingular(const Solution& solution) {
  return solution.singular || solution.elbow_sine * solution.elbow_sine < 2 * kStretchTolerance;
}

}  // namespace millpose::closed_form
