// SPDX-License-Identifier: GPL-3.0-or-later
// The sections of an LS file: /PROG, /ATTR, /MN, /POS. Positions are read before any statement.
#pragma once

#include <map>

#include "base/error.hpp"
#include "program/fanuc/fanuc_options.hpp"

namespace millpose {

/// P[n] of a file.
struct FanucPosition {
  int line = 0;
  bool joints = false;
  std::array<double, 6> numbers{};         ///< X, Y, Z, W, P, R or J1…J6; mm, degrees
  FanucConfig config;                      ///< where it is no joint position
  std::map<std::string, double> external;  ///< by the cell's names of the axes; mm or degrees
};
using FanucPositions = std::map<int, FanucPosition>;

/// What is read of a file before its statements.
struct FanucFile {
  /// As many lines as the file has: statements at their own columns, without number and ';', "/END", and
  /// nothing else.
  std::string statements;
  FanucPositions positions;
};

/// Adds every problem with the sections around the statements. `stem`: the file's name without its ending.
FanucFile ReadFanucFile(const std::string& file, const std::string& stem, const std::string& text,
                        const PostSettings& settings, const FanucOptions& options,
                        std::vector<Problem>& problems);

/// The lines of P[number] under /POS.
std::string FanucPositionText(int number, const FanucPosition& position, const PostSettings& settings,
                              const FanucOptions& options);

/// What stands before the statements of a program, "{name}" being its name.
std::string FanucHead(const std::string& groups);

}  // namespace millpose
