// SPDX-License-Identifier: GPL-3.0-or-later
// usage: write_report_panel PASSES POINTS FILE: writes the report of a panel plan for the browser test.
#include <cstdlib>

#include "base/file.hpp"
#include "tests/report/panel_plan.hpp"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const millpose::Panel panel =
      millpose::MakePanel({.passes = std::atoi(argv[1]), .points = std::atoi(argv[2])}, "panel <b>&amp;</b>");
  millpose::CuttingForce force;
  force.mean = {40, 60, -20};
  const millpose::DeflectionReport deflections = millpose::PredictDeflections(panel.plan, force, {});
  millpose::HtmlInput input = panel.Input();
  input.deflection = &deflections;
  for (int line = 1; line <= 9; ++line) input.findings.push_back("finding " + std::to_string(line));
  millpose::WriteFileAtomically(argv[3], millpose::ReportHtml(input));
}
