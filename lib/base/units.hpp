// SPDX-License-Identifier: GPL-3.0-or-later
// Inside millpose everything is mm, N, rad, s. These convert at the edge, once.
#pragma once

#include <limits>
#include <numbers>

namespace millpose {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kRadPerDeg = kPi / 180.0;
inline constexpr double kDegPerRad = 180.0 / kPi;

constexpr double DegToRad(double degrees) { return degrees * kRadPerDeg; }
constexpr double RadToDeg(double radians) { return radians * kDegPerRad; }

}  // namespace millpose
