// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of words, and that reports have no English label without its words.
#include "report/words/words.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "base/error.hpp"
#include "base/file.hpp"
#include "report/budget.hpp"
#include "report/html_columns.hpp"
#include "report/price_text.hpp"
#include "report/report.hpp"
#include "report/web_assets.hpp"
#include "report/words/word_table.hpp"
#include "small_plan.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/report/panel_plan.hpp"

namespace millpose {
namespace {

constexpr Language kOthers[] = {Language::kGerman, Language::kChinese};

const std::vector<WordEntry>& AllWords() {
  static const std::vector<WordEntry> all = [] {
    std::vector<WordEntry> words = ParseWords(kWordsOfPage, "page");
    std::ranges::move(ParseWords(kWordsOfCheck, "check"), std::back_inserter(words));
    std::ranges::move(ParseWords(kWordsOfSheet, "sheet"), std::back_inserter(words));
    return words;
  }();
  return all;
}

/// All that a pattern finds in a text, sorted.
std::multiset<std::string> FoundIn(const std::string& text, const std::regex& pattern) {
  std::multiset<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), pattern), none; at != none; ++at)
    found.insert(at->str());
  return found;
}

TEST(Words, EveryEntryHasItsPlacesInBothLanguages) {
  static const std::regex kPlace("\\{[^}]*\\}");
  std::set<std::string> seen;
  ASSERT_GT(AllWords().size(), 400u);
  for (const WordEntry& entry : AllWords()) {
    EXPECT_TRUE(seen.insert(entry.english).second) << "twice: " << entry.english;
    for (const std::string& place : FoundIn(entry.english, kPlace))
      EXPECT_TRUE(std::set<std::string>({"{}", "{#}", "{say}", "{any}"}).contains(place)) << entry.english;
    for (size_t i = 1; i + 1 < entry.pieces.size(); ++i)
      EXPECT_FALSE(entry.pieces[i].before.empty()) << "two places touch: " << entry.english;
    std::multiset<std::string> wanted;
    for (size_t i = 1; i < entry.pieces.size(); ++i) wanted.insert(fmt::format("{{{}}}", i));
    for (const Language language : kOthers)
      EXPECT_EQ(FoundIn(entry.In(language), kPlace), wanted) << entry.In(language);
  }
}

TEST(Words, FiguresOfTheTablesAreTheSameInEveryLanguage) {
  static const std::regex kFigure("[0-9]+(\\.[0-9]+)?");
  static const std::regex kPlace("\\{[^}]*\\}");
  for (const WordEntry& entry : AllWords())
    for (const Language language : kOthers)
      EXPECT_EQ(FoundIn(std::regex_replace(entry.In(language), kPlace, "#"), kFigure),
                FoundIn(std::regex_replace(entry.english, kPlace, "#"), kFigure))
          << entry.In(language);
}

/// The English text with something at its places: figures that no two places share, a name, known words.
std::string FilledIn(const WordEntry& entry, std::vector<std::string>& kept) {
  std::string text;
  for (size_t i = 0; i < entry.pieces.size(); ++i) {
    const WordPiece& piece = entry.pieces[i];
    text += piece.before;
    if (piece.place == WordPlace::kEnd) break;
    if (piece.place == WordPlace::kWords) {
      text += "interference";
      continue;
    }
    kept.push_back(piece.place == WordPlace::kNumber ? fmt::format("{}.5", 70 + i) : fmt::format("Zq{}", i));
    text += kept.back();
  }
  return text;
}

TEST(Words, WhatStandsAtThePlacesIsKept) {
  size_t changed = 0;
  for (const WordEntry& entry : AllWords()) {
    std::vector<std::string> kept;
    const std::string english = FilledIn(entry, kept);
    EXPECT_TRUE(CanSay(english)) << english;
    for (const Language language : kOthers) {
      const std::string said = Say(language, english);
      for (const std::string& one : kept) EXPECT_NE(said.find(one), std::string::npos) << said;
      changed += said != english;
    }
    EXPECT_EQ(Say(Language::kEnglish, english), english);
  }
  EXPECT_GT(changed, 2 * AllWords().size() - 60);  // symbols and units are the same
}

