// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/csv.hpp"

#include "base/error.hpp"

namespace millpose {
namespace {

const CsvColumns kColumns{{"x_mm", "y_mm"}, {"feed_mm_min"}};

std::string Complaint(const std::string& text) {
  try {
    ReadCsv(text, "p.csv", kColumns);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
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
  EXPECT_EQ(Complaint("x_mm,y_mm,x_mm\n"), "p.csv:1:11: column \"x_mm\" stands twice");
  EXPECT_EQ(Complaint(""), "p.csv: no header line; wanted: x_mm,y_mm and optionally feed_mm_min");
}

}  // namespace
}  // namespace millpose
