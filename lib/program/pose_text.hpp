// SPDX-License-Identifier: GPL-3.0-or-later
// Poses as cells give them and heads of programs print them, whatever the controller's own angles are.
#pragma once

#include <optional>
#include <string>

#include "machine/robot/arm.hpp"

namespace millpose {

/// A pose as headers print it: "X 1.000 Y 2.000 Z 3.000, A 0.0000 B 90.0000 C 0.0000 (Z Y' X'')", angles
/// about Z, then the new Y, then the new X; mm, degrees.
std::string PoseText(const Pose& pose);
/// The pose that such a text states; empty when it is none.
std::optional<Pose> ReadPoseText(const std::string& text);

}  // namespace millpose
