// SPDX-License-Identifier: GPL-3.0-or-later
// What a tool path comes to, looked at before the work: a slip in a length must not fill memory.
#pragma once

#include <string>

#include "toolpath/region.hpp"

namespace millpose {

struct ToolpathOptions;

/// Points that a tool path may have.
struct PointBudget {
  double most = 2e6;
  std::string set_by = "--max-points";  ///< what the bound comes from, for messages
  std::string unit_doubt;  ///< what is odd about the part's size; named first when it is too large
};

/// Area of a part of a region's face that lies inside, mm²; of faces on a border to a few percent.
double AreaInside(const Region& region, const Region::Patch& patch);

/// A tool path in numbers. Counts are real numbers, since what is asked for may exceed any integer.
struct PathCount {
  double passes = 0;   ///< of one layer
  double way = 0;      ///< of one layer's passes together, mm
  double covered = 0;  ///< points of one layer at least, where they are known already
};

/// Throws InputError when the path would have more points than the budget allows: names the key that asks for
/// most of them.
void CheckBudget(const ToolpathOptions& options, const PathCount& count);

}  // namespace millpose
