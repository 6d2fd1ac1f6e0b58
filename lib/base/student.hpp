// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace millpose {

/// 97.5 % quantile of the normal distribution: 95 % lie within as many standard deviations.
inline constexpr double kNormal95 = 1.959963984540054;

/// 97.5 % quantile of Student's t (Cornish and Fisher's expansion, Abramowitz and Stegun 26.7.5; below 1 %
/// off from 3 degrees of freedom on).
inline double StudentQuantile(double freedom) {
  const double z = kNormal95, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * freedom) + (5 * z5 + 16 * z3 + 3 * z) / (96 * freedom * freedom) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * freedom * freedom * freedom);
}

}  // namespace millpose
