// SPDX-License-Identifier: GPL-3.0-or-later
// Other cutters in the text of a first cell.
#pragma once

#include <string>
#include <vector>

#include "toolpath/cam/cam_source.hpp"

namespace millpose {

/// The cell with a ball for its flat cutter.
std::string WithBall(std::string cell);

/// The cell with the cutters that a CAM file's sections name in place of its own: one, or a list of tools
/// with a pose to change them at.
std::string WithCutters(const std::string& cell, const std::vector<CamSection>& sections);

}  // namespace millpose
