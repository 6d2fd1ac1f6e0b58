// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "machine/robot/axis_convention.hpp"

namespace millpose {

/// confdata [cf1, cf4, cf6, cfx] of a serial arm with a spherical wrist: the quarter turns that the
/// controller's axes 1, 4 and 6 stand in (0: 0°…90°, −1: −90°…0°), and which of the eight inverse solutions:
/// 1 where A5 < 0, 2 where the wrist centre is behind the lower arm, 4 where it is behind axis 1. RAPID
/// reference, data type confdata.
using RapidConfiguration = std::array<int, 4>;

RapidConfiguration RapidConfigurationOf(const Arm& arm, const AxisConvention& axes, const Joints& q);

/// Whether it is that of `q`; where an axis stands within 0.001° of the border of two quarters, or A5 of 0,
/// both are right: a num cannot tell them.
bool FitsRapidConfiguration(const RapidConfiguration& given, const Arm& arm, const AxisConvention& axes,
                            const Joints& q);

/// "[0,-1,1,0]".
std::string RapidConfigurationText(const RapidConfiguration& configuration);

}  // namespace millpose
