// SPDX-License-Identifier: GPL-3.0-or-later
// What a drill strategy's options come to on a part: each hole with its depths.
#pragma once

#include "toolpath/strategies/drill.hpp"

namespace millpose {

/// A hole as it is drilled, P; lengths mm along the axis, heights over the entrance.
struct DrilledHole {
  Eigen::Vector3d entrance, axis;
  double depth = 0;   ///< of the tip
  double top = 0;     ///< height up to which the part reaches into the cutter's way
  double out = -1e9;  ///< height of the part's far side, where the cutter comes out of it
};

/// In the order given, or of the part's faces. Throws InputError for options out of range, for no hole of the
/// wanted diameter, for a cutter larger than the holes; `warnings`: what should be known.
std::vector<DrilledHole> HolesOf(const Drill& drill, const StrategyInputs& inputs,
                                 std::vector<std::string>& warnings);

/// The order of least way found from the first place on: always the nearest next, then stretches turned round
/// while that shortens the way (2-opt). No longer than the order as it was.
std::vector<size_t> ShortWay(const std::vector<Eigen::Vector3d>& places);

}  // namespace millpose
