// SPDX-License-Identifier: GPL-3.0-or-later
// A plan of a bent vertical panel in front of a KR 500 R2830, in zigzag: real poses and curves, found point
// by point with the pose module, without the ladder search.
#pragma once

#include "machine/collision/cell.hpp"
#include "planning/pose/search.hpp"
#include "report/html.hpp"

namespace millpose {

struct PanelSize {
  int passes = 8, points = 20;       ///< per pass
  double width = 900, height = 900;  ///< mm
};

/// The panel's plan with its cell, problem and curves. Every pass begins and ends with a lead, every tenth
/// point of the last one is skipped, the second gap is not planned, and a stripe of interference runs through
/// the axis map of every pass.
struct Panel {
  PlanResult plan;
  Cell cell;
  PoseProblem problem;
  std::vector<PointCurves> curves;
  AxisMap map;
  Timeline timeline;
  std::string settings;

  HtmlInput Input() const;
};
Panel MakePanel(const PanelSize& size, const std::string& job = "panel");

}  // namespace millpose
