// SPDX-License-Identifier: GPL-3.0-or-later
// Tables 4, 5 and 6, equation 36: poses and the optimum.
#include "base/trig.hpp"
#include "planning/pose/paper_formulation.hpp"
#include "tests/paper/page.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {
using Eigen::Vector3d;

void Table4() {
  Write("## Table 4: two poses of the milling test\n");
  Write("Table 1's arm, stiffness at the bare flange, n = flange x.\n");
  Write(
      "| pose | lambda_t1 | lambda_t2 | mu | paper: lambda_t2 | paper: mu | along n under 100 N, um | paper: "
      "flatness, mm |\n|---|---|---|---|---|---|---|---|");
  const Arm arm = KrQuantecR2700();
  const char* paper[2][3] = {{"2.37", "0.9985", "0.21"}, {"5.67", "0.9928", "0.34"}};
  for (int k = 0; k < 2; ++k) {
    const PoseIndices at = IndicesAt(arm, kTable4[k], Vector3d::Zero(), Vector3d::UnitX());
    Write("| {} | {:.3f} | {:.3f} | {:.4f} | {} | {} | {:.1f} | {} |", k + 1, 1e4 * at.plane.lambda_t1,
          1e4 * at.plane.lambda_t2, at.plane.mu, paper[k][0], paper[k][1], 1e5 * at.moved.normal,
          paper[k][2]);
  }
  Write(
      "\n**Order only**: pose 1's lambda_t2 is near the paper's, pose 2's is near our lambda_t1. The paper's "
      "mu **cannot be** had");
  Write(
      "from these ellipses. Pose 1, with the flatter face, is the softer along n: what made it flatter is "
      "not "
      "its stiffness");
  Write("along the normal.\n");
}

void Table5() {
  Write("## Table 5 and equations 30, 31: bounds\n");
  Write(
      "Equation 31 gives joint 3 the wrong sign, -120 .. -38 deg: every listed pose and table 5 say {:.0f} "
      ".. "
      "{:.0f} deg. The other",
      RadToDeg(kTable5[0][2]), RadToDeg(kTable5[1][2]));
  Write("five joints agree. millpose uses table 5.\n");
}

void Table6() {
  Write("## Table 6: five redundant poses\n");
  Write(
      "Poses of one tip and one tool axis must agree on both. For each arm the tool that closes them "
      "best:\n");
  Write("| arm | spread of the axes, deg | tips, mm RMS |\n|---|---|---|");
  const auto row = [&](const char* name, const Arm& arm) {
    const Closure closure = Close(arm);
    Write("| {} | {:.3f} | {:.2f} |", name, closure.axis_spread_deg, closure.tip_rms);
  };
  Arm reversed_table1 = KrQuantecR2700(), reversed_r2800 = Kr500R2800();
  reversed_table1.sign = reversed_r2800.sign = Chen2021Table6().sign;
  row("KR 500 R2830, KUKA's signs", Kr500R2830());
  row("KR 500 R2830, A6 reversed (`chen2021_table6`)", Chen2021Table6());
  row("table 1, A6 reversed", reversed_table1);
  row("KR 500 R2800-2, A6 reversed", reversed_r2800);
  const Closure closure = Close(Chen2021Table6());
  Write(
      "\n**Reproduced** by the R2830 with A6 turning the other way: axis ({:.4f}, {:.4f}, {:.4f}) in the "
      "flange, from tip to holder.",
      closure.axis.x(), closure.axis.y(), closure.axis.z());
  Write("A KUKA controller needs KUKA's own signs, so this arm serves reproduction only.\n");
  const PaperCase paper = MakePaperCase();
  const PointScorer scorer(paper.problem, paper.point, Vector3d::UnitZ());
  std::string differences;
  for (int k = 0; k < 5; ++k) {
    PaperResult answer;
    answer.q = kTable6[k];
    answer.within_tolerance = true;
    const PointOptimum exact = OnExactPose(scorer, answer);
    differences +=
        fmt::format("{}{:.3f}", k == 0 ? "" : ", ", RadToDeg((exact.q - kTable6[k]).cwiseAbs().maxCoeff()));
  }
  Write(
      "Solved exactly for pose 1's tip and axis at each pose's own rotation, the joints differ from the "
      "paper's by at most");
  Write("{} deg, pose by pose.\n", differences);
  Write(
      "Stiffness at the tool tip (the closures' tool, tip 250 mm before the flange along its axis), and f at "
      "the flange centre:\n");
  Write(
      "| pose | lambda_t1 | lambda_t2 | lambda_n | n'cn | f = 0.5 lambda_t2 + 0.5 lambda_n | f, flange "
      "|\n|---|---|---|---|---|---|---|");
  for (int k = 0; k < 5; ++k) {
    const PoseIndices at = IndicesAt(Chen2021Table6(), kTable6[k], kTip, kToolAxis);
    const PoseIndices flange = IndicesAt(Chen2021Table6(), kTable6[k], Vector3d::Zero(), kToolAxis);
    Write("| {} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} |", k + 1, 1e4 * at.plane.lambda_t1,
          1e4 * at.plane.lambda_t2, 1e4 * at.plane.lambda_n, 1e4 * at.moved.normal, 1e4 * at.f,
          1e4 * flange.f);
  }
  Write(
      "\nAt the tip f rises from pose 1 to pose 5 as the paper says, at the flange it falls: millpose "
      "evaluates at the tip.\n");
}

