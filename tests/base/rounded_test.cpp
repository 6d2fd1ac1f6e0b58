// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/rounded.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/text.hpp"

namespace millpose {
namespace {

TEST(Rounded, IsTheNumberThatTheTextSays) {
  EXPECT_EQ(WithDigits(1234.56, 3), 1230);
  EXPECT_EQ(WithDigits(-0.00123456, 2), -0.0012);
  EXPECT_EQ(WithDecimals(1234.56, 1), 1234.6);
  EXPECT_EQ(WithDecimals(2.5e-9, 6), 0);
  EXPECT_FALSE(std::signbit(WithDecimals(-2.5e-9, 6)));
  EXPECT_FALSE(std::signbit(WithDigits(-0.0, 3)));
}

// What is rounded stays as it is when it is rounded again, and its shortest text has no more digits.
TEST(Rounded, AgainChangesNothing) {
  RandomStream random(7, 0);
  for (int i = 0; i < 2000; ++i) {
    const double value = random.Normal() * std::pow(10, random.Below(12) - 6);
    const int digits = 1 + random.Below(9);
    const double once = WithDigits(value, digits);
    EXPECT_EQ(WithDigits(once, digits), once);
    EXPECT_NEAR(once, value, std::abs(value) * 5.01 * std::pow(10, -digits));
    EXPECT_EQ(fmt::format("{:.{}g}", once, digits), fmt::format("{:.{}g}", value, digits));
  }
}

}  // namespace
}  // namespace millpose
