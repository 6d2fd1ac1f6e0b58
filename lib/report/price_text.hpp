// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planning/result/price.hpp"

namespace millpose {

/// What the path costs against each point's own best pose and why, in a few lines.
std::vector<std::string> PriceLines(const Price& price);

}  // namespace millpose
