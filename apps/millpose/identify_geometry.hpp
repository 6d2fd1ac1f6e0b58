// SPDX-License-Identifier: GPL-3.0-or-later
// What `millpose identify --geometry` makes of a tracker's readings.
#pragma once

#include <string>
#include <vector>

#include "base/execution.hpp"

namespace millpose {

struct GeometryWords {
  std::vector<std::string> files;     ///< each read with the tracker in one place
  std::vector<std::string> foretell;  ///< readings that the fit does not see, to judge it by
  std::string cell, write_cell, serial, date;
  double shift_prior = 1, turn_prior = 3;  ///< mm, mrad
  int propose = -1;
  bool weight = false, json = false;
};

/// Returns the exit status. Throws InputError.
int IdentifyGeometry(const GeometryWords& words);

}  // namespace millpose
