// SPDX-License-Identifier: GPL-3.0-or-later
// Eight stretches of a swept path at once: which of them may have taken a place off.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>

#include "base/lanes.hpp"

namespace millpose {

/// Consecutive motions of a cutter: their tips lie within `off` of the straight line from `from` on along
/// `way`, their axes differ from `axis`, a unit vector from tip to holder, by at most `lean` (length of the
/// difference). In P, mm.
struct SweptBar {
  Eigen::Vector3d from, way, axis;
  double off = 0, lean = 0;
};

/// Up to kLanes of them by lane; lanes that are not set take nothing.
struct StretchBlock {
  Lanes from[3] = {}, way[3] = {}, axis[3] = {};
  Lanes share_along[3] = {};  ///< what lies beyond `from`, times this, is the share of the way
  Lanes off = {}, lean = {};
  Lanes lowest;  ///< mm along the normal that is asked with: nothing lower can be taken

  StretchBlock() {
    for (double& low : lowest.v) low = std::numeric_limits<double>::infinity();
  }
  void Set(int lane, const SweptBar& bar, double lowest_height);
};

/// Bit `lane` is set where the lane's stretch may have taken `place` off, which lies `height` mm along the
/// normal: none of its motions can where all of them run farther beside the place than `radius` (mm, of the
/// cutter), or too high above it.
uint32_t TakersIn(const StretchBlock& block, const Eigen::Vector3d& place, double height, double radius);

}  // namespace millpose
