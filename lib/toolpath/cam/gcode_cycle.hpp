// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "toolpath/cam/drilling.hpp"
#include "toolpath/cam/gcode_motion.hpp"
#include "toolpath/cam/gcode_variables.hpp"

namespace millpose {

/// The canned cycles G73 to G89 with G98 and G99: modal from their G word to G80 or G0 to G3.
class GcodeCycles {
 public:
  GcodeCycles(const GcodeModes& modes, GcodeMotion& motion) : modes_(modes), motion_(motion) {}

  static bool IsCycle(double g);
  /// G73 to G89, G80, G98, G99; false for other numbers.
  bool TakeG(double g);
  void End() { active_.reset(); }
  bool active() const { return active_.has_value(); }
  /// A block while a cycle is in force: takes over its R, depth and Q, and goes to each of its holes. Throws
  /// InputError.
  void Run(const GcodeMove& move, const GcodeMotion::ValueOf& value_of);

 private:
  void TakeHeights(const GcodeMove& move, const GcodeMotion::ValueOf& value_of);
  GcodeHole Hole(const GcodeMove& move) const;

  const GcodeModes& modes_;
  GcodeMotion& motion_;
  std::optional<double> active_;  // the G number
  bool returns_to_initial_ = true;
  double initial_ = 0;                               // height where the cycle was switched on
  std::optional<double> clearance_, bottom_, peck_;  // mm, of the programmed frame
};

/// CYCLE81, CYCLE82 and CYCLE83 of SINUMERIK, called once or by MCALL behind each motion, and the cycles
/// whose holes are left out.
class SinumerikCycles {
 public:
  SinumerikCycles(const GcodeModes& modes, GcodeMotion& motion, const GcodeVariables& variables)
      : modes_(modes), motion_(motion), variables_(variables) {}

  static bool IsCycle(std::string_view name);
  /// A call in this block; with `modal` (MCALL) the hole comes behind every further motion.
  void Call(const GcodeWord& call, bool modal);
  void EndModal() { modal_.reset(); }
  bool modal() const { return modal_.has_value(); }
  /// The hole of the modal cycle where the tool stands.
  void RunModal(const SourceLocation& place);

 private:
  class Arguments;
  GcodeHole Read(const GcodeWord& call) const;
  void ReadHeights(const Arguments& arguments, GcodeHole& hole) const;
  void ReadStrokes(const Arguments& arguments, GcodeHole& hole, double reference) const;

  const GcodeModes& modes_;
  GcodeMotion& motion_;
  const GcodeVariables& variables_;
  std::optional<GcodeHole> modal_;
};

}  // namespace millpose
