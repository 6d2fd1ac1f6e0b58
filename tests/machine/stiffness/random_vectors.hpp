// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>

#include "base/random.hpp"

namespace millpose {

/// Each coordinate normal with standard deviation 1.
inline Eigen::Vector3d RandomNormal3(RandomStream& stream) {
  return {stream.Normal(), stream.Normal(), stream.Normal()};
}

inline Eigen::Vector3d RandomUnit(RandomStream& stream) { return RandomNormal3(stream).normalized(); }

}  // namespace millpose
