// SPDX-License-Identifier: GPL-3.0-or-later
// report.html: a plan as one file that any browser opens without a network (docs/report-html.md).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "machine/collision/world.hpp"
#include "planning/result/cycle_time.hpp"
#include "planning/result/fixed_comparison.hpp"
#include "planning/result/plan_result.hpp"
#include "planning/result/stock_figures.hpp"
#include "planning/result/timeline.hpp"
#include "report/budget.hpp"
#include "report/deflection.hpp"
#include "report/face_report.hpp"
#include "report/lost_motion.hpp"
#include "report/words/words.hpp"
#include "toolpath/stock/removal.hpp"

namespace millpose {

/// How one point's pose was chosen, sampled for two plots: the objective over the rotation about the tool
/// axis, and the genetic algorithm's convergence. The rotations are first + i·step of the grid.
struct PointCurves {
  int pass = 0;   ///< index into PlanResult::passes
  int point = 0;  ///< index into its points
  std::vector<std::array<double, 8>>
      objective;  ///< per rotation and branch, unit of the objective; infinite where there is none
  std::vector<std::array<Infeasibility, 8>> state;  ///< of the pose, per rotation and branch
  std::vector<std::array<uint8_t, 8>> beyond;  ///< the joint farthest beyond its limits, 0…5, where one is
  std::vector<double> best, mean;              ///< per generation, unit of the objective
};

/// The same quantised, as the page draws it: 65534 steps from the least objective to what is drawn at the
/// upper edge.
struct PackedCurve {
  int pass = 0, point = 0;
  float least = 0, span = 0;     ///< unit of the objective
  std::vector<uint16_t> values;  ///< arm branch by arm branch, the better of both flips; 65535: none
  std::vector<uint16_t> states;  ///< per rotation, two bits a branch
  std::vector<double> best, mean;
};
std::vector<PackedCurve> Packed(const std::vector<PointCurves>& curves);

/// The rotations at which all PointCurves were sampled.
struct RotationGrid {
  double first = 0, step = 0;  ///< rad
  int count = 0;
};

/// What bars a pose or not: kOutOfReach, kSingularZone, beyond the limit of axis kLimitZone + 0…5, admissible
/// and not checked for interference, free of it, or kPairZone + p: pair p of AxisMap::pairs interferes.
enum AxisZone : uint8_t {
  kOutOfReach = 0,
  kSingularZone = 1,
  kLimitZone = 2,
  kUncheckedZone = 8,
  kFreeZone = 9,
  kPairZone = 10
};

/// The map of way along a pass and rotation: one entry per curve, on their rotations.
struct AxisMap {
  bool full = false;                        ///< everything admissible is checked
  std::vector<std::string> pairs;           ///< of bodies: "link4 and workpiece"
  std::vector<std::vector<uint8_t>> zones;  ///< per point: all rotations on branch 0, then on branch 1, …
};

/// Sizes to which the view is cut down; the plan itself is never changed, and the page says what is not
/// shown.
struct HtmlLimits {
  size_t points = 20000;  ///< shown in 3-D, charts and tables
  size_t workpiece_triangles = 60000;
  size_t body_triangles = 5000;  ///< per body of the cell
  size_t skipped_rows = 2000;    ///< of the table of skipped points
};

/// All that the page shows.
struct HtmlInput {
  const PlanResult& plan;
  const Cell& cell;  ///< its bodies, the workpiece among them, are drawn
  RotationGrid grid;
  std::vector<PackedCurve> curves;                ///< of all points or of some; by pass and point
  std::string settings;                           ///< job and cell as resolved, YAML
  const DeflectionReport* deflection = nullptr;   ///< when the job says what the cutter takes off
  std::vector<std::string> findings = {};         ///< what stands in the way of trust, one sentence each
  std::vector<std::string> warnings = {};         ///< repairs of the mesh, doubtful units
  std::vector<ControllerTime> times = {};         ///< of every program
  const FixedComparison* fixed = nullptr;         ///< beside the best fixed rotation
  const AxisMap* map = nullptr;                   ///< of `curves`
  const Timeline* timeline = nullptr;             ///< of the plan
  const LostMotionReport* lost_motion = nullptr;  ///< of the plan
  const Budget* budget = nullptr;                 ///< of the face's error
  const FaceReport* face = nullptr;               ///< where it was asked for
  const Removal* removal = nullptr;               ///< of the raw part, where there is one
  Language language = Language::kEnglish;         ///< in which it opens; its menu has all
  const StockFigures* stock = nullptr;            ///< what is milled off it
  std::string operation = {};                     ///< its name, the title where the job lists several

  const std::string& Title() const { return operation.empty() ? plan.job : operation; }
};

/// The page as bytes: a pure function of its input, no dates, no times.
std::string ReportHtml(const HtmlInput& input, const HtmlLimits& limits = {});

}  // namespace millpose