void Equation36() {
  Write("## Equation 36: the optimum\n");
  const PaperCase paper = MakePaperCase();
  const PointScorer scorer(paper.problem, paper.point, Vector3d::UnitZ());
  const PointOptimum best = ExhaustiveSearch(scorer, DegToRad(0.25));
  const double f1 = IndicesAt(Chen2021Table6(), kTable6[0], kTip, kToolAxis).f;
  Write(
      "Exhaustive search over the rotation about the tool axis (0.25 deg, all branches, table 5) at pose 1's "
      "tip and axis:\n");
  Write("| | f | A1 .. A6, deg |\n|---|---|---|");
  const auto row = [&](const char* name, double f, const Joints& q) {
    Write("| {} | {:.4f} | {:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f} |", name, 1e4 * f, RadToDeg(q[0]),
          RadToDeg(q[1]), RadToDeg(q[2]), RadToDeg(q[3]), RadToDeg(q[4]), RadToDeg(q[5]));
  };
  row("exhaustive optimum", best.objective, best.q);
  row("equation 36 (pose 1)", f1, kTable6[0]);
  Write(
      "\nPose 1 is {:.2f} % above the optimum. **Reproduced** with stiffness at the tool tip and the tool "
      "length above.\n",
      100 * (f1 / best.objective - 1));
  const PaperTarget target = MakePaperTarget(paper.problem, paper.point);
  const PaperFormulationOptions options;
  constexpr int kRuns = 10;
  int met = 0, evaluations = 0;
  std::vector<double> position, angle, gap;
  for (int run = 0; run < kRuns; ++run) {
    const PaperResult found = PaperSearch(paper.problem, target, options, RandomStream(1, run));
    evaluations = found.evaluations;
    met += found.within_tolerance;
    position.push_back(found.position_error);
    angle.push_back(RadToDeg(found.angle_error));
    if (found.within_tolerance) gap.push_back(100 * (found.objective / best.objective - 1));
  }
  std::sort(position.begin(), position.end());
  std::sort(angle.begin(), angle.end());
  std::sort(gap.begin(), gap.end());
  Write(
      "The paper's own formulation (six angles, equations 29-35; population {}, {} generations, c_max {} "
      "mm/N, penalty "
      "{} mm/N per",
      options.population, options.generations, options.c_max, options.penalty);
  Write(
      "squared tolerance, all chosen here since the paper gives none), {} runs: {} meet 0.1 mm and 0.1 deg; "
      "position",
      kRuns, met);
  Write("error median {:.3f} mm, worst {:.3f} mm; angle error median {:.3f} deg, worst {:.3f} deg.",
        position[kRuns / 2], position.back(), angle[kRuns / 2], angle.back());
  if (!gap.empty())
    Write(
        "f of those that meet them, against the exhaustive optimum: {:+.2f} % .. {:+.2f} %, median {:+.2f} "
        "%.",
        gap.front(), gap.back(), gap[gap.size() / 2]);
  Write("Each run takes {} evaluations. `pose.formulation: paper` plans with the paper's own", evaluations);
  Write("([genetic-algorithm.md](genetic-algorithm.md)).\n");
}

}  // namespace millpose
