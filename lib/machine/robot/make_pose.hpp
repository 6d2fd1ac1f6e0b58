// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/pose_settings.hpp"
#include "machine/robot/arm.hpp"

namespace millpose {

/// The pose that a job or cell states: R = Rz(A)·Ry(B)·Rx(C).
Pose MakePose(const PoseSettings& settings);

}  // namespace millpose
