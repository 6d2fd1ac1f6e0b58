// SPDX-License-Identifier: GPL-3.0-or-later
// What `millpose inspect` shows of an output folder.
#pragma once

#include <optional>
#include <string>

#include "report/points_table.hpp"
#include "report/step_heights.hpp"

namespace millpose {

struct InspectOptions {
  size_t worst = 10;            ///< how many of the softest points are listed
  std::optional<size_t> point;  ///< show this point in full
  std::optional<int> pass;      ///< look at this pass alone
};

/// The objective over the rotation about the tool axis at one point, for the plot.
struct RotationSample {
  double rotation = 0;   ///< rad
  int branch = 0;        ///< status bits S
  double objective = 0;  ///< of an admissible pose
};

/// What is told of the point asked for beyond its row.
struct PointStory {
  std::vector<RotationSample> curve;
  std::vector<std::string> reasons;  ///< why this pose, one sentence each (pose_reason.hpp)
  /// Where the cell says how well the tool is known; may be empty.
  std::optional<std::vector<PoseStep>> steps = std::nullopt;
};

/// Text for a terminal. `summary_json`: the folder's summary.json, `name`: its name for messages; `story`:
/// of the point asked for, may be empty. Throws InputError for a point or pass that is not there.
std::string InspectText(const PointsTable& points, const std::string& summary_json, const std::string& name,
                        const InspectOptions& options, const PointStory& story);

/// The same as JSON: summary, histogram, worst points, the point asked for.
std::string InspectJson(const PointsTable& points, const std::string& summary_json, const std::string& name,
                        const InspectOptions& options, const PointStory& story);

/// Throws InputError when the point or pass asked for is not in the table.
void CheckInspectOptions(const PointsTable& points, const InspectOptions& options);

/// Equal bins from the smallest to the largest objective.
struct Histogram {
  double lower = 0, width = 0;
  std::vector<size_t> counts;
};
Histogram ObjectiveHistogram(const PointsTable& points, const std::vector<size_t>& rows, size_t bins);

/// Planned rows of the pass asked for, or of all.
std::vector<size_t> PlannedRows(const PointsTable& points, const std::optional<int>& pass);
/// The `count` rows with the largest objective, largest first.
std::vector<size_t> WorstRows(const PointsTable& points, std::vector<size_t> rows, size_t count);

}  // namespace millpose
