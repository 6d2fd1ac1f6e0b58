// SPDX-License-Identifier: GPL-3.0-or-later
// A program of a cell whose texts call programs of the plant, switch and mark, as lines that a test changes.
#pragma once

#include "machine/collision/world.hpp"
#include "program/post.hpp"
#include "program/verify/verify.hpp"

namespace millpose {

class PlantProgram {
 public:
  /// `controller`: krl, sinumerik, linuxcnc; `spindle`: the cell has texts that switch it.
  explicit PlantProgram(const std::string& controller, bool spindle = true);

  /// A call as the controller makes it: "SUCTION (0)", "SUCTION(0)", "O<SUCTION> CALL [0]".
  std::string Call(const std::string& name, int argument) const;
  std::string Stop() const;                      ///< HALT, M0
  std::string Dwell() const;                     ///< of half a second
  std::string Mark(bool begin, int pass) const;  ///< as a line
  /// The index of the nth line that holds `part`.
  size_t Find(const std::string& part, int nth = 0) const;
  void Insert(size_t i, const std::string& line) { lines.insert(lines.begin() + static_cast<long>(i), line); }
  void Erase(size_t i) { lines.erase(lines.begin() + static_cast<long>(i)); }

  /// What is said of the lines against the plan, or alone: "line: message", one behind the other.
  std::string AgainstThePlan() const;
  std::string Alone() const;
  std::string Scope() const;

  std::string controller;
  std::vector<std::string> lines;

 private:
  MotionProgram Read(const std::vector<std::string>& lines) const;

  PlanResult plan_;
  PostSettings settings_;
  std::unique_ptr<Post> post_;
  MotionProgram planned_;
  ProgramFiles files_;
  std::unique_ptr<World> world_;
};

}  // namespace millpose