TEST(Words, WhatIsUnknownStaysSentenceBySentence) {
  EXPECT_EQ(Say(Language::kGerman, "krl.src:12: no such thing"), "krl.src:12: no such thing");
  EXPECT_FALSE(CanSay("krl.src:12: no such thing"));
  EXPECT_EQ(Say(Language::kGerman, "Nobody knows. None: every point is planned."),
            "Nobody knows. Keine: jeder Punkt ist geplant.");
  EXPECT_EQ(Say(Language::kChinese, "None: every point is planned. None: every point is planned."),
            "无：所有点均已规划。无：所有点均已规划。");
  for (const char* figures : {"", "12.5", "-3, 4.25", "≥ 50", "1/2"})
    EXPECT_EQ(Say(Language::kChinese, figures), figures);
  // A list is said as a whole, or not at all.
  EXPECT_EQ(Say(Language::kGerman, "gear error, thermal"), "Getriebefehler, Wärme");
  EXPECT_EQ(Say(Language::kGerman, "gear error, unheard"), "gear error, unheard");
  EXPECT_EQ(Say(Language::kGerman, "krl confirmed (2 files), rapid confirmed (1 file)"),
            "krl bestätigt (2 Dateien), rapid bestätigt (1 Datei)");
  // No figure where a figure is wanted.
  EXPECT_EQ(Say(Language::kGerman, "pass x"), "pass x");
  EXPECT_EQ(Say(Language::kGerman, "pass 7"), "Bahn 7");
}

TEST(Words, LanguagesAreNamedWhereOneIsUnknown) {
  EXPECT_EQ(ParseLanguage("zh"), Language::kChinese);
  try {
    ParseLanguage("dee");
    FAIL();
  } catch (const InputError& error) {
    for (const char* part : {"--lang", "dee", "en", "de", "zh", "did you mean \"de\""})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Words, ATableThatIsNoneIsRefusedAtItsLine) {
  for (const auto& [text, place] : {std::pair("en a\nzh b\n", "t:2:1"),
                                    {"en a\nde b\n", "t:2:1"},
                                    {"de b\n", "t:1:1"},
                                    {"# x\n\nfr b\n", "t:3:1"},
                                    {"en a\nde b\nde c\n", "t:3:1"}})
    try {
      ParseWords(text, "t");
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(place)) << error.what();
    }
}

/// What stands in a page before any script runs; how many labels that are.
size_t ExpectLabelsHaveWords(const std::string_view whole) {
  static const std::regex kNotSaid(
      "<(style|script|kbd translate|pre translate|select "
      "id=\"(language|speed)\")[\\s\\S]*?</(style|script|kbd|pre|select)>");
  static const std::regex kText(">([^<>]*[A-Za-z][^<>]*)<|(?:title|aria-label)=\"([^\"]*)\""),
      kBlanks("\\s*\\n\\s*"), kEnds("^\\s+|\\s+$");
  const std::string page = std::regex_replace(std::string(whole.substr(whole.find("<body"))), kNotSaid, "");
  size_t labels = 0;
  for (std::sregex_iterator at(page.begin(), page.end(), kText), none; at != none; ++at, ++labels) {
    const std::string text = std::regex_replace(
        std::regex_replace((*at)[1].matched ? at->str(1) : at->str(2), kBlanks, " "), kEnds, "");
    if (text.starts_with("{{") || text.size() == 1) continue;  // keys of one letter
    EXPECT_TRUE(CanSay(text)) << text;
  }
  return labels;
}

TEST(Words, PagesHaveNoLabelWithoutWords) {
  EXPECT_GT(ExpectLabelsHaveWords(kWebPage), 75u);
  EXPECT_GT(ExpectLabelsHaveWords(kWebCheckPage), 30u);
}

