// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.hpp"

#include "base/random.hpp"
#include "base/shown.hpp"

namespace millpose {

TEST(Text, NumbersReadBackToTheSame) {
  for (const double value : {0.0, 0.1, -3.0, 1e-300, 12345678.9, 2.0 / 3.0})
    EXPECT_EQ(ParseNumber(ShortestNumber(value)), value);
}

TEST(Text, ForeignTextIsShownShortAndInOneLine) {
  EXPECT_EQ(Shown("a\nb\x1b[31m", 60), "a?b?[31m");
  EXPECT_EQ(Shown("12345678", 4), "1234…");
  EXPECT_EQ(Shown("123\u00e4", 4), "123…");  // no half a character
  EXPECT_EQ(Shown("a\xff\xc3(\xed\xa0\x80", 60),
            "a??"
            "(???");  // no UTF-8
}

TEST(Text, OnlyWholeFiniteDecimalsAreNumbers) {
  EXPECT_EQ(ParseNumber("+1.5e3"), 1500.0);
  for (const char* text : {"", " 1", "1 ", "1,5", "0x10", "nan", "inf", "1e999", "--1", "+-1"})
    EXPECT_FALSE(ParseNumber(text)) << text;
}

TEST(ValidUtf8, KeepsWhatIsAndReplacesWhatIsNot) {
  for (const char* text : {"", "abc", "gr\xC3\xB6\xC3\x9F", "\xE2\x80\x93", "\xF0\x9F\x94\xA7"})
    EXPECT_EQ(ValidUtf8(text), text);
  const std::string mark = "\xEF\xBF\xBD";
  EXPECT_EQ(ValidUtf8("gro\xDF/x"), "gro" + mark + "/x");
  // Longer than needed, half of a pair, above the last code point, cut off.
  EXPECT_EQ(ValidUtf8("\xC0\xAF"), mark + mark);
  EXPECT_EQ(ValidUtf8("\xED\xA0\x80"), mark + mark + mark);
  EXPECT_EQ(ValidUtf8("\xF5\x80"), mark + mark);
  EXPECT_EQ(ValidUtf8("\xE2\x80"), mark + mark);
}

TEST(Text, AnyDoubleReadsBackToItsBits) {
  RandomStream random(1, 0);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::bit_cast<double>(random.Next());
    if (!std::isfinite(value)) continue;
    const std::optional<double> read = ParseNumber(ShortestNumber(value));
    ASSERT_TRUE(read) << ShortestNumber(value);
    EXPECT_EQ(std::bit_cast<uint64_t>(*read), std::bit_cast<uint64_t>(value));
  }
}

TEST(ValidUtf8, WhatItGivesIsValidAndStays) {
  RandomStream random(2, 0);
  for (int k = 0; k < 2000; ++k) {
    std::string bytes;
    for (int n = random.Below(12); n > 0; --n)  // half of them in the range of long characters
      bytes += static_cast<char>(random.Below(2) != 0 ? random.Below(256) : 0x80 + random.Below(0x78));
    const std::string valid = ValidUtf8(bytes);
    EXPECT_EQ(ValidUtf8(valid), valid);
    const std::string shown = Shown(valid, 1000);
    EXPECT_EQ(std::ranges::count(shown, '?'), std::ranges::count_if(valid, [](char c) {
                return c == '?' || (c >= 0 && c < ' ') || c == 0x7f;
              }));
  }
}

}  // namespace millpose
