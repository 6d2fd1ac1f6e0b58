// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/error.hpp"
#include "job/config/cell_settings.hpp"

namespace millpose {

/// How every controller of the cell counts the arm's axes: fills `axis_signs` and `axis_offsets` where the
/// cell does not state them. A controller whose maker fixes the zero (Post::OwnZero) gets what the arm's
/// geometry gives, with a note where that is not the arm's own count; any other the arm's own count, unless
/// the arm is `from_urdf`, whose zero nobody has stated for it. Problems name the keys: both missing where
/// they are needed, and a wrist or an upper arm whose zero the geometry does not tell. The arm must be
/// resolved. What is stated against the maker's zero is a warning.
std::vector<Problem> SettleControllerZeros(bool from_urdf, CellSettings* cell);

/// "upper arm upright, forearm level, hand level": the arm where all its own angles are 0.
std::string DescribeZero(const Arm& arm);

}  // namespace millpose
