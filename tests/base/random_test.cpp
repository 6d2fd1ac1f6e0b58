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

}  // namespace millpose
