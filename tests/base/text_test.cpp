// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.hpp"

namespace millpose {

TEST(Text, NumbersReadBackToTheSame) {
  for (const double value : {0.0, 0.1, -3.0, 1e-300, 12345678.9, 2.0 / 3.0})
    EXPECT_EQ(ParseNumber(ShortestNumber(value)), value);
}

TEST(Text, OnlyWholeFiniteDecimalsAreNumbers) {
  EXPECT_EQ(ParseNumber("+1.5e3"), 1500.0);
  for (const char* text : {"", " 1", "1 ", "1,5", "0x10", "nan", "inf", "1e999", "--1", "+-1"})
    EXPECT_FALSE(ParseNumber(text)) << text;
}

}  // namespace millpose
