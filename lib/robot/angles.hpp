// SPDX-License-Identifier: GPL-3.0-or-later
// Between the angles a controller shows (A) and the inner angles of the formula at Arm (q).
#pragma once

#include "base/trig.hpp"
#include "robot/arm.hpp"

namespace millpose {

/// Inner angles q_i = sign_i·A_i + offset_i, rad.
inline Joints InnerAngles(const Arm& arm, const Joints& A) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = arm.sign[i] * A[i] + arm.offset[i];
  return q;
}

/// `angle` less full turns, in (−π, π].
double Principal(double angle);

/// Where the wrist centre lies in the vertical plane through the arm, and the angle that decides elbow and
/// reach.
struct ArmPlane {
  double radius;      ///< of the wrist centre from axis 1, mm; negative when it is behind
  double height;      ///< of the wrist centre above the base, mm
  SineCosine second;  ///< of q2
  SineCosine sum;     ///< of q2 + q3
  double elbow_sine;  ///< of q3 − atan2(dz, d4): 0 when upper arm and forearm are in one line
};
ArmPlane PlaneOf(const Arm& arm, double q2, double q3);

}  // namespace millpose
