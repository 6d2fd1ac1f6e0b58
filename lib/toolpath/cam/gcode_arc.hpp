// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// An arc (or helix) of G2 or G3 in programmed coordinates, mm.
struct GcodeArc {
  Eigen::Vector3d from, to;
  int plane = 0;                                ///< 0, 1, 2: G17, G18, G19
  bool counter_clockwise = false;               ///< G3
  std::array<std::optional<double>, 3> centre;  ///< I, J, K
  std::array<bool, 3> absolute{};               ///< whether that is a place, else a step from the start
  std::optional<double> radius;                 ///< R, CR; negative: the longer arc. Goes before the centre
  double full_turns = 0;                        ///< TURN
  SourceLocation place;                         ///< for messages
};

/// Points after `from` up to and with `to`, chords deviating by at most `tolerance`. Throws InputError when
/// centre or radius are missing or do not fit the ends.
std::vector<Eigen::Vector3d> PointsOf(const GcodeArc& arc, double tolerance);

}  // namespace millpose
