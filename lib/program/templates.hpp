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

/// The texts of one controller: its defaults, overridden by the cell's. Their names:
///   header       after the settings               footer       before the end
///   tool_change  after the header (SINUMERIK: before the frames), or where the tool is changed; {tool},
///   {number} spindle_on   {rpm}; followed by coolant_on    spindle_off  preceded by coolant_off
///   cartesian_on, joints_on   Cartesian LinuxCNC: switches its kinematics before and after a cut
///   pass_begin   {pass} {piece}, after the mark   pass_end     likewise
/// Lines compare without case and amount of white space; blank lines may stand between them.
class Templates {
 public:
  /// What fills {tool} and {number}.
  struct Tool {
    std::string name;
    std::optional<int> number;
    std::string check = {};  ///< lines behind tool_change that wait until it is in the spindle
    bool held = false;       ///< tool_change is the check alone, if not another text of its own
  };
  /// What counts for nothing where texts are compared.
  struct Spelling {
    bool numbers = true;  ///< "N10 " may stand before a line of a text
    bool blanks =
        true;  ///< blanks part words; without it they mean nothing, as zeros before a number (RS-274)
  };
  Templates(std::map<std::string, std::string> defaults, const std::map<std::string, std::string>& overrides,
            const Tool& tool, Spelling spelling = {true, true});

  /// All names that texts may have.
  static const std::vector<std::string>& Names();

  /// The text that belongs to an event; empty where none does.
  static std::string NameOf(ProgramEvent::Kind kind);
  /// The lines of an event, values filled in.
  std::vector<std::string> Lines(const ProgramEvent& event) const;
  /// The lines of header, footer or tool_change.
  const std::vector<std::string>& Lines(const std::string& name) const;

  struct Match {
    ProgramEvent::Kind kind;
    double value = 0;  ///< spindle speed, rev/s
    size_t lines = 0;  ///< how many lines the text takes
  };
  /// The spindle event that begins at lines[first], when one does.
  std::optional<Match> Recognise(const std::vector<std::string_view>& lines, size_t first) const;
  /// How many lines from `first` on are the text `name`; 0 when they are not (or the text is empty).
  size_t Recognise(const std::string& name, const std::vector<std::string_view>& lines, size_t first) const;

  /// Likewise of a text about a piece of a pass: with their numbers where it has holes for them.
  size_t Recognise(const std::string& name, const std::vector<std::string_view>& lines, size_t first,
                   double pass, double piece) const;

  /// The numbers that a text's lines have in place of its holes.
  struct Filled {
    std::vector<double> rpm, pass, piece;
  };

  /// How many of the `count` lines from `first` on, which are the text tool_change, stand before its check.
  size_t BeforeCheck(const std::vector<std::string_view>& lines, size_t first, size_t count) const;

  /// Whether the text `name` holds the call of one of `calls`; `moving`: of one that moves the arm.
  bool Calls(const std::string& name, const std::vector<DeclaredCall>& calls, bool moving) const;
  /// A text with values such as every program has in place of its holes, line by line.
  static std::string WithSamples(std::string text, const Tool& tool);

 private:
  std::string Spelled(std::string_view line) const;
  size_t MatchAll(const std::string& name, const std::vector<std::string_view>& lines, size_t first,
                  Filled& filled) const;

  std::map<std::string, std::vector<std::string>> texts_;
  size_t check_lines_ = 0;  // of tool_change, its last
  Spelling spelling_;
};

}  // namespace millpose
