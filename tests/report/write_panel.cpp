// SPDX-License-Identifier: GPL-3.0-or-later
// usage: write_report_panel PASSES POINTS FILE: writes the report of a panel plan for the browser test.
//        write_report_panel --summary LANGUAGE MANY WORDS: a summary with so many entries of so many words.
//        write_report_panel --say LANGUAGE: what the program says for each line of its input.
#include <cstdlib>
#include <iostream>

#include "base/file.hpp"
#include "report/words/words.hpp"
#include "tests/report/long_summary.hpp"
#include "tests/report/panel_plan.hpp"

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "--say") {
    for (std::string line; std::getline(std::cin, line);)
      std::cout << millpose::Say(millpose::ParseLanguage(argv[2]), line) << '\n';
    return 0;
  }
  if (argc == 5 && std::string(argv[1]) == "--summary") {
    const size_t many = std::strtoul(argv[3], nullptr, 10), words = std::strtoul(argv[4], nullptr, 10);
    std::cout << millpose::SummarySheetHtml(millpose::MakeLongSummary({many, many, many, many, words}),
                                            millpose::ParseLanguage(argv[2]));
    return 0;
  }
  if (argc != 4) return 2;
  millpose::Panel panel =
      millpose::MakePanel({.passes = std::atoi(argv[1]), .points = std::atoi(argv[2])}, "panel <b>&amp;</b>");
  millpose::CuttingForce force;
  force.mean = {40, 60, -20};
  for (millpose::PassResult& pass : panel.plan.passes)
    for (millpose::PlannedPoint& planned : pass.points) {
      const millpose::MillingPoint& point = planned.point;
      const Eigen::Vector3d across = point.tool_axis.cross(point.feed);
      planned.point.engagement = {40 * point.feed + 60 * across - 20 * point.tool_axis, 6, 1,
                                  pass.pass % 2 == 0 ? millpose::CutSide::kUp : millpose::CutSide::kDown};
    }
  const millpose::DeflectionReport deflections = millpose::PredictDeflections(panel.plan, force, {});
  millpose::HtmlInput input = panel.Input();
  input.deflection = &deflections;
  for (int line = 1; line <= 9; ++line) input.findings.push_back("finding " + std::to_string(line));
  millpose::WriteFileAtomically(argv[3], millpose::ReportHtml(input));
}
