// SPDX-License-Identifier: GPL-3.0-or-later
// The map that stands beside the paper's figure 3: dexterity over the vertical plane through axis 1.
#pragma once

#include <string>

namespace millpose {

/// What the page says about the map.
struct Figure3 {
  std::string svg;         ///< the picture
  double greatest = 0;     ///< D over the map, lengths in units of 1000 mm
  double in_mm = 0;        ///< the same pose's D with lengths in mm, as the paper prints it
  double yellow_from = 0;  ///< D at which the map's brightest three of ten bands begin
  size_t reached = 0, total = 0;
};
Figure3 DrawFigure3();

}  // namespace millpose
