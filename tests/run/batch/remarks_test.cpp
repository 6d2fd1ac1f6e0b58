// SPDX-License-Identifier: GPL-3.0-or-later
// A program that is confirmed but for a stated gap is no failure, and everybody is told.
#include <gtest/gtest.h>

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
  for (const auto report : {BatchJson, BatchIndex, JUnitXml, BatchText}) {
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

}  // namespace
}  // namespace millpose
