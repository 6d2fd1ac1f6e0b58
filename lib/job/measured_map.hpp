// SPDX-License-Identifier: GPL-3.0-or-later
// The map of a measured part's error (docs/error-map.md): its file, and whether a plan may follow it.
#pragma once

#include "job/inputs.hpp"
#include "planning/compensation/compensate.hpp"

namespace millpose {

/// One planned point of the plan that the measured part was milled by.
struct MapRow {
  size_t point = 0;                                 ///< number in the plan
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< in P, mm
  Joints q = Joints::Zero();                        ///< rad, nominal
  double other = 0;                                 ///< mm along the normal, taken out for other reasons
  double amount = 0;                                ///< mm along the normal, to be taken out
  double sd = 0;                                    ///< mm, of the amount
};

/// The file: CSV, one row for each planned point.
std::string MapCsv(const std::vector<MapRow>& rows);

/// What the compensation of a point takes out along the normal for other reasons than the map, mm.
double OtherAlongNormal(const PlannedPoint& point);

/// The amounts of `compensation.map_csv` at a plan's points, mm. Throws InputError with the file's lines
/// where the plan is not the measured one: places farther off than 0.01 mm, joints than 0.1°, points without
/// a row.
PointAmounts ReadMap(const JobInputs& inputs, const PlanResult& plan);

/// Refuses a plan that takes out something else beside the map than the measured one did, by more than 1 µm:
/// then the map would take it out once more, or not. Throws InputError.
void CheckOthers(const JobInputs& inputs, const PlanResult& plan);

}  // namespace millpose
