// SPDX-License-Identifier: GPL-3.0-or-later
// A robot program free of any controller's syntax: what posts write and readers return.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plan/plan_result.hpp"

namespace millpose {

enum class MotionType : uint8_t { kJoint, kLinear };  ///< PTP (all axes together) or LIN (tip on a line)

/// One motion to a target.
struct Motion {
  MotionType type = MotionType::kJoint;
  Pose X_PT = Pose::Identity();  ///< target, tool in the workpiece frame
  std::optional<Joints> q;  ///< target angles, rad; always known when written, only if programmed when read
  std::optional<int> status, turn;  ///< S and T, where programmed
  double feed = 0;                  ///< mm/s of the tip, LIN only
  bool exact = false;               ///< exact stop (no blending)
  int pass = -1, point = -1;        ///< which milling point; −1 for gaps
  int line = 0;                     ///< of the program text, when read
};

/// What happens before a motion: spindle, marks.
struct ProgramEvent {
  enum class Kind : uint8_t { kSpindleOn, kSpindleOff, kPassBegin, kPassEnd } kind;
  size_t before_motion = 0;  ///< index into motions; motions.size() for the end
  double value = 0;          ///< spindle speed rev/s, or pass number
  int line = 0;              ///< of the program text, when read
};

struct MotionProgram {
  std::string name;
  Pose X_BP = Pose::Identity();  ///< workpiece (base) frame in the robot's base
  Pose X_FT = Pose::Identity();  ///< tool in the flange
  std::vector<Motion> motions;
  std::vector<ProgramEvent> events;
};

/// The motions of a plan in order: PTP home, gaps as PTP, approaches, cuts and retracts as LIN.
MotionProgram MakeMotionProgram(const PlanResult& plan);

}  // namespace millpose
