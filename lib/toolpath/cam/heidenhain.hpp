// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/cam/gcode_motion.hpp"

namespace millpose {

/// What is different in Heidenhain's DIN/ISO: some G numbers and M codes, arcs about a pole that I, J, K set
/// in absolute coordinates and that stays.
class Heidenhain {
 public:
  Heidenhain(GcodeModes& modes, GcodeMotion& motion, GcodeMotion::ValueOf value_of)
      : modes_(modes), motion_(motion), value_of_(std::move(value_of)) {}

  /// True when the block is done with: no motion, or a datum shift. Throws InputError.
  bool TakeBlock(const GcodeBlock& block, const GcodeMove& empty);
  /// Throws InputError for G numbers that are not read; true when the number needs no further reading.
  bool TakeG(const GcodeWord& word) const;
  /// True when the M code is Heidenhain's own.
  bool TakeM(double m, const SourceLocation& place, GcodeMove& move);
  /// I, J, K of the block become the pole, which an arc without a radius turns about.
  void TakePole(GcodeMove& move);
  /// "MB50" of M140, "LA20" of M120.
  static bool IsHarmlessName(const std::string& name) {
    return name.starts_with("MB") || name.starts_with("LA");
  }

 private:
  void TakePreset(const GcodeBlock& block);

  GcodeModes& modes_;
  GcodeMotion& motion_;
  GcodeMotion::ValueOf value_of_;
  std::optional<std::string> preset_;    // of G247
  std::optional<Eigen::Vector3d> pole_;  // programmed coordinates
};

}  // namespace millpose
