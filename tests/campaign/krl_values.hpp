// SPDX-License-Identifier: GPL-3.0-or-later
// Values in KRL texts: aggregates, frames, a program's own variables ("Variables and declarations").
#pragma once

#include <initializer_list>

#include "tests/campaign/runner.hpp"

namespace millpose::campaign {

using Fields = std::map<std::string, double>;

/// {FRAME: X 1,Y 2}: a field once; `types` may stand before the colon.
Fields FieldsOf(Cursor& at, std::initializer_list<const char*> types);
/// Refusal for fields that are none of `letters`; `target`: S, T, E1 to E6 too.
void Allow(const Fields& fields, const std::string& letters, bool target);
/// Of X, Y, Z, A, B, C, all given.
Pose PoseOf(const Fields& fields);
/// A frame with all its fields, to the end of the line.
Pose FrameLiteral(Cursor& at);
/// Behind EK: the frame on a kinematic with which $BASE moves (KSS, "Mathematical coupling"; posts of CAM
/// systems); none where it is another than the second, or `coupled` says that there is none.
std::optional<Pose> MovingBase(Cursor& at, bool coupled);
/// What follows, numbers as numbers: texts that say the same are the same.
std::string Canonical(Cursor& at);

/// Variables that a program declares.
class KrlVariables {
 public:
  /// Behind DECL: "FRAME NAME", "KRLMSGPAR_T NAME[3]".
  void Declare(Cursor& at);
  /// A statement that gives one of them a value; false (and nothing taken) when it is none. Frames are
  /// computed, all else is for messages. `controllers`: $ROBROOT or $ERSYSROOT.
  bool Assign(Cursor& at, const Pose& controllers);
  /// Behind IF: (ABS(NAME.X)>0.01) OR (…) THEN.
  bool Holds(Cursor& at) const;

 private:
  Pose Term(Cursor& at, const Pose& controllers) const;

  std::map<std::string, std::string> types_;
  std::map<std::string, Pose> frames_;
};

}  // namespace millpose::campaign
