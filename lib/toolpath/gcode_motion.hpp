// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "toolpath/gcode_block.hpp"
#include "toolpath/gcode_frame.hpp"
#include "toolpath/gcode_way.hpp"

namespace millpose {

/// What G words leave in force.
struct GcodeModes {
  int motion = 0;      ///< G0 to G3
  int plane = 0;       ///< of arcs: 0 to 2 for G17 to G19
  int feed_mode = 94;  ///< G93, G94, G95
  bool incremental = false, absolute_centre = false, inch = false, inch_feed = false;
  std::optional<double> feed_word;                     ///< the last F
  double feed = 0, inverse_time = 0, revolutions = 0;  ///< mm/s, 1/s of the next motion, 1/s

  double Unit() const { return inch ? 25.4 : 1; }  ///< mm
  /// Makes the feed of the word and the mode.
  void SetFeed();
};

/// What stands in one block besides modal state.
struct GcodeMove {
  std::array<const GcodeWord*, 3> linear{}, rotary{}, centre{}, vector{};
  const GcodeWord *radius = nullptr, *turns = nullptr;
  bool machine = false;    ///< SUPA, G53: machine coordinates
  bool reference = false;  ///< G28, G30
  bool dwell = false;
  Place place;
  bool HasLinear() const { return linear[0] || linear[1] || linear[2]; }
  bool HasTurn() const { return rotary[0] || rotary[1] || rotary[2] || vector[0] || vector[1] || vector[2]; }
};

/// Where the tool is and how it stands, from block to block; appends its way to a path.
class GcodeMotion {
 public:
  using ValueOf = std::function<double(const GcodeWord&)>;
  GcodeMotion(const CamReadOptions& options, GcodeModes& modes, CamPath& path, ValueOf value_of)
      : options_(options), modes_(modes), path_(path), value_of_(std::move(value_of)) {}

  /// TRANS, ROT, ATRANS, AROT.
  void TakeFrame(const GcodeBlock& block);
  /// TRAORI, G43.4: the tip stays where it is; what X, Y, Z mean changes.
  void SetTipProgramming(bool on);
  /// Throws InputError for what cannot be followed.
  void Move(const GcodeMove& move);
  /// The next point is reached in a way that is no cut.
  void SetFresh() { fresh_ = true; }
  size_t arcs() const { return arcs_; }

 private:
  bool IsPlaced() const { return known_[0] && known_[1] && known_[2]; }
  bool IsStep(const GcodeWord& word) const;
  void LeaveWorkpiece(const GcodeMove& move);
  void TakeCoordinate(const GcodeWord* word, int i, Eigen::Vector3d& to);
  void TakeDirection(const GcodeMove& move);
  void TakeVector(const GcodeMove& move);
  void SetAxis();
  std::vector<Eigen::Vector3d> Arc(const GcodeMove& move, const Eigen::Vector3d& to);
  void Append(GcodeWay way);

  const CamReadOptions& options_;
  GcodeModes& modes_;
  CamPath& path_;
  ValueOf value_of_;
  GcodeFrame frame_;
  GcodeDirection direction_;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();    // programmed coordinates
  Eigen::Vector3d base_ = Eigen::Vector3d::Zero();  // the same without frames
  std::array<bool, 3> known_{};                     // of X, Y, Z
  bool tip_programmed_ = false;
  bool lost_ = false;   // the tool left the part for a place that is not known
  bool fresh_ = false;  // the next point is reached in a way that is no cut
  size_t arcs_ = 0;
};

}  // namespace millpose
