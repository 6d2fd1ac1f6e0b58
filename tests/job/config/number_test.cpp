// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/random.hpp"
#include "base/text.hpp"
#include "base/yaml/codec.hpp"

namespace millpose::yaml {
namespace {

double Read(const Unit& unit, const std::string& text) {
  std::vector<Problem> problems;
  double result = 0;
  Real(unit, Between(-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()))
      .read(Value::Plain(text), {"test", problems, "x"}, result);
  EXPECT_TRUE(problems.empty()) << text;
  return result;
}

}  // namespace

TEST(Numbers, AreWrittenAsTheyWereGiven) {
  for (const char* text : {"3", "0.05", "-35.1", "1e-05", "80", "7000", "109.7", "0"})
    for (const Unit& unit : {kOne, kMm, kDeg, kMmPerMin, kNmPerRad, kRevPerMin})
      EXPECT_EQ(ShortestIn(unit, Read(unit, text)), text) << unit.label;
}

TEST(Numbers, ReadBackToTheSameBits) {
  RandomStream random(7, 0);
  for (const Unit& unit : {kOne, kMm, kDeg, kDegPerS2, kMmPerMin, kNmPerRad, kRevPerMin})
    for (int i = 0; i < 2000; ++i) {
      const double external = random.Uniform(-1, 1) * std::pow(10.0, random.Below(9) - 3);
      const double inside = Read(unit, ShortestNumber(external));
      ASSERT_EQ(Read(unit, ShortestIn(unit, inside)), inside) << unit.label << ' ' << external;
    }
}

TEST(Numbers, OnlyOneWayOfWriting) {
  for (const char* text :
       {"010", "0x1f", "1_000", ".5", "5.", "+1", "1e", "1e999", ".inf", "nan", "-", "1,5", ""}) {
    std::vector<Problem> problems;
    double result = 42;
    Real(kOne, Between(-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()))
        .read(Value::Plain(text), {"test", problems, "x"}, result);
    EXPECT_EQ(problems.size(), 1u) << text;
    EXPECT_EQ(result, 42) << text;
  }
}

}  // namespace millpose::yaml
