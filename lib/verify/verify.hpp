// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "cell/world.hpp"
#include "program/motion_program.hpp"
#include "program/post.hpp"

namespace millpose {

/// Something that a program does and must not do.
struct Finding {
  std::string file;
  int line = 0;
  std::string message;  ///< what, by how much, with units
};

struct VerifyOptions {
  double position_tolerance = 0.02;        ///< mm
  double angle_tolerance = 0.00034906585;  ///< rad (0.02°)
  double step = 0.5;                       ///< mm of tip travel between replayed poses
  Joints lower, upper;                     ///< limits, rad
  double swept_resolution = 0.5;           ///< mm
};

/// Replays `program` as its controller would and compares it with `plan` where one is given: order and count
/// of points, tip, axis, rotation, configuration, feed, limits, interference. Empty = confirmed.
std::vector<Finding> Verify(const MotionProgram& program, const World& world, const MotionProgram* plan,
                            const VerifyOptions& options, int threads, std::stop_token stop);

}  // namespace millpose
