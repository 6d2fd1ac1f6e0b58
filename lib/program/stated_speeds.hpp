// SPDX-License-Identifier: GPL-3.0-or-later
// The speeds that a program states in its header, so that its text can be held to them without a plan.
#pragma once

#include <optional>
#include <span>

#include "program/motion_program.hpp"

namespace millpose {

/// Of motions with feed that follow each other: an approach, a cut, a retract.
struct FedMotion {
  double feed = 0, length = 0;  ///< mm/s, mm
  bool exact = false;
};

/// Largest feeds, mm/s, and how long approaches and retracts are at most, mm.
struct StatedFeeds {
  double cut = 0, approach = 0, retract = 0, length = 0;
};

/// Up to its first stop a run may be an approach, behind its last one before the end a retract: how many
/// motions each has; none where there is nothing between.
std::pair<size_t, size_t> ApproachAndRetract(std::span<const FedMotion> run);

/// Adds them to the header of a program as it is written.
void StateSpeeds(MotionProgram& program);
/// As a header states them; empty where it does not. The spindle: rev/s.
std::optional<double> StatedSpindle(const MotionProgram& program);
std::optional<StatedFeeds> StatedFeedsOf(const MotionProgram& program);

}  // namespace millpose
