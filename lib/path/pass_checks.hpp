// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>

#include "cell/world.hpp"
#include "motion/line.hpp"
#include "path/lean_gouges.hpp"

namespace millpose {

/// By what the poses of a pass and the motions between them are checked.
struct PassChecks {
  const World& world;
  Carrier carrier;
  double swept_resolution;  ///< mm
  bool rotates_first;  ///< the first freedom is the rotation about the tool axis, as PointMemory needs it
  int threads;
  std::stop_token stop;
  LeanGouges gouges = {};
};

/// Runs `work(checker, i)` for i in 0..count−1 in parallel with a few checkers.
CheckCounts CheckInParallel(const World& world, size_t count, int threads, std::stop_token stop,
                            const std::function<void(Checker&, size_t)>& work);

/// One line: which two bodies, how near, where.
std::string Describe(const Interference& interference);

}  // namespace millpose
