// SPDX-License-Identifier: GPL-3.0-or-later
// What is milled with must be what interference is checked with.
#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "job/config/config.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

/// The first problem of a shipped cell with this cutter and stack; empty when it is taken.
std::string ProblemOf(const std::string& cutter, const std::string& stack) {
  const std::filesystem::path file = std::filesystem::path(SourceDir()) / "cells/quantec_r2700.yaml";
  std::string text = ReadFile(file);
  const size_t at = text.find("  cutter:"), end = text.find("# Estimated", at);
  EXPECT_TRUE(at != std::string::npos && end != std::string::npos);
  text.replace(at, end - at, "  cutter: {" + cutter + "}\n  stack: [" + stack + "]\n");
  try {
    ParseCell(text, "cell.yaml");
  } catch (const InputError& error) {
    return error.problems().front().message;
  }
  return "";
}

std::string Part(const char* body_class, double length, double diameter, double top) {
  return fmt::format("{{name: {0}{1}, class: {0}, length_mm: {1}, diameter_mm: {2}, top_diameter_mm: {3}}}",
                     body_class, length, diameter, top);
}

constexpr const char* kFlat = "diameter_mm: 20, cutting_length_mm: 40";

TEST(ToolStack, WhatHoldsTheCutterIsTaken) {
  const std::string holder = ", " + Part("holder", 50, 63, 63);
  EXPECT_EQ(ProblemOf(kFlat, Part("cutter", 60, 20, 20) + holder), "");
  EXPECT_EQ(ProblemOf(kFlat, Part("cutter", 40, 20, 20) + holder), "");  // ends just there
  EXPECT_EQ(ProblemOf(kFlat, Part("cutter", 40, 20, 20) + ", " + Part("cutter", 30, 12, 12) + holder),
            "");  // a neck
  EXPECT_EQ(ProblemOf(kFlat, Part("cutter", 25, 21, 24) + ", " + Part("cutter", 20, 24, 20.5)), "");
  EXPECT_EQ(ProblemOf("shape: ball, diameter_mm: 20, cutting_length_mm: 40", Part("cutter", 60, 20, 20)), "");
  EXPECT_EQ(ProblemOf("shape: bull, diameter_mm: 20, corner_radius_mm: 5, cutting_length_mm: 40",
                      Part("cutter", 5, 10, 30) + ", " + Part("cutter", 60, 20, 20)),
            "tool.stack[0]: up to 2.36068 mm thinner than the cutter of diameter_mm 20; allowed within "
            "cutting_length_mm: at least as thick");
}

TEST(ToolStack, WhatDoesNotHoldItIsRefused) {
  EXPECT_TRUE(ProblemOf(kFlat, "").starts_with(
      "tool.stack: 0 mm long; allowed: at least cutter.cutting_length_mm, 40"));
  EXPECT_TRUE(ProblemOf("diameter_mm: 200, cutting_length_mm: 40", Part("cutter", 60, 20, 20))
                  .starts_with("tool.stack[0]: up to 180 mm thinner"));
  EXPECT_TRUE(ProblemOf("diameter_mm: 20, cutting_length_mm: 4000", Part("cutter", 60, 20, 20))
                  .starts_with("tool.stack: 60 mm long; allowed: at least cutter.cutting_length_mm, 4000"));
  EXPECT_TRUE(
      ProblemOf(kFlat, Part("cutter", 30, 20, 20) + ", " + Part("holder", 60, 63, 63))
          .starts_with("tool.stack[1]: a holder from 30 mm above the tip; allowed within cutting_length_mm"));
  EXPECT_TRUE(ProblemOf(kFlat, Part("cutter", 30, 20, 20) + ", " + Part("cutter", 60, 12, 12))
                  .starts_with("tool.stack[1]: up to 8 mm thinner"));
  EXPECT_TRUE(ProblemOf(kFlat, Part("cutter", 60, 10, 20)).starts_with("tool.stack[0]: up to 10 mm thinner"));
}

// The worst place of a cone under a ball lies between its ends: the forecast against a search along it.
TEST(ToolStack, AConeInsideABallIsFound) {
  const std::string ball = "shape: ball, diameter_mm: 20, cutting_length_mm: 10";
  for (const double bottom : {0.5, 4.0, 8.0, 12.0}) {
    double worst = 0;
    for (int i = 0; i <= 100000; ++i) {
      const double z = 10.0 * i / 100000;
      worst = std::max(
          worst, 2 * (std::sqrt(100 - (10 - z) * (10 - z)) - (bottom / 2 + (10 - bottom / 2) * z / 10)));
    }
    const std::string problem = ProblemOf(ball, Part("cutter", 10, bottom, 20));
    ASSERT_NE(problem, "") << bottom;
    EXPECT_NEAR(std::stod(problem.substr(problem.find("up to ") + 6)), worst, 1e-4) << problem;
  }
}

}  // namespace
}  // namespace millpose
