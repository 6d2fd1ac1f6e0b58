// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <set>

#include "toolpath/cam/gcode_block.hpp"

namespace millpose {

/// Variables of plain numbers: R parameters, names of DEF lines, names that begin with "_".
class GcodeVariables {
 public:
  /// Takes DEF and PROC lines and assignments; true when the block holds nothing else.
  bool Take(const GcodeBlock& block);
  bool IsAssignment(const GcodeWord& word) const;
  /// A word's number. Throws InputError for texts and for variables without a value.
  double ValueOf(const GcodeWord& word) const;
  /// A number or a variable's name as an argument of a cycle; empty for anything else.
  std::optional<double> ValueOf(std::string text) const;

 private:
  std::map<std::string, double> values_;
  std::set<std::string> defined_;
};

}  // namespace millpose
