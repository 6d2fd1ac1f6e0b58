// SPDX-License-Identifier: GPL-3.0-or-later
// Steps that the tool's own error can leave in the surface where the arm's pose changes (docs/lifts.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning/result/plan_result.hpp"

namespace millpose {

/// How well the tool is known.
struct ToolUncertainty {
  double tip = 0;     ///< of the tip in the flange, mm
  double axis = 0;    ///< of the tool axis in the flange, rad
  double radius = 0;  ///< of the cutter, mm
};

/// How far apart two cuts can come to lie, mm, when the tool has been turned about its axis by `rotation`
/// (rad) between them: the error e = tip + radius · axis turns with it, 2 sin(rotation / 2) e. In another
/// branch the arm's own error is another one as well, so that nothing cancels: 2 e.
double StepHeight(const ToolUncertainty& tool, double rotation, bool other_branch);

/// Two points that lie side by side and are cut in different poses. Numbers as in points.csv.
struct PoseStep {
  enum class Why : uint8_t { kLift, kSplit, kRing, kNeighbours };
  Why why = Why::kNeighbours;
  size_t point = 0, other = 0;
  int pass = 0, other_pass = 0;
  double rotation = 0;  ///< by which they differ, rad, 0..π
  bool other_branch = false;
  double height = 0;  ///< StepHeight, mm
};

/// lift | split | ring | neighbours
const char* Name(PoseStep::Why why);

struct PoseSteps {
  ToolUncertainty tool;
  std::vector<PoseStep> parts;         ///< where parts of a pass meet, and where rings left open begin
  std::optional<PoseStep> neighbours;  ///< the largest between passes whose cuts touch
};

/// Of planned cut points. Passes are neighbours where points lie within the cutter's diameter; only passes
/// from `finished_from` on count, which leave the finished face.
PoseSteps FindPoseSteps(const PlanResult& plan, const ToolUncertainty& tool, int finished_from = 0);

/// Those at one point, numbered as in points.csv: where its part meets another, and to its nearest point of
/// another pass.
std::vector<PoseStep> FindPoseStepsAt(const PlanResult& plan, const ToolUncertainty& tool, int finished_from,
                                      size_t point);

/// The worst of them in words; empty when there are none.
std::string Describe(const PoseSteps& steps);

}  // namespace millpose
