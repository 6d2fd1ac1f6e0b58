// SPDX-License-Identifier: GPL-3.0-or-later
// What a tool path file means, written down by whoever wrote the file, and the comparison with what was read.
#pragma once

#include <string>
#include <vector>

#include "toolpath/cam/cam_path.hpp"

namespace millpose {

/// One motion that is meant. Positions mm, in the part's system.
struct Want {
  enum class Kind : uint8_t {
    kRapid,
    kStraight,  ///< points in between lie on the way
    kArc,       ///< points in between lie on the arc, every chord within the tolerance
    kCurve,     ///< every point lies on `curve`, in order, every chord within the tolerance
    kEnd,       ///< the end alone counts (a way that bends with the machine)
  };
  Kind kind = Kind::kStraight;
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< of the tool, at the end
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of an arc
  Eigen::Vector3d about = Eigen::Vector3d::UnitZ();  ///< unit vector, right-hand turn
  double angle = 0;                                  ///< of an arc, rad
  std::vector<Eigen::Vector3d> curve = {};           ///< dense, from the start to the end
  double feed = -1;                                  ///< mm/s; below 0: not stated
};

/// Empty, or the first difference between what was read and what is meant. `tolerance` of positions (mm) and
/// axes, `chord` of chords (mm).
std::string Difference(const CamPath& path, const std::vector<Want>& wants, double tolerance, double chord);

}  // namespace millpose
