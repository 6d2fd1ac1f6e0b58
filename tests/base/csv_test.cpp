// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/csv.hpp"

#include "base/error.hpp"
#include "base/random.hpp"
#include "tests/base/refusal.hpp"

namespace millpose {
namespace {

const CsvColumns kColumns{{"x_mm", "y_mm"}, {"feed_mm_min"}};

std::string Complaint(const std::string& text) {
  return RefusalOf([&] { ReadCsv(text, "p.csv", kColumns); });
}

TEST(Csv, ReadsColumnsInAnyOrder) {
  const CsvTable table = ReadCsv("# a comment\r\ny_mm, x_mm\r\n\r\n1,2\r\n -3.5 ,4e2", "p.csv", kColumns);
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table.At(0, "x_mm"), 2);
  EXPECT_EQ(table.At(1, "y_mm"), -3.5);
  EXPECT_EQ(table.At(1, "x_mm"), 400);
  EXPECT_EQ(table.line(1), 5);
  EXPECT_FALSE(table.Has("feed_mm_min"));
}

TEST(Csv, NamesEveryProblemWithItsPlace) {
  EXPECT_EQ(Complaint("x_mm,y_nm\n1,2\n"),
            "p.csv:1:6: unknown column \"y_nm\"; known: x_mm, y_mm, feed_mm_min; did you mean \"y_mm\"?\n"
            "p.csv:1: column \"y_mm\" is missing");
  EXPECT_EQ(Complaint("x_mm,y_mm\n1\n2,nan\n"),
            "p.csv:2: given 1 cells; the header names 2\n"
            "p.csv:3:3: y_mm: given \"nan\"; allowed: a finite number");
  EXPECT_EQ(Complaint("x_mm,y_mm,x_mm\n"), "p.csv:1:11: column \"x_mm\" is given twice");
  EXPECT_EQ(Complaint(""), "p.csv: no header line; wanted: x_mm,y_mm and optionally feed_mm_min");
}

TEST(Csv, AMarkOfUtf8InFrontAndAMissingLastLineEndAreNothing) {
  const CsvTable table = ReadCsv("\xef\xbb\xbfx_mm,y_mm\n1,2", "p.csv", kColumns);
  ASSERT_EQ(table.size(), 1u);
  EXPECT_EQ(table.At(0, "y_mm"), 2);
}

TEST(Csv, RandomTablesReadBackBitForBit) {
  RandomStream random(1, 0);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::array<double, 3>> rows(static_cast<size_t>(random.Below(30)));
    std::string text = "feed_mm_min,x_mm,y_mm\n";
    for (auto& row : rows) {
      for (double& value : row) value = std::ldexp(random.Normal(), random.Below(600) - 300);
      text += fmt::format("{},{},{}\n", row[0], row[1], row[2]);
    }
    const CsvTable table = ReadCsv(text, "p.csv", kColumns);
    ASSERT_EQ(table.size(), rows.size());
    for (size_t i = 0; i < rows.size(); ++i) {
      EXPECT_EQ(table.At(i, "feed_mm_min"), rows[i][0]);
      EXPECT_EQ(table.At(i, "x_mm"), rows[i][1]);
      EXPECT_EQ(table.At(i, "y_mm"), rows[i][2]);
      EXPECT_EQ(table.line(i), static_cast<int>(i) + 2);
    }
  }
}

// Whatever happens to a file: a table of finite numbers or an InputError with a line, nothing else.
TEST(Csv, DamageIsATableOrAnError) {
  const std::string sound = "x_mm,y_mm,feed_mm_min\n1,2,3\n# c\n4,5e1,6\n";
  RandomStream random(2, 0);
  int refused = 0;
  for (int k = 0; k < 2000; ++k) {
    std::string text = sound;
    for (int n = random.Below(4); n >= 0; --n)
      text[static_cast<size_t>(random.Below(static_cast<int>(text.size())))] =
          static_cast<char>(random.Below(256));
    try {
      const CsvTable table = ReadCsv(text, "p.csv", kColumns);
      for (size_t i = 0; i < table.size(); ++i) EXPECT_TRUE(std::isfinite(table.At(i, "x_mm")));
    } catch (const InputError& error) {
      ++refused;
      for (const Problem& problem : error.problems()) EXPECT_EQ(problem.place.file, "p.csv");
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Csv, AFileOfErrorsIsNotReadToItsEnd) {
  std::string text = "x_mm,y_mm\n";
  for (int i = 0; i < 100000; ++i) text += "a,b\n";
  try {
    ReadCsv(text, "p.csv", kColumns);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_LE(error.problems().size(), 102u);
    EXPECT_EQ(error.problems()[1].place.column, 3);
    EXPECT_EQ(error.problems()[2].place.line, 3);
  }
}

}  // namespace
}  // namespace millpose
