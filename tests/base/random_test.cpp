// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/random.hpp"

namespace millpose {

TEST(RandomStream, SameSeedAndIndexSameNumbersOthersNot) {
  RandomStream a(1, 2), b(1, 2), c(1, 3), d(2, 2);
  const uint64_t first = a.Next();
  EXPECT_EQ(first, b.Next());
  EXPECT_NE(first, c.Next());
  EXPECT_NE(first, d.Next());
}

TEST(RandomStream, UniformAndNormalHaveTheirMoments) {
  RandomStream stream(7, 0);
  const int n = 200000;
  double sum = 0, square = 0, normal = 0, normal_square = 0;
  std::array<int, 5> counts{};
  for (int i = 0; i < n; ++i) {
    const double u = stream.Uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    square += u * u;
    const double z = stream.Normal();
    normal += z;
    normal_square += z * z;
    ++counts[stream.Below(5)];
  }
  EXPECT_NEAR(sum / n, 0.5, 0.005);
  EXPECT_NEAR(square / n, 1.0 / 3.0, 0.005);
  EXPECT_NEAR(normal / n, 0.0, 0.01);
  EXPECT_NEAR(normal_square / n, 1.0, 0.02);
  for (const int count : counts) EXPECT_NEAR(count, n / 5, n / 100);
}

// xoshiro256** by its authors' code, from the state that splitmix64 gives.
TEST(RandomStream, FollowsThePublishedGenerators) {
  const auto split_mix = [state = uint64_t{0}](uint64_t seed) mutable {
    if (seed != 0) state = seed;
    uint64_t z = (state += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  };
  auto seeds = split_mix, words = split_mix;
  const uint64_t mixed = seeds(1234567) ^ 5;
  EXPECT_EQ(mixed ^ 5, 6457827717110365317u);  // the first of splitmix64 with seed 1234567, as published
  uint64_t s[4] = {words(mixed), words(0), words(0), words(0)};
  RandomStream stream(1234567, 5);
  const auto rotated = [](uint64_t x, int k) { return (x << k) | (x >> (64 - k)); };
  for (int i = 0; i < 1000; ++i) {
    const uint64_t expected = rotated(s[1] * 5, 7) * 9, t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotated(s[3], 45);
    ASSERT_EQ(stream.Next(), expected);
  }
}

TEST(RandomStream, StreamsOfNeighboursAreIndependent) {
  constexpr int kCount = 20000;
  for (const auto& [a, b] : {std::pair(RandomStream(1, 0), RandomStream(1, 1)),
                             std::pair(RandomStream(1, 0), RandomStream(2, 0))}) {
    RandomStream one = a, other = b;
    double sum = 0;
    for (int i = 0; i < kCount; ++i) sum += (one.Uniform() - 0.5) * (other.Uniform() - 0.5);
    EXPECT_LT(std::abs(sum / kCount), 4 * (1.0 / 12) / std::sqrt(kCount));
  }
}

}  // namespace millpose
