// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/locate.hpp"

#include <gtest/gtest.h>

namespace millpose {
namespace {

const std::string kJob =
    "name: part\n"
    "toolpath:\n"
    "  strategy: drill\n"
    "  drill: {holes: [{at_mm: [1, 2, 3]}, {at_mm: [4, 5, 6]}]}\n"
    "  spacing_mm: 4\n";

std::string Placed(const SourceLocation& place, const std::string& message) {
  JobInputs inputs;
  inputs.job.file = "job.yaml";
  inputs.job_text = kJob;
  return Located(InputError(place, message), inputs).what();
}

TEST(Located, AKeyGetsItsLineAndColumn) {
  EXPECT_EQ(Placed({}, "toolpath.spacing_mm: given 4"), "job.yaml:5:15: toolpath.spacing_mm: given 4");
  EXPECT_EQ(Placed({"job.yaml"}, "toolpath.strategy: given drill"),
            "job.yaml:3:13: toolpath.strategy: given drill");
  EXPECT_EQ(Placed({}, "toolpath.drill.holes[1].at_mm: given"),
            "job.yaml:4:40: toolpath.drill.holes[1].at_mm: given");
}

TEST(Located, WhatTheFileLacksGetsTheNearestSectionAboveIt) {
  EXPECT_EQ(Placed({}, "toolpath.drill.depth_mm: missing"), "job.yaml:4:3: toolpath.drill.depth_mm: missing");
  EXPECT_EQ(Placed({}, "toolpath: nothing lies in the region"),
            "job.yaml:2:1: toolpath: nothing lies in the region");
}

TEST(Located, OtherPlacesAndWordsStayAsTheyAre) {
  EXPECT_EQ(Placed({"cell.yaml"}, "tool: given"), "cell.yaml: tool: given");
  EXPECT_EQ(Placed({"job.yaml", 7}, "name: given"), "job.yaml:7: name: given");
  EXPECT_EQ(Placed({}, "dry run: pass 1 point 2 is out of reach"), "dry run: pass 1 point 2 is out of reach");
  EXPECT_EQ(Placed({"job.yaml"}, "process.cutting: missing"), "job.yaml: process.cutting: missing");
  EXPECT_EQ(Placed({}, "no key at all"), "no key at all");
}

}  // namespace
}  // namespace millpose
