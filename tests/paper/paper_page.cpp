// SPDX-License-Identifier: GPL-3.0-or-later
// Writes docs/paper.md (with --figure docs/paper-figure3.svg): the numbers of Chen et al. 2021 beside those
// that millpose computes. The sections stand in page_*.cpp.
#include <cstdio>
#include <string_view>

#include "tests/paper/page.hpp"

namespace millpose {
namespace {

std::string page;

}  // namespace

using Eigen::Vector3d;

void WriteLine(const std::string& line) { page += line + '\n'; }

void Head() {
  Write("# Chen et al. 2021 compared with millpose\n");
  Write(
      "This page says which numbers of the paper millpose reproduces: Chen Qintao et al., Pose Optimization "
      "of "
      "Industrial");
  Write(
      "Robots Based on Stiffness for Milling Tasks, Robot 43(1), 2021, 90-100. Verdicts: **reproduced**, "
      "**order only**,");
  Write(
      "**cannot be**. Compliance is in 1e-4 mm/N. `tests/paper/paper_page.cpp` writes the page, and the test "
      "`paper` compares it.\n");
}

void Table1() {
  Write("## Table 1: lengths of the links\n");
  Write("| length | paper | KR QUANTEC R2700 | KR 500 R2830 | KR 500 R2800-2 |\n|---|---|---|---|---|");
  const Arm a = KrQuantecR2700(), b = Kr500R2830(), c = Kr500R2800();
  const auto row = [&](const char* name, double paper, double Arm::*field) {
    Write("| {} | {} | {} | {} | {} |", name, paper, std::abs(a.*field), std::abs(b.*field),
          std::abs(c.*field));
  };
  row("d1", 675, &Arm::d1);
  row("a1 (a2)", 350, &Arm::a1);
  row("a2 (a3)", 1150, &Arm::a2);
  row("\\|dz\\| (a4)", 41, &Arm::dz);
  row("d4", 1200, &Arm::d4);
  row("d6", 215, &Arm::d6);
  Write("\n**Cannot be** a KR 500: the lengths are those of a KR QUANTEC R2700.\n");
}

void Figure3Section(const Figure3& figure) {
  Write("## Equation 3 and figure 3: dexterity over a plane\n");
  Write(
      "The paper's figure 3 prints neither plane, orientation nor numbers, so it **cannot be** compared "
      "point by");
  Write(
      "point. Beside it, the same index over the vertical plane through axis 1 (y = 0), Table 6's arm and "
      "tool, tool");
  Write(
      "axis horizontal against the arm, each point in its best pose within table 5 and the arm's limits:\n");
  Write("![D over the x-z plane](paper-figure3.svg)\n");
  Write(
      "{} of {} points are reached. D is at most {:.4f} with lengths in units of 1000 mm; the same pose has",
      figure.reached, figure.total, figure.greatest);
  Write(
      "{:.2e} with lengths in mm, as equation 3 is printed: D mixes units, its scale is that of the length "
      "chosen.\n",
      figure.in_mm);
  int yellow = 0;
  std::string values;
  for (int k = 0; k < 5; ++k) {
    const double D = Dexterity(Jacobian(Chen2021Table6(), kTable6[k], kTip), 1000);
    yellow += D >= figure.yellow_from;
    values += fmt::format("{}{:.4f}", k == 0 ? "" : ", ", D);
  }
  Write("The paper wants poses from its bright area. Table 6's five have {};", values);
  Write(
      "{} of them lie in the brightest three of ten bands (D from {:.4f}). In a job, `limits.dexterity_min` "
      "makes it a condition.\n",
      yellow, figure.yellow_from);
}

int Main(bool figure_alone) {
  const Figure3 figure = DrawFigure3();
  if (figure_alone) {
    std::fputs(figure.svg.c_str(), stdout);
    return 0;
  }
  Head();
  Table1();
  Figure3Section(figure);
  Identification2();
  Table4();
  Table5();
  Table6();
  Equation36();
  Table7();
  Flatness45();
  std::fputs(page.c_str(), stdout);
  return 0;
}

}  // namespace millpose

int main(int argc, char** argv) {
  return millpose::Main(argc == 2 && std::string_view(argv[1]) == "--figure");
}
