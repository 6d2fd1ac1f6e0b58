// SPDX-License-Identifier: GPL-3.0-or-later
// What a report says of the arm's own geometry (docs/arm-deviations.md).
#pragma once

#include <optional>
#include <string>

namespace millpose {

/// By how much the cut points of the finished face are off along their normals, as the arm differs from its
/// sheet and its controller does not know. mm
struct GeometryFigures {
  double largest = 0;   ///< after the part's frame was measured with the arm all over the face
  double absolute = 0;  ///< with the frame taken from elsewhere
  std::string serial, date;
  bool taken_out = false;                  ///< the programs command poses for this arm
  std::optional<double> uncertainty = {};  ///< of what was taken out, 95 %
};

}  // namespace millpose
