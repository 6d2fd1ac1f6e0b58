// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "toolpath/cam/gcode_block.hpp"
#include "toolpath/cam/gcode_frame.hpp"
#include "toolpath/cam/gcode_path.hpp"
#include "toolpath/cam/section_tracker.hpp"

namespace millpose {

/// What G words leave in force.
struct GcodeModes {
  int motion = 0;      ///< G0 to G3
  int plane = 0;       ///< of arcs: 0 to 2 for G17 to G19
  int feed_mode = 94;  ///< G93, G94, G95
  bool incremental = false, absolute_centre = false, inch = false, inch_feed = false;
  bool unit_stated = false;         ///< by a G word of the file
  int unit_taken = 0;               ///< line of the first length that was read before one; 0: none
  bool vector_in_ijk = false;       ///< G43.5: I, J, K are the tool's vector
  std::optional<double> feed_word;  ///< the last F
  double feed = 0, inverse_time = 0, revolutions = 0;  ///< mm/s, 1/s of the next motion, 1/s

  double Unit() const { return inch ? 25.4 : 1; }  ///< mm
  /// G numbers of motion, plane, units, steps and feed; false for others.
  bool TakeG(double g);
  /// Makes the feed of the word and the mode.
  void SetFeed();
};

/// What stands in one block besides modal state.
struct GcodeMove {
  std::array<const GcodeWord*, 3> linear{}, rotary{}, centre{}, vector{};
  const GcodeWord *radius = nullptr, *turns = nullptr;
  const GcodeWord* turns_begun = nullptr;         ///< P of an arc
  std::map<char, const GcodeWord*> parameters{};  ///< P, Q, L, E, U, V, W
  std::optional<Eigen::Vector3d> pole{};          ///< Heidenhain: an arc's centre, programmed coordinates
  bool machine = false;                           ///< SUPA, G53: machine coordinates
  bool reference = false;                         ///< G28, G30
  bool dwell = false;
  SourceLocation place{};
  const GcodeWord* Parameter(char letter) const {
    const auto found = parameters.find(letter);
    return found == parameters.end() ? nullptr : found->second;
  }
  /// Takes X to Z, A to C, I to K and A3 to C3; false for other words. Throws InputError for a word that is
  /// there twice.
  bool Put(const GcodeWord& word, bool vector_in_ijk);
  bool HasCentre() const { return centre[0] || centre[1] || centre[2]; }
  bool HasLinear() const { return linear[0] || linear[1] || linear[2]; }
  bool HasTurn() const { return rotary[0] || rotary[1] || rotary[2] || vector[0] || vector[1] || vector[2]; }
};

/// A hole of a cycle, along the axis across the plane in force. Heights in programmed coordinates, mm.
struct GcodeHole {
  std::string name;      ///< "G81", for messages
  std::string left_out;  ///< why it is left out; empty: it is drilled
  double clearance = 0, retract = 0;
  std::vector<double> strokes;  ///< see Heights()
  double first_feed_share = 1;  ///< of the feed, on the first stroke
  SourceLocation place;
};

/// Where the tool is and how it stands, from block to block; appends its way to a path.
class GcodeMotion {
 public:
  using ValueOf = std::function<double(const GcodeWord&)>;
  GcodeMotion(const CamReadOptions& options, GcodeModes& modes, SectionTracker& sections, CamPath& path,
              ValueOf value_of)
      : options_(options), modes_(modes), sections_(sections), path_(path), value_of_(std::move(value_of)) {}

  /// TRANS, ROT, ATRANS, AROT.
  void TakeFrame(const GcodeBlock& block);
  /// A zero offset by its name ("G54", "G54.1 P2"); the tool stays where it is. With the job's offsets the
  /// coordinates behind it are counted from there, else no cut may lie under another one. Throws InputError.
  void SetOffset(const std::string& name, const SourceLocation& place);
  const std::string& offset() const { return offset_; }
  void StartWithOffset(std::string_view name) { offset_ = name; }
  /// Heidenhain's datum shift: its X, Y and Z, the others stay.
  void ShiftDatum(const GcodeMove& move);
  /// TRAORI, G43.4: the tip stays where it is; what X, Y, Z mean changes.
  void SetTipProgramming(bool on);
  /// Throws InputError for what cannot be followed.
  void Move(const GcodeMove& move);
  /// The words of a block that turn rotary axes or the tool's vector, without its motion.
  void Turn(const GcodeMove& move);
  /// Goes to X and Y of the block (in G17), then into the hole and out straight. Throws InputError.
  void Drill(const GcodeMove& move, const GcodeHole& hole);
  const Eigen::Vector3d& at() const { return at_; }  ///< programmed coordinates, mm
  int DrillingAxis() const { return 2 - modes_.plane; }
  size_t holes() const { return holes_; }
  /// The next point is reached in a way that is no cut.
  void SetFresh() { fresh_ = true; }
  /// T: the same, unless M6 changes tools in this program (KeepNamedWays()).
  void NameTool() { named_ = true; }
  /// Ways behind a T alone are cuts: it named the next tool.
  void KeepNamedWays();
  size_t arcs() const { return arcs_; }

 private:
  bool IsPlaced() const { return known_[0] && known_[1] && known_[2]; }
  bool IsStep(const GcodeWord& word) const;
  void LeaveWorkpiece(const GcodeMove& move);
  void TakeCoordinate(const GcodeWord* word, int i, Eigen::Vector3d& to);
  void TakeDirection(const GcodeMove& move);
  void TakeVector(const GcodeMove& move);
  void SetAxis();
  void UseOffset(const SourceLocation& place);
  std::optional<double> FullTurns(const GcodeMove& move) const;
  std::vector<Eigen::Vector3d> Arc(const GcodeMove& move, const Eigen::Vector3d& to);
  void Append(GcodePath way, bool rapid);
  void AppendStraight(const Eigen::Vector3d& to, bool rapid, const SourceLocation& place);
  Eigen::Vector3d TipAt(const Eigen::Vector3d& programmed) const;

  const CamReadOptions& options_;
  GcodeModes& modes_;
  SectionTracker& sections_;
  CamPath& path_;
  ValueOf value_of_;
  GcodeFrame frame_;
  std::string offset_;                               // in force
  bool offset_named_ = false;                        // by a word of the file
  bool cut_in_offset_ = false;                       // something was cut under it
  Eigen::Vector3d datum_ = Eigen::Vector3d::Zero();  // Heidenhain's G54
  GcodeDirection direction_;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();    // programmed coordinates
  Eigen::Vector3d base_ = Eigen::Vector3d::Zero();  // the same without frames
  std::array<bool, 3> known_{};                     // of X, Y, Z
  bool tip_programmed_ = false;
  bool lost_ = false;               // the tool left the part for a place that is not known
  bool named_ = false;              // a T came before the next point
  std::vector<size_t> named_ways_;  // points that are fresh because of a T alone
  bool fresh_ = false;              // the next point is reached in a way that is no cut
  size_t arcs_ = 0, holes_ = 0;
};

}  // namespace millpose
