// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "program/post.hpp"
#include "program/post_options.hpp"

namespace millpose {

/// Share of the distance between two points that the blends at both may take together.
inline constexpr double kBlendShare = 0.9;

/// Sets the blend radius of every corner of a cut, a distance: as large as its bound stays within the cell's
/// max_corner_mm (the settings' tolerance where it gives none) and their tolerance of the orientation, and no
/// two meet; in steps of the text's last digit. A corner without room for any stops. Ways stop at each of
/// their points.
void ChooseBlends(MotionProgram& program, const PostSettings& settings);

}  // namespace millpose
