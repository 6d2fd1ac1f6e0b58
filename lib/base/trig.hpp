// SPDX-License-Identifier: GPL-3.0-or-later
// Trigonometry, powers and logarithms of our own. The C library picks other code on other processors (with
// FMA, without), so its last bits differ between machines; these use only +, −, ×, ÷, square roots, which are
// rounded rightly everywhere, and comparisons, and give the same bits on every machine (decision 0041). Sine,
// cosine and Atan2 have no branches, because loops over lanes must inline and vectorise them.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace millpose {

struct SineCosine {
  double sin, cos;
};

namespace trig {

/// `when_set` where `mask` is all ones, `otherwise` where it is 0.
[[gnu::always_inline]] inline double Select(uint64_t mask, double when_set, double otherwise) {
  return std::bit_cast<double>((std::bit_cast<uint64_t>(when_set) & mask) |
                               (std::bit_cast<uint64_t>(otherwise) & ~mask));
}

/// (atan(t)/t − 1)/t² by powers of t², interpolated in 13 Chebyshev points of 0 ≤ t ≤ 1/2; error of t·(1 +
/// t²·p): 4.0e-18 relative.
inline constexpr double kAtanCoefficients[] = {
    -0.3333333333333333,   0.19999999999999488, -0.14285714285599144,  0.11111111100913819,
    -0.09090908620176982,  0.07692294709038043, -0.06666435623970629,  0.058795778977469584,
    -0.052400959742757096, 0.04628009394739732, -0.038066107887640616, 0.025005822107796952,
    -0.009215319070924557};

/// Sine and cosine of r + tail, |r| ≤ π/4: Taylor's series, whose first dropped term is below 3e-18.
[[gnu::always_inline]] inline SineCosine OfReduced(double r, double tail) {
  const double z = r * r;
  double s = 1.0 / 355687428096000.0;
  s = s * z - 1.0 / 1307674368000.0;
  s = s * z + 1.0 / 6227020800.0;
  s = s * z - 1.0 / 39916800.0;
  s = s * z + 1.0 / 362880.0;
  s = s * z - 1.0 / 5040.0;
  s = s * z + 1.0 / 120.0;
  s = s * z - 1.0 / 6.0;
  double c = 1.0 / 20922789888000.0;
  c = c * z - 1.0 / 87178291200.0;
  c = c * z + 1.0 / 479001600.0;
  c = c * z - 1.0 / 3628800.0;
  c = c * z + 1.0 / 40320.0;
  c = c * z - 1.0 / 720.0;
  c = c * z + 1.0 / 24.0;
  const double half = 0.5 * z, one_less = 1.0 - half;
  // sin(r + t) ≈ sin r + t·cos r and cos(r + t) ≈ cos r − t·r; the rounding of 1 − z/2 is added back.
  return {r + (r * z * s + tail * one_less), one_less + (((1.0 - one_less) - half) + (z * z * c - r * tail))};
}

}  // namespace trig

/// Sine and cosine of `angle` (rad), |angle| ≤ 1e5, within 1 unit in the last place of the larger of the
/// two's scale (tests/base/trig_test.cpp). Reduction by multiples of π/2 in three parts (Cody and Waite
/// 1980): the products with the first two are exact.
[[gnu::always_inline]] inline SineCosine SinCos(double angle) {
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  constexpr double kPart1 = 0x1.921fb544p+0, kPart2 = 0x1.0b4611a6p-34, kPart3 = 0x1.3198a2e037073p-69;
  constexpr double kRound = 0x1.8p52;  // adding it rounds to a whole number that sits in the low bits
  const double shifted = angle * kTwoOverPi + kRound;
  const double count = shifted - kRound;
  const double first = angle - count * kPart1;
  const double second = count * kPart2;
  const double head = first - second;
  const double rest = ((first - head) - second) - count * kPart3;
  const double r = head + rest;
  const SineCosine reduced = trig::OfReduced(r, (head - r) + rest);
  const uint64_t quadrant = std::bit_cast<uint64_t>(shifted);
  const uint64_t swap = -(quadrant & 1);
  const double s = trig::Select(swap, reduced.cos, reduced.sin);
  const double c = trig::Select(swap, reduced.sin, reduced.cos);
  const uint64_t negative_s = (quadrant & 2) << 62, negative_c = ((quadrant + 1) & 2) << 62;
  return {std::bit_cast<double>(std::bit_cast<uint64_t>(s) ^ negative_s),
          std::bit_cast<double>(std::bit_cast<uint64_t>(c) ^ negative_c)};
}