TEST(Words, ColumnsReasonsAndBudgetHaveWords) {
  const Panel panel = MakePanel({.passes = 2, .points = 4});
  PlanResult plan = panel.plan;
  plan.passes.front().points.front().compensation.emplace().force = Eigen::Vector3d::UnitX();
  plan.passes.front().points.front().compensation->arm_shift = Eigen::Vector3d::UnitX();
  const DeflectionReport deflection = PredictDeflections(plan, {}, {});
  LostMotionReport lost = ReportLostMotion(plan, {}, "", 0);
  lost.model.known.fill(true);
  const std::vector<ReportColumn> columns = ReportColumns(plan, &deflection, &lost);
  EXPECT_GT(columns.size(), 30u);
  for (const ReportColumn& column : columns) EXPECT_TRUE(CanSay(column.label)) << column.label;
  for (int i = 1; i <= static_cast<int>(Infeasibility::kStock); ++i) {
    const std::string reason = ToString(static_cast<Infeasibility>(i));
    EXPECT_TRUE(reason == "source" || CanSay(reason)) << reason;
  }
  for (const DeflectionReport* known : {&deflection, static_cast<const DeflectionReport*>(nullptr)})
    for (const BudgetRow& row : MakeBudget(known, ReportLostMotion(plan, {}, "", 0)).rows) {
      EXPECT_TRUE(CanSay(row.name)) << row.name;
      EXPECT_TRUE(CanSay(row.basis)) << row.basis;
    }
  EXPECT_TRUE(CanSay(LostMotionText(plan, lost))) << LostMotionText(plan, lost);
  EXPECT_TRUE(CanSay(kDeflectionModel));
}

TEST(Words, TheSummaryIsSaidLineByLineWithItsFigures) {
  static const std::regex kFigure("[0-9]+(\\.[0-9]+)?");
  ReportInputs inputs;
  for (int i = 0; i < 9; ++i) inputs.findings.push_back(fmt::format("found {}", i));
  inputs.budget = MakeBudget(nullptr, ReportLostMotion(SmallPlan(), {}, "", 0));
  for (const PlanResult& plan : {SmallPlan(), MakePanel({.passes = 2, .points = 4}).plan}) {
    const std::string english = BriefText(plan, inputs, "out");
    const std::vector<std::string_view> lines = LinesOf(english);
    for (const Language language : kOthers) {
      const std::string said = SayBrief(language, english);
      EXPECT_EQ(FoundIn(said, kFigure), FoundIn(english, kFigure)) << said;
      const std::vector<std::string_view> told = LinesOf(said);
      ASSERT_EQ(told.size(), lines.size());
      for (size_t i = 0; i < lines.size(); ++i) EXPECT_NE(told[i], lines[i]);
    }
    EXPECT_EQ(SayBrief(Language::kEnglish, english), english);
  }
  EXPECT_EQ(SayBrief(Language::kGerman, "done       a on b: 2 of 2 points in 1 pass\nreport     x y\n"),
            "fertig     a auf b: 2 von 2 Punkten in 1 Bahn\nBericht    x y\n");
  // Columns of a terminal: a sign of Chinese takes two.
  EXPECT_EQ(SayBrief(Language::kChinese, "clearance  at least 3.0 mm\n"), "间隙       至少 3.0 mm\n");
}

// One sentence in both places: in docs/glossary.md for those who read, in the page on tap.
TEST(Words, TipsStandInTheGlossary) {
  const std::string glossary = ReadFile(std::string(SourceDir()) + "/docs/glossary.md");
  size_t tips = 0;
  for (const WordEntry& entry : AllWords()) {
    if (entry.tip.empty()) continue;
    ++tips;
    EXPECT_NE(glossary.find("| " + entry.english + " |"), std::string::npos) << entry.english;
  }
  EXPECT_GT(tips, 15u);
}

// The page of documentation shows an entry as it stands.
TEST(Words, TheDocumentedEntryIsOne) {
  const std::string page = ReadFile(std::string(SourceDir()) + "/docs/languages.md");
  std::string entry;
  for (const std::string_view line : LinesOf(page))
    for (const char* key : {"    en ", "    de ", "    zh "})
      if (line.starts_with(key)) entry += std::string(line.substr(4)) + '\n';
  EXPECT_EQ(std::ranges::count(entry, '\n'), 3);
  EXPECT_NE(kWordsOfSheet.find(entry), std::string_view::npos) << entry;
}

}  // namespace
}  // namespace millpose
