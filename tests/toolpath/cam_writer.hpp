// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "toolpath/milling_point.hpp"

namespace millpose {

/// A tool path as APT or CSV, positions and axes as they are (mm); each pass begins with a rapid to its first
/// point, a closed one returns to it. Positions with 6, axes with 9 decimals.
std::string WriteApt(const Toolpath& toolpath, const std::string& name);
std::string WriteCamCsv(const Toolpath& toolpath);

}  // namespace millpose
