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
  /// Of what was taken out, at the point of the face where it is least sure, along its normal, 95 %; in place
  /// of `uncertainty` where it is known.
  std::optional<double> left = {};
  /// By how much the tables of its joints' gears are off, likewise after the frame was measured; where they
  /// are taken out, what they leave between the points of the path; empty where nobody has measured any.
  std::optional<double> gears = {};
};

}  // namespace millpose
