// SPDX-License-Identifier: GPL-3.0-or-later
// What a gear's lost motion leaves of a joint's motion (docs/lost-motion.md). The output of a gear rests on
// one of two flanks, half the lost motion before or behind its input.
#pragma once

#include "machine/robot/axis_convention.hpp"
#include "machine/robot/mechanism.hpp"

namespace millpose {

inline constexpr int kMostGears = 6 + static_cast<int>(kMostExternalAxes);

/// One value for each gear: the arm's six, then one for each external axis of the cell. Never on the heap.
using GearValues = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostGears, 1>;

/// What is known of the gears of a cell.
struct LostMotion {
  AxisConvention gears;  ///< how the arm's gears count its axes: a parallelogram's third turns by A2 + A3
  /// h: how far the input turns between the flanks, rad (mm along a linear external axis); 0: no gap.
  GearValues width = GearValues::Zero(6);
  /// Below this load at the gear friction alone says where the output rests, N·mm (N along a linear axis);
  /// +inf: load is not looked at.
  GearValues friction = GearValues::Constant(6, std::numeric_limits<double>::infinity());

  /// Whether any gear has a gap.
  bool Any() const { return (width.array() > 0).any(); }
};

/// Where the gears stand: rad, mm of a linear external axis. `external`: one value for each external axis.
GearValues AtGears(const LostMotion& lost, const Joints& q, const ExternalPosition& external = {});

/// How far the tip goes along a direction per turn of each gear, mm/rad (1 for linear external axes: mm/mm).
/// `by_joint`: Jᵀ·n, the same by the arm's own axes (mm/rad), J rows 0..2 of Jacobian() at the tip and n the
/// unit normal, both in B. `by_external`: the same for each external axis.
GearValues GearLevers(const LostMotion& lost, const Joints& by_joint,
                      const std::vector<double>& by_external = {});

/// Where the outputs of all gears rest in their gaps. A gear whose load beats its friction rests on the flank
/// that the load presses it against, whichever way it turns; else its output stays where it is until a flank
/// takes it along (the play operator y ← clip(y, q − h/2, q + h/2)). So a loaded gear that turns back does
/// not cross, and one whose load changes its sign crosses without turning back.
class GearFlanks {
 public:
  /// Entered settled: as after a long way in the directions (signs) of `first_move`; with 0 as with +1.
  /// `load`: torques that turn the outputs, in their positive sense where positive, N·mm (N); gears without a
  /// value have none.
  GearFlanks(const LostMotion& lost, const GearValues& first_move, const GearValues& load = {});

  /// The inputs go on by `move` (rad, mm); at its end the load is `load`.
  void Move(const GearValues& move, const GearValues& load = {});

  /// y − q: outputs before (+) or behind (−) their inputs, counted from the middle of the gap, rad (mm).
  /// Within ±h/2.
  const GearValues& offset() const { return offset_; }

 private:
  void Press(const GearValues& load);

  GearValues half_, friction_, offset_;
};

/// A reversal counts when a gear has turned back by more than this, rad; less is not told from rest.
inline constexpr double kReversalDeadZone = 0.005 * 3.14159265358979323846 / 180;
inline constexpr double kReversalDeadZoneLinear = 0.01;  ///< mm, of a linear external axis

/// The way of one gear: where it turns back. A reversal is found late, when the gear has turned back by the
/// dead zone, and lies where it turned.
class ReversalCounter {
 public:
  explicit ReversalCounter(double dead_zone) : dead_zone_(dead_zone) {}

  /// The next place on the way, in order. Returns the index (0 for the first place) at which the gear turned
  /// back, where that is now known; else −1.
  int Next(double position);
  /// Which way it went last by more than the dead zone: −1, 0 (it has not yet), +1.
  int direction() const { return direction_; }

 private:
  double dead_zone_;
  int count_ = 0, direction_ = 0, low_at_ = 0, high_at_ = 0;
  double low_ = 0, high_ = 0;
};

/// The directions (−1, 0, +1) in which each gear first goes by more than its dead zone along `way` (AtGears
/// of every place), from which GearFlanks are entered. 0: it never does.
GearValues FirstMove(const LostMotion& lost, const std::vector<GearValues>& way,
                     const std::vector<ExternalAxis>& external = {});

/// y − q along `way`, entered settled in the directions of FirstMove(); `load` one entry for each place, or
/// none. One entry for each place.
std::vector<GearValues> OffsetsAlong(const LostMotion& lost, const std::vector<GearValues>& way,
                                     const std::vector<GearValues>& load,
                                     const std::vector<ExternalAxis>& external = {});

}  // namespace millpose
