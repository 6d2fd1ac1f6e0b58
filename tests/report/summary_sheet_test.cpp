// SPDX-License-Identifier: GPL-3.0-or-later
// The two pages that are signed: whatever the plan is, they stay two, and say what they leave out.
#include "report/summary_sheet.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "report/words/word_table.hpp"
#include "tests/report/long_summary.hpp"

namespace millpose {
namespace {

size_t TimesIn(const std::string& text, const std::string& what) {
  size_t count = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

/// What stands between `from` and the next `to`, without tags.
std::string InnerText(const std::string& html, const std::string& from, const std::string& to) {
  const size_t begin = html.find(from), end = html.find(to, begin);
  static const std::regex kTags("<[^>]*>");
  return begin == std::string::npos ? "" : std::regex_replace(html.substr(begin, end - begin), kTags, "");
}

/// Rows and lines of the second page, as wide as a line of it is.
size_t LinesOfSecondPage(const std::string& html) {
  const std::string page = html.substr(html.rfind("<section class=\"page\">"));
  size_t lines = TimesIn(InnerText(page, "<table class=\"programs\">", "</table>") + "\n",
                         ".src");  // a row names its file once
  static const std::regex kItem("<li>([^<]*)</li>");
  for (std::sregex_iterator at(page.begin(), page.end(), kItem), none; at != none; ++at)
    lines += (ColumnsOf(at->str(1)) + 99) / 100;
  return lines;
}

TEST(SummarySheet, IsTwoPagesOfBoundedLengthForAnyPlan) {
  for (const size_t many : {0u, 1u, 13u, 300u})
    for (const size_t words : {1u, 30u, 60u})
      for (const Language language : {Language::kEnglish, Language::kGerman, Language::kChinese}) {
        const std::string html = SummarySheetHtml(MakeLongSummary({many, many, many, many, words}), language);
        EXPECT_EQ(TimesIn(html, "<section class=\"page\">"), 2u);
        EXPECT_NE(html.find("<b>1 / 2</b>"), std::string::npos);
        EXPECT_NE(html.find("<b>2 / 2</b>"), std::string::npos);
        EXPECT_EQ(html.find("<script"), std::string::npos);
        EXPECT_LE(LinesOfSecondPage(html), SummaryRoom::kSecondPage) << many << ' ' << words;
        EXPECT_LE(TimesIn(html, "<td>operation_"), SummaryRoom::kOperations);
        EXPECT_LE((ColumnsOf(InnerText(html, "<div class=\"verdict", "</div>")) + 99) / 100,
                  SummaryRoom::kWhyLines + 2);
        EXPECT_LT(html.size(), 40'000u);
      }
}

TEST(SummarySheet, WhatIsLeftOutIsCounted) {
  const std::string html = SummarySheetHtml(MakeLongSummary({20, 100, 50, 0, 3}));
  const auto more = [&](const char* from, const std::string& of, size_t all, const std::string& what) {
    const std::string part = html.substr(html.find(from));
    const size_t shown = TimesIn(part.substr(0, part.find(of)), what);
    EXPECT_GT(shown, 3u);
    EXPECT_NE(part.find(fmt::format("{} {}", all - shown, of)), std::string::npos) << all - shown << of;
  };
  more("<table class=\"operations\">", "more: report.html", 20, "<td>operation_");
  more("<h2>Findings", "more: report.html", 50, "<li>pad");
  more("<table class=\"programs\">", "more: manifest.json", 100, "programs/krl/");
  // All of a small plan is there, and nothing is said of more.
  const std::string small = SummarySheetHtml(MakeLongSummary({2, 12, 4, 4, 3}));
  EXPECT_EQ(small.find("more:"), std::string::npos);
  EXPECT_EQ(TimesIn(small, "programs/krl/"), 12u);
}

TEST(SummarySheet, NamesAreCutBetweenSigns) {
  SummarySheet sheet = MakeLongSummary({1, 0, 0, 0, 1});
  for (size_t length = 60; length < 80; ++length) {
    sheet.job.clear();
    for (size_t i = 0; i < length; ++i) sheet.job += i % 2 == 0 ? "铣" : "ä";
    const std::string html = SummarySheetHtml(sheet);
    EXPECT_EQ(html.find('?'), std::string::npos);  // what ValidUtf8 makes of half a sign
    EXPECT_NE(html.find("…"), std::string::npos);
  }
}

TEST(SummarySheet, OfALongPathTheFileIsNamed) {
  SummarySheet sheet = MakeLongSummary({1, 0, 0, 0, 1});
  for (size_t length = 1; length < 90; ++length) {
    sheet.programs = {{"krl", std::string(length, 'd') + "/p7.src", "confirmed", "0"}};
    const std::string html = SummarySheetHtml(sheet);
    EXPECT_NE(html.find("/p7.src</td>"), std::string::npos);
    EXPECT_EQ(html.find("…d") != std::string::npos, length + 7 > 46) << length;
  }
}

TEST(SummarySheet, BarsAreSharesOfTheSum) {
  const std::string html = SummarySheetHtml(MakeLongSummary({1, 1, 0, 0, 1}));
  static const std::regex kBar("width:([0-9.]+)%");
  std::vector<double> shares;
  for (std::sregex_iterator at(html.begin(), html.end(), kBar), none; at != none; ++at)
    shares.push_back(std::stod(at->str(1)));
  EXPECT_EQ(shares, (std::vector<double>{40, 30, 20, 10, 100}));  // 4, 3, 2, 1 of 10
  EXPECT_NE(html.find("not stated: gear error, geometry, thermal, dynamics"), std::string::npos);
}

TEST(PathCurves, NoPeakIsLostAndTheTextStaysShort) {
  for (const size_t points : {10u, 1000u, 200'000u}) {
    PathCurves curves{"t", "µm", {}, {{"s", "#123", {}}}};
    const size_t peak = points / 3;
    for (size_t i = 0; i < points; ++i) {
      curves.way.push_back(static_cast<double>(i));
      curves.series[0].values.push_back(i == peak ? 8.0 : 1 + 1e-3 * static_cast<double>(i % 7));
      if (i % 2 == 1) curves.left_out.push_back(curves.way.back());
    }
    const std::string svg = CurvesSvg(curves, 150);
    EXPECT_LT(svg.size(), 60'000u);
    static const std::regex kCourse("class=\"course\" d=\"([^\"]*)\""), kPlace("[ML](\\d+),([\\d.]+)");
    std::smatch course;
    ASSERT_TRUE(std::regex_search(svg, course, kCourse));
    const std::string d = course.str(1);
    double top = 1e9, x_of_top = 0, last = -1;
    for (std::sregex_iterator at(d.begin(), d.end(), kPlace), none; at != none; ++at) {
      const double x = std::stod(at->str(1)), y = std::stod(at->str(2));
      EXPECT_GT(x, last);
      last = x;
      if (y < top) top = y, x_of_top = x;
    }
    EXPECT_NEAR(top, 8, 1e-9);  // px: the upper end of the axis, whose end is the largest value
    EXPECT_NEAR(x_of_top, 52 + 656.0 * static_cast<double>(peak) / static_cast<double>(points - 1), 1);
  }
}

TEST(PathCurves, PointsWithoutAFigureAreLeftOut) {
  const double none = std::nan("");
  const std::string svg =
      CurvesSvg({"t", "µm", {0, 1, 2, 3}, {{"s", "#123", {none, 2, none, 1}}}, {{1, "2"}}, {0, 2}}, 120);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(TimesIn(svg, "class=\"skipped\""), 2u);
  EXPECT_NE(svg.find(">2</text>"), std::string::npos);
  // Two points by themselves, and no line from one to the other.
  EXPECT_EQ(TimesIn(svg.substr(svg.find("class=\"course\"")), "h0"), 2u);
  const std::string whole = CurvesSvg({"t", "µm", {0, 1, 2, 3}, {{"s", "#123", {none, 2, 3, 1}}}}, 120);
  EXPECT_EQ(TimesIn(whole.substr(whole.find("class=\"course\"")), "h0"), 1u);
  // Of nothing too there is a chart, without a curve.
  EXPECT_EQ(CurvesSvg({"t", "µm", {}, {{"s", "#123", {}}}}, 120).find("class=\"course\""), std::string::npos);
}

TEST(PathCurves, StepsAreRoundAndAsFineAsAllowed) {
  for (const double range : {1e-6, 0.003, 0.7, 1.0, 4.9, 5.1, 99.0, 12345.0, 3e8})
    for (const int most : {2, 4, 8}) {
      const double step = RoundStep(range, most), parts = range / step;
      EXPECT_LE(parts, most * (1 + 1e-9));
      EXPECT_GT(parts, most / 2.5001);  // the next finer step would part it into more
      double mantissa = step;
      while (mantissa >= 9.9) mantissa /= 10;
      while (mantissa < 0.99) mantissa *= 10;
      EXPECT_TRUE(std::abs(mantissa - 1) < 1e-9 || std::abs(mantissa - 2) < 1e-9 ||
                  std::abs(mantissa - 5) < 1e-9)
          << step;
    }
}

}  // namespace
}  // namespace millpose
