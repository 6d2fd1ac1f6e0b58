// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "machine/collision/world.hpp"
#include "program/motion_program.hpp"
#include "program/post.hpp"

namespace millpose {

class ConfirmedRuns;

/// What kind of thing is wrong with a program: findings of one cause have one cure.
enum class Cause : uint8_t {
  kOther,
  kText,          ///< what its own reader refuses
  kPath,          ///< tip, axis or rotation leave the plan, points left out
  kFeed,          ///< of a cut, approach or retract
  kJointSpeed,    ///< faster than the arm can turn
  kCorner,        ///< rounded by too much, or passed too fast
  kStop,          ///< stands in the cut
  kReach,         ///< not reached, limits, configuration, singularity
  kWay,           ///< between cuts
  kInterference,  ///< or too near
  kSwitching      ///< spindle and outputs
};

/// Something that a program does and must not do.
struct Finding {
  std::string file;
  int line = 0;
  std::string message;  ///< what, by how much, with units
  Cause cause = Cause::kOther;
  size_t count = 1;  ///< findings that it stands for: more for the one that tells how many are not listed
};

/// Times its limit that a speed may come out at by the rounding of numbers in a program.
inline constexpr double kSpeedSlack = 1.001;

struct VerifyOptions {
  double position_tolerance = 0.02;        ///< mm; likewise of a rounded corner
  double angle_tolerance = 0.00034906585;  ///< rad (0.02°); likewise
  /// mm that a corner whose path the maker does not document may be bounded by (MotionProgram::
  /// corner_assumption), in place of position_tolerance.
  double max_corner = 0;
  double step = 0.5;                       ///< mm of tip travel between replayed poses
  Joints lower, upper;                     ///< limits, rad
  std::vector<CoupledLimit> coupled = {};  ///< likewise
  double swept_resolution = 0.5;           ///< mm
  /// mm by which the replay may leave the motion whose clearance was proven before it is checked again, and
  /// by which it may then fall short of that clearance.
  double clearance_reserve = 0.5;
  /// Share of the planned feed that a program may run. Above 1 because joint motions in inverse time have
  /// their mean speed right and swing about it by a percent where a wrist turns fast.
  double feed_least = 0.5, feed_most = 1.02;
  double spindle_tolerance = 1.0 / 60;  ///< rev/s
  /// rad: a joint motion outside cuts that leaves the plan's by more is a deviation.
  double gap_tolerance = 0.00087266;
  /// rad: one that leaves it by more is checked for interference again (0.1 mm at 4 m).
  double gap_proven = 2.5e-5;
  double jump_time = 0.1;     ///< s in which a joint must be able to change its speed at a rounded corner
  double feed_jump = 3;       ///< largest ratio of the feeds before and after a rounded corner
  double wrist_least = 0.01;  ///< |sin A5| in straight motions: below, the wrist axes race
  bool interference =
      false;  ///< check every motion, not only what leaves the plan's; always so without a plan
  /// Whose bodies are held apart: the world with the arm as it is, where the program is for that one.
  /// nullptr: the one that the controller computes with.
  const World* as_it_is = nullptr;
  size_t most_findings = 200;  ///< of each cause; the rest is counted
  /// With a plan: its program as written and read back, frames completed. What texts and hands put into the
  /// program (texts of the cell, calls, stops, waits, messages, tools) must then be what stands there.
  const MotionProgram* written = nullptr;
  /// Asked whether a cut was confirmed before, and told of those that are; nullptr: nobody is.
  ConfirmedRuns* confirmed = nullptr;
};

/// Replays `program` as its controller would (straight lines with interpolated orientation, joint motions,
/// inverse time, the envelope of rounded corners) through the arm and tool of `world` and says where it
/// leaves `plan`, where one is given: order and completeness of the points, tip, tool axis, rotation about
/// it, configuration, feed, exact stops, spindle, outputs; without one: jumps of the speed; always: reach,
/// limits, joint speeds, singularity, interference, bounds of corners that the maker does not document.
/// Detection rests on the replayed motion alone, not on the
/// text, so edits that change no motion pass. Empty = confirmed. Ordered by file and line.
std::vector<Finding> Verify(const MotionProgram& program, const World& world, const MotionProgram* plan,
                            const VerifyOptions& options, const Execution& execution);

}  // namespace millpose
