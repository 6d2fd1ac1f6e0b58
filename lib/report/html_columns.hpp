// SPDX-License-Identifier: GPL-3.0-or-later
// What report.html shows along the path: the columns, and which points it shows.
#pragma once

#include <string>
#include <vector>

#include "planning/result/plan_result.hpp"
#include "report/deflection.hpp"
#include "report/lost_motion.hpp"

namespace millpose {

/// Which end of a column's values a process engineer worries about.
enum class Worse : int8_t { kLow = -1, kNeither = 0, kHigh = 1 };

/// One figure of every point, in the unit that the page shows. NaN where a point has none.
struct ReportColumn {
  std::string key, symbol, label, unit;
  Worse worse = Worse::kNeither;
  std::vector<float> values;
  std::optional<double> bound = {};  ///< a value that means "at least that"
};

/// A point by its place in the plan. `number` counts all points of the job from 0, as in points.csv.
struct ReportRow {
  int pass = 0, point = 0;
  uint32_t number = 0;
};

/// All columns of a plan, one value per point of the job in order; those of the deflection and of reversals
/// where they are given.
std::vector<ReportColumn> ReportColumns(const PlanResult& plan, const DeflectionReport* deflection = nullptr,
                                        const LostMotionReport* lost_motion = nullptr);

/// The points to show: all of them, or, where there are more than `limit`, every k-th of a pass with the ends
/// of its pieces and the worst points of every column.
std::vector<ReportRow> RowsToShow(const PlanResult& plan, const std::vector<ReportColumn>& columns,
                                  size_t limit);

/// Between compliances and lengths as computed (mm/N, mm) and as shown (µm/N, µm); other units stay.
std::string ShownUnit(const std::string& unit);
double ShownScale(const std::string& unit);

}  // namespace millpose
