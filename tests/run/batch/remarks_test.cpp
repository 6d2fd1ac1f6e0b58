// SPDX-License-Identifier: GPL-3.0-or-later
// A program that is confirmed but for a stated gap is no failure, and everybody is told.
#include <gtest/gtest.h>

#include <regex>

#include "run/batch/batch.hpp"

namespace millpose {
namespace {

constexpr const char* kRemark = "urscript: confirmed but for a stated gap: bounded by 0.0123 mm";

std::string ToldBy(std::string (*report)(const std::vector<BatchJob>&, const std::vector<JobOutcome>&),
                   const std::vector<std::string>& remarks) {
  JobOutcome outcome;
  outcome.points = outcome.planned = 20;
  outcome.remarks = remarks;
  return report({{"pad", "pad.yaml", {}}}, {outcome});
}

TEST(Remarks, StandInEveryReportOfABatch) {
  std::string (*index)(const std::vector<BatchJob>&, const std::vector<JobOutcome>&) =
      [](const auto& jobs, const auto& outcomes) { return BatchIndex(jobs, outcomes); };
  for (const auto report : {BatchJson, index, JUnitXml, BatchText}) {
    EXPECT_NE(ToldBy(report, {kRemark}).find(kRemark), std::string::npos) << ToldBy(report, {kRemark});
    EXPECT_EQ(ToldBy(report, {}).find("stated gap"), std::string::npos);
  }
}

TEST(Remarks, AreNoFailure) {
  const std::string xml = ToldBy(JUnitXml, {kRemark});
  EXPECT_NE(xml.find("<system-out>" + std::string(kRemark) + "</system-out></testcase>"), std::string::npos)
      << xml;
  EXPECT_NE(xml.find("failures=\"0\" errors=\"0\""), std::string::npos) << xml;
  EXPECT_EQ(xml.find("<failure"), std::string::npos) << xml;
}

/// Texts of a page between its tags, and what its title attributes say.
std::vector<std::string> TextsOf(const std::string& html) {
  static const std::regex kNotRead("<(style|script)>[\\s\\S]*?</(style|script)>"),
      kText(">([^<>]*[A-Za-z][^<>]*)<|title=\"([^\"]*)\"");
  const std::string page = std::regex_replace(html.substr(html.find("<body>")), kNotRead, "");
  std::vector<std::string> texts;
  for (std::sregex_iterator at(page.begin(), page.end(), kText), none; at != none; ++at)
    texts.push_back((*at)[1].matched ? at->str(1) : at->str(2));
  return texts;
}

TEST(BatchIndex, FoldsWhatDiffersFromTheBaseline) {
  JobOutcome outcome;
  outcome.remarks = {"baseline: settings   process.feed_mm_min: 600 -> 60",
                     "baseline: programs   krl: motions: 65 -> 60"};
  const std::string german = BatchIndex({{"pad", "pad.yaml", {}}}, {outcome}, Language::kGerman);
  for (const char* part : {"<summary>Vergleich: 2 Unterschiede.</summary>",
                           "<span>Einstellungen</span><span>process.feed_mm_min: 600 -&gt; 60</span>",
                           "<span>Programme</span><span>krl: Bewegungen: 65 -&gt; 60</span>"})
    EXPECT_NE(german.find(part), std::string::npos) << part << "\n" << german;
}

TEST(BatchIndex, EveryTextHasItsWords) {
  std::vector<BatchJob> jobs;
  std::vector<JobOutcome> outcomes;
  for (const int status : {0, 1, 2, 3}) {
    jobs.push_back({fmt::format("job_{}", status), "pad.yaml", {}});
    JobOutcome& outcome = outcomes.emplace_back();
    outcome.status = status;
    if (status > 1) continue;
    outcome.points = outcome.planned = 20;
    JobFigures& figures = outcome.figures.emplace();
    figures.objective = "surface_error";
    figures.objective_unit = "mm";
    figures.clearance_min = 12.5;
    if (status == 1) outcome.cause = "3 points skipped, 2 gaps not planned, 1 findings on programs";
    outcome.remarks = {
        "urscript: confirmed but for a stated gap: the corner's path, bounded by 0.0123 mm and 0.5000 deg, "
        "provided that x",
        "baseline: has no plan of this job"};
  }
  const std::string english = BatchIndex(jobs, outcomes),
                    german = BatchIndex(jobs, outcomes, Language::kGerman);
  EXPECT_NE(german.find("<html lang=\"de\">"), std::string::npos);
  size_t texts = 0, said = 0;
  for (const std::string& text : TextsOf(english)) {
    if (text.starts_with("job_") || text.starts_with("surface_error") || text.starts_with("batch.") ||
        text.starts_with("millpose"))
      continue;  // names
    const std::string lines = text.ends_with(": ") ? text.substr(0, text.size() - 2) : text;
    for (size_t at = 0; at < lines.size(); at = lines.find('\n', at), at += at != std::string::npos) {
      const std::string line = lines.substr(at, lines.find('\n', at) - at);
      EXPECT_TRUE(CanSay(line) || line == ", with the run's times ") << line;
    }
    ++texts;
    said += german.find(">" + text + "<") == std::string::npos;
  }
  EXPECT_GT(texts, 35u);
  EXPECT_EQ(said, texts);
}

}  // namespace
}  // namespace millpose
