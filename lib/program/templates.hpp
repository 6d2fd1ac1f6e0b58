// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that a cell gives for events: written with their values filled in, recognised when read back.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "program/motion_program.hpp"

namespace millpose {

/// The texts of one controller: its defaults, overridden by the cell's.
class Templates {
 public:
  Templates(std::map<std::string, std::string> defaults, const std::map<std::string, std::string>& overrides);

  /// The lines of spindle_on or spindle_off, with {rpm} (rev/min) filled in.
  std::vector<std::string> Lines(const ProgramEvent& event) const;

  struct Match {
    ProgramEvent::Kind kind;
    double value = 0;  ///< spindle speed, rev/s
    size_t lines = 0;  ///< how many lines the text takes
  };
  /// The spindle event that begins at lines[first], when one does. Words compare without case and white
  /// space.
  std::optional<Match> Recognise(const std::vector<std::string_view>& lines, size_t first) const;

 private:
  std::vector<std::string> on_, off_;
};

}  // namespace millpose
