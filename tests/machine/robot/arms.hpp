// SPDX-License-Identifier: GPL-3.0-or-later
// Arm geometries that several tests use.
#pragma once

#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/robot/arm.hpp"

namespace millpose {

/// Angles given in degrees, in rad.
inline Joints Degrees(double a1, double a2, double a3, double a4, double a5, double a6) {
  return kRadPerDeg * (Joints() << a1, a2, a3, a4, a5, a6).finished();
}

inline Arm MakeArm(std::string name, double d1, double a1, double a2, double d4, double dz, double d6,
                   std::array<double, 6> sign) {
  Arm arm;
  arm.name = std::move(name);
  arm.d1 = d1;
  arm.a1 = a1;
  arm.a2 = a2;
  arm.d4 = d4;
  arm.dz = dz;
  arm.d6 = d6;
  arm.sign = sign;
  arm.lower = Degrees(-185, -130, -100, -350, -120, -350);
  arm.upper = Degrees(185, 20, 144, 350, 120, 350);
  arm.stiffness << 8.9e9, 6.78e9, 1.13e10, 2.01e9, 1.65e9, 1.35e9;  // Chen 2021 eq. 14
  return arm;
}

inline constexpr std::array<double, 6> kKukaSigns{-1, 1, 1, -1, 1, -1};

inline Arm Kr500R2830() { return MakeArm("KR 500 R2830", 1045, 500, 1300, 1025, -55, 290, kKukaSigns); }
inline Arm Kr500R2800() { return MakeArm("KR 500 R2800-2", 800, 500, 1250, 1039.5, 150, 286, kKukaSigns); }
/// Table 1 of Chen 2021: in fact the lengths of a KR QUANTEC R2700.
inline Arm KrQuantecR2700() {
  return MakeArm("KR QUANTEC R2700", 675, 350, 1150, 1200, -41, 215, kKukaSigns);
}
/// Explains Table 6 of Chen 2021: an R2830 whose A6 turns the other way.
inline Arm Chen2021Table6() {
  return MakeArm("chen2021_table6", 1045, 500, 1300, 1025, -55, 290, {-1, 1, 1, -1, 1, 1});
}
/// No maker's arm: every sign and offset other than KUKA's, and the wrist above the elbow.
inline Arm OddArm() {
  Arm arm = MakeArm("odd", 400, -80, 700, 650, 120, 90, {1, -1, 1, 1, -1, 1});
  arm.offset = Degrees(10, -90, 35, 180, -20, 77);
  return arm;
}

/// A spherical wrist 34.5 mm beside axis 1: lengths of a Doosan M1013.
inline Arm DoosanM1013() {
  Arm arm = MakeArm("M1013", 152.5, 0, 620, 559, 0, 121, {1, 1, 1, 1, 1, 1});
  arm.dy = 34.5;
  arm.offset = Degrees(0, -90, 90, 0, 0, 0);
  return arm;
}

/// Axes 2, 3 and 4 parallel; `dy`, `d5`: see Arm.
inline Arm MakeParallelArm(std::string name, double d1, double dy, double a2, double d4, double d5, double d6,
                           std::array<double, 6> sign) {
  Arm arm = MakeArm(std::move(name), d1, 0, a2, d4, 0, d6, sign);
  arm.family = ArmFamily::kParallelAxes;
  arm.dy = dy;
  arm.d5 = d5;
  return arm;
}
/// Universal Robots' Denavit-Hartenberg lengths, and its joint angles.
inline Arm Ur10e() {
  Arm arm = MakeParallelArm("UR10e", 180.7, 174.15, 612.7, 571.55, 119.85, 116.55, {1, 1, 1, 1, -1, 1});
  arm.offset = Degrees(180, 0, 0, 90, 0, 0);
  return arm;
}
/// No maker's arm: every length of the formula other than 0, the wrist on the other side.
inline Arm OddParallelArm() {
  Arm arm = MakeParallelArm("odd parallel", 300, -90, 500, 430, -70, 110, {-1, 1, -1, 1, 1, -1});
  arm.a1 = 60;
  arm.dz = 25;
  arm.offset = Degrees(10, -90, 35, 180, -20, 77);
  return arm;
}

inline std::vector<Arm> AllArms() {
  return {Kr500R2830(), Kr500R2800(),  KrQuantecR2700(), Chen2021Table6(),
          OddArm(),     DoosanM1013(), Ur10e(),          OddParallelArm()};
}

/// Uniform in (−π, π] per joint.
inline Joints RandomJoints(RandomStream& stream) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = stream.Uniform(-kPi, kPi);
  return q;
}

}  // namespace millpose
