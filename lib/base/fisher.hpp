// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/trig.hpp"

namespace millpose {

/// ln Γ(x), x > 0, to 1e-14 of max(1, its size) (Stirling's series above 10, recursion below).
inline double LogGamma(double x) {
  constexpr double kHalfLogTwoPi = 0.91893853320467274;
  double product = 1;
  while (x < 10) product *= x++;
  const double z = 1 / (x * x);
  const double series =
      1.0 / 12 -
      z * (1.0 / 360 - z * (1.0 / 1260 - z * (1.0 / 1680 - z * (1.0 / 1188 - z * 691.0 / 360360))));
  return (x - 0.5) * Log(x) - x + kHalfLogTwoPi + series / x - Log(product);
}

/// Iₓ(a, b), the incomplete beta function's share, 0 ≤ x ≤ 1 and y = 1 − x, by its continued fraction
/// (Abramowitz and Stegun 26.5.8, evaluated as Lentz does); to 1e-10.
inline double BetaShare(double x, double y, double a, double b) {
  if (x <= 0) return 0;
  if (y <= 0) return 1;
  if (x * (a + b + 2) > (1 + 1e-9) * (a + 1)) return 1 - BetaShare(y, x, b, a);
  const double exponent = a * Log(x) + b * Log(y) + LogGamma(a + b) - LogGamma(a) - LogGamma(b);
  if (exponent < -700) return 0;
  constexpr double kTiny = 1e-300, kEnough = 1e-15;
  const auto guarded = [](double value) { return std::abs(value) < kTiny ? kTiny : value; };
  double c = 1, d = 1 / guarded(1 - (a + b) * x / (a + 1)), fraction = d;
  for (int m = 1; m < 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / guarded(1 + even * d);
    c = guarded(1 + even / c);
    fraction *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / guarded(1 + odd * d);
    c = guarded(1 + odd / c);
    const double change = c * d;
    fraction *= change;
    if (std::abs(change - 1) < kEnough) break;
  }
  return Exp(exponent) * fraction / a;
}

/// Probability that Fisher's F of n and m degrees of freedom is above f by chance.
inline double FisherTail(double f, double n, double m) {
  if (f <= 0) return 1;
  const double whole = m + n * f;
  return BetaShare(m / whole, n * f / whole, m / 2, n / 2);
}

}  // namespace millpose
