// SPDX-License-Identifier: GPL-3.0-or-later
// What a cell states of its own arm beside the maker's sheet: what was measured, by whom and how much it is.
#pragma once

#include <string>
#include <vector>

#include "job/config/cell_settings.hpp"

namespace millpose {

/// An arm's calibration, its gears and its springs, as a cell's owner would look them over.
struct MeasuredArm {
  ArmSettings arm;                              ///< as the cell has it
  std::vector<ComplianceSettings> compliances;  ///< beside the joints
  double largest_shift = 0, largest_turn = 0;   ///< of a frame in arm.deviations, mm and rad
  /// Of the flange at the cell's home, between where the arm has it and where its controller does, mm and
  /// rad.
  double home_shift = 0, home_turn = 0;
};

MeasuredArm DescribeMeasured(const CellSettings& settings);

/// "waves of A2 (2), A3 with A2": joints of which there are tables, with their number of waves, and
/// couplings; empty where there are none.
std::string MeasuredJoints(const DeviationSettings& deviations);

/// "882134, measured on 2026-11-26", of an arm with deviations.
std::string MeasuredName(const ArmSettings& arm);

/// One line for each row, with a label of 20 columns as `millpose check` has them.
std::string ToText(const MeasuredArm& measured);

}  // namespace millpose
