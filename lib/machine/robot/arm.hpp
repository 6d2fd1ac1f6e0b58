// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/enum_words.hpp"

namespace millpose {

/// Six joint angles, rad, in the arm's own convention (signs and zero offsets as its maker states them).
using Joints = Eigen::Matrix<double, 6, 1>;
/// A rigid motion; X_BF is the pose of frame F in frame B, translations in mm.
using Pose = Eigen::Isometry3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// What full revolutions that were added to an angle may have cost it by rounding, rad.
inline constexpr double kRevolutionRounding = 1e-12;

/// The two families of six-axis arms whose inverse has a closed form here.
enum class ArmFamily : uint8_t {
  kSphericalWrist,  ///< axes 4, 5 and 6 meet in one point
  kParallelAxes,    ///< axes 2, 3 and 4 are parallel (UR, Techman, AUBO, JAKA)
};
inline constexpr EnumWords<ArmFamily, 2> kArmFamilyWords = {
    {{"spherical_wrist", ArmFamily::kSphericalWrist}, {"parallel_axes", ArmFamily::kParallelAxes}}};

/// A limit that couples axes: factors · A ≤ at_most, A being the arm's own angles. Makers state one for axes
/// 2 and 3 of arms with a parallelogram (IRB 8700: A3 − A2 ≤ 67°).
struct CoupledLimit {
  Joints factors = Joints::Zero();
  double at_most = 0;  ///< rad

  /// By how much `q` is beyond it, rad; negative within.
  double Beyond(const Joints& q) const { return factors.dot(q) - at_most; }
};

/// The first of `limits` that `q` is beyond by more than `slack` (rad); null for none.
inline const CoupledLimit* FirstBeyond(const std::vector<CoupledLimit>& limits, const Joints& q,
                                       double slack) {
  for (const CoupledLimit& limit : limits)
    if (limit.Beyond(q) > slack) return &limit;
  return nullptr;
}

/// "A3 − A2 = 70.000° is above 67.000°".
std::string CoupledText(const CoupledLimit& limit, const Joints& q);

/// A six-axis arm. With q_i = sign_i · A_i + offset_i its forward kinematics are
///   X_BF = T(0,0,d1)·Rz(q1)·T(a1,dy,0)·Ry(q2)·T(a2,0,0)·Ry(q3)·T(d4,0,dz)·H
///          ·Rx(q4)·T(0,−d5,0)·Ry(q5)·Rx(q6)·T(d6,0,0)·Ry(90°)
/// with H = 1 and d5 = 0 where the wrist is spherical (KUKA's layout; for a KUKA arm dy = 0, the signs are
/// −,+,+,−,+,− and the offsets 0), and H = Rz(90°) where axis 4 is parallel to axes 2 and 3.
/// The wrist centre is where axes 5 and 6 meet.
struct Arm {
  std::string name;
  ArmFamily family = ArmFamily::kSphericalWrist;
  double d1 = 0, a1 = 0, dy = 0, a2 = 0, d4 = 0, dz = 0, d5 = 0, d6 = 0;  ///< lengths, mm
  std::array<double, 6> sign{1, 1, 1, 1, 1, 1};                           ///< +1 or −1
  Joints offset = Joints::Zero();                                         ///< rad
  Joints lower = Joints::Zero();                                          ///< lower limits, rad
  Joints upper = Joints::Zero();                                          ///< upper limits, rad
  /// Of axes whose limits span less than a revolution, so that full revolutions do not matter to them.
  std::vector<CoupledLimit> coupled_limits = {};
  Joints speed = Joints::Zero();         ///< largest joint speeds, rad/s
  Joints acceleration = Joints::Zero();  ///< largest joint accelerations, rad/s²
  bool acceleration_assumed = true;      ///< no source for the accelerations
  Joints stiffness = Joints::Zero();     ///< joint stiffness, N·mm/rad (Chen 2021 eq. 14)
};

}  // namespace millpose
