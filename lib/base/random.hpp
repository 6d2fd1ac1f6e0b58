// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace millpose {

/// A reproducible stream of random numbers: xoshiro256** (Blackman and Vigna 2018) seeded by splitmix64 from
/// a seed and an index, so that every milling point has a stream of its own whatever thread works on it.
class RandomStream {
 public:
  RandomStream(uint64_t seed, uint64_t index);

  /// 64 random bits.
  uint64_t Next();
  /// Uniform in [0, 1).
  double Uniform();
  /// Uniform in [lower, upper).
  double Uniform(double lower, double upper);
  /// Uniform in 0..count-1; count > 0.
  int Below(int count);
  /// Standard normal deviate: twelve uniforms' sum less 6, free of the platform's logarithm (tails end at
  /// ±6).
  double Normal();

 private:
  std::array<uint64_t, 4> state_;
};

}  // namespace millpose