/// The angle of the vector (x, y), rad, in [−π, π], within 2 units in the last place; 0 for the zero vector.
/// The arguments are finite, below 1e300 in size.
[[gnu::always_inline]] inline double Atan2(double y, double x) {
  constexpr double kQuarterPi = 0x1.921fb54442d18p-1, kQuarterPiRest = 0x1.1a62633145c07p-55;
  const double ax = std::fabs(x), ay = std::fabs(y);
  const bool steep = ay > ax;
  const double large = steep ? ay : ax, small = steep ? ax : ay;
  // atan(s/l) = π/4 + atan((s − l)/(s + l)) keeps the polynomial's argument within ±1/2; s − l is exact.
  const bool upper = small > 0.5 * large;
  const double divisor = upper ? small + large : large;
  const double t = (upper ? small - large : small) / (divisor > 0 ? divisor : 1.0);
  const double z = t * t;
  double p = trig::kAtanCoefficients[12];
  for (int i = 11; i >= 0; --i) p = p * z + trig::kAtanCoefficients[i];
  double angle = t + t * z * p;
  // The angle is quarters·π/4 ± atan(t).
  double quarters = upper ? 1.0 : 0.0;
  angle = steep ? -angle : angle;
  quarters = steep ? 2.0 - quarters : quarters;
  const bool behind = x < 0;
  angle = behind ? -angle : angle;
  quarters = behind ? 4.0 - quarters : quarters;
  return std::copysign(quarters * kQuarterPi + (quarters * kQuarterPiRest + angle), y);
}

/// √(x² + y²) within 1.5 units in the last place; |x| and |y| are below 1e150, and below 1e-150 count as 0.
[[gnu::always_inline]] inline double Hypot(double x, double y) { return std::sqrt(x * x + y * y); }

/// Arc sine and arc cosine, rad, within 3 units in the last place; |x| ≤ 1.
inline double Asin(double x) { return Atan2(x, std::sqrt((1 - x) * (1 + x))); }
inline double Acos(double x) { return Atan2(std::sqrt((1 - x) * (1 + x)), x); }

/// Natural logarithm of a finite x > 0, within 1 unit in the last place. With x = 2ᵏ·m and s = (m − 1)/(m +
/// 1) it is k·ln 2 + 2·artanh s, as a series of s² ≤ 0.0295 whose first dropped term is below 1e-19 of s.
inline double Log(double x) {
  constexpr double kLn2Head = 0x1.62e42fefa38p-1;  // its last bits are 0: exact times a power's exponent
  constexpr double kLn2Rest = 0x1.ef35793c7673p-45;
  int k = 0;
  double m = std::frexp(x, &k);
  if (m < 0x1.6a09e667f3bcdp-1) {  // √½
    m *= 2;
    --k;
  }
  const double f = m - 1, s = f / (2 + f), z = s * s;
  double p = 2.0 / 25;
  for (int odd = 23; odd >= 3; odd -= 2) p = p * z + 2.0 / odd;
  // 2·s = f − s·f, and s·f = f²/2 − s·f²/2: what is left of f is small, so that little is rounded away.
  const double half = 0.5 * f * f;
  return k * kLn2Head - ((half - (s * (half + z * p) + k * kLn2Rest)) - f);
}

/// eˣ within 1 unit in the last place, |x| ≤ 700: Taylor's series on x − k·ln 2, |x − k·ln 2| ≤ 0.35, whose
/// first dropped term is below 4e-18.
inline double Exp(double x) {
  constexpr double kLn2Head = 0x1.62e42fefa38p-1, kLn2Rest = 0x1.ef35793c7673p-45,
                   kLog2E = 0x1.71547652b82fep+0;
  const double k = std::floor(x * kLog2E + 0.5);
  const double head = x - k * kLn2Head, rest = k * kLn2Rest;
  const double r = head - rest, tail = (head - r) - rest;
  double p = 1;
  for (int n = 13; n >= 3; --n) p = 1 + r * p / n;
  return std::ldexp(1 + (r + (tail + 0.5 * r * r * p)), static_cast<int>(k));
}

/// xʸ of x > 0 within 2 + 2·|y·ln x| units in the last place, |y·ln x| ≤ 700.
inline double Pow(double x, double y) { return Exp(y * Log(x)); }

}  // namespace millpose
