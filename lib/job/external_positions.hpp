// SPDX-License-Identifier: GPL-3.0-or-later
// What a job says of its cell's external axes.
#pragma once

#include "job/config/config.hpp"
#include "machine/robot/mechanism.hpp"

namespace millpose {

/// Where an external axis may stand.
struct AxisPositions {
  std::vector<double> values;  ///< mm or rad, ascending; one where nothing is left to choose
  bool per_pass = false;       ///< each pass has its own; else the whole job has one
  bool continuous = false;     ///< with per_pass: and may go from one to another while a pass is milled
};

/// Of every axis of the cell. Precondition: CheckExternal() finds nothing.
std::vector<AxisPositions> PositionsOf(const JobSettings& job, const CellSettings& cell);

/// What is wrong with the job's `external` for this cell.
std::vector<Problem> CheckExternal(const JobSettings& job, const CellSettings& cell);

}  // namespace millpose
