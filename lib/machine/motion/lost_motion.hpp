// SPDX-License-Identifier: GPL-3.0-or-later
// What a gear's lost motion leaves of a joint's motion (docs/lost-motion.md). The output of a gear rests on
// one of two flanks, half the lost motion before or behind its input.
#pragma once

#include <span>

#include "base/units.hpp"
#include "machine/robot/axis_convention.hpp"
#include "machine/robot/mechanism.hpp"

namespace millpose {

inline constexpr int kMostGears = 6 + static_cast<int>(kMostExternalAxes);

/// One value for each gear: the arm's six, then the cell's external axes in order; 0 where there is no axis.
using GearValues = Eigen::Matrix<double, kMostGears, 1>;

/// What is known of the gears of a cell.
struct LostMotion {
  /// How the arm's gears count its axes, the matrix of an AxisConvention and its inverse: a parallelogram's
  /// third gear turns by A2 + A3.
  Matrix6 gears = Matrix6::Identity(), axes = Matrix6::Identity();
  /// h: how far the input goes between the flanks, rad (mm of a linear external axis); 0: no gap.
  GearValues width = GearValues::Zero();
  /// Up to this load at the gear friction alone says where the output rests, N·mm (N of a linear axis); +inf:
  /// load is not looked at.
  GearValues friction = GearValues::Constant(kInfinity);
  /// By how much a gear turns back before that counts as a reversal, rad (mm of a linear axis): less is not
  /// told from rest.
  GearValues dead_zone = GearValues::Constant(DegToRad(0.005));

  /// The arm's gears count as `convention` does; its offsets do not matter.
  void CountAs(const AxisConvention& convention) {
    gears = convention.matrix(), axes = convention.Inverse().matrix();
  }
  /// Whether any gear has a gap.
  bool Any() const { return (width.array() > 0).any(); }
};

/// By how much the outputs of the arm's gears are ahead of their inputs: amplitude · sin(periods · q +
/// phase), q the gear's angle.
struct GearError {
  Joints amplitude = Joints::Zero();  ///< rad
  Joints periods = Joints::Ones();    ///< in one turn
  Joints phase = Joints::Zero();      ///< rad

  Joints At(const Joints& gears) const;
};

/// The dead zone of a linear external axis, mm.
inline constexpr double kLinearDeadZone = 0.01;

/// Where the gears stand: rad, mm of a linear external axis. `external`: one value for each external axis.
GearValues AtGears(const LostMotion& lost, const Joints& q, const ExternalPosition& external = {});

/// How far the tip goes along a direction for each gear's turn, mm/rad (of a linear axis mm/mm). `by_joint`:
/// the same by the arm's own axes, Jᵀ·n with J the rows 0..2 of Jacobian() at the tip and n a unit vector,
/// both in B. `by_external`: for each external axis.
GearValues GearLevers(const LostMotion& lost, const Joints& by_joint,
                      const std::vector<double>& by_external = {});

/// Torques about the arm's axes (N·mm) as loads of its gears; 0 for external axes.
GearValues GearLoads(const LostMotion& lost, const Joints& about_axes);

/// Where the outputs of all gears rest in their gaps. A gear whose load beats its friction rests on the flank
/// that the load presses it against, whichever way it turns; else its output stays where it is until a flank
/// takes it along (the play operator y ← clip(y, q − h/2, q + h/2)). So a loaded gear that turns back does
/// not cross, and one whose load changes its sign crosses without turning back.
class GearFlanks {
 public:
  /// Entered settled: as after a long way in the directions (signs) of `first_move`; with 0 as with +1.
  /// `load`: torques that turn the outputs, in their positive sense where positive, N·mm (N).
  GearFlanks(const LostMotion& lost, const GearValues& first_move,
             const GearValues& load = GearValues::Zero());

  /// The inputs go on by `move` (rad, mm); at its end the load is `load`.
  void Move(const GearValues& move, const GearValues& load = GearValues::Zero());

  /// y − q: outputs before (+) or behind (−) their inputs, counted from the middle of the gap, rad (mm).
  /// Within ±h/2.
  const GearValues& offset() const { return offset_; }

 private:
  void Press(const GearValues& load);

  GearValues half_, friction_, offset_;
};

/// One place on the way of the gears.
struct GearPlace {
  GearValues at = GearValues::Zero();    ///< AtGears()
  GearValues load = GearValues::Zero();  ///< as in GearFlanks
};

/// The directions (−1, 0, +1) in which each gear first goes by more than its dead zone, from which a way is
/// entered; 0: it never does.
GearValues FirstMove(const LostMotion& lost, std::span<const GearPlace> way);

/// y − q at every place of a way, entered settled in the directions of FirstMove().
std::vector<GearValues> OffsetsAlong(const LostMotion& lost, std::span<const GearPlace> way);

/// What a gear does at a place of a way.
struct GearEvent {
  int gear = 0;          ///< 0..5: of the arm; 6 and on: external axes
  size_t place = 0;      ///< where it turns back, or where load has pressed it over
  bool turns = false;    ///< it turns back, by more than the dead zone
  bool crosses = false;  ///< its output goes over to the other flank; without load it does where it turns
};

/// By place, then gear. The same whatever the gaps are: their width does not count.
std::vector<GearEvent> GearEvents(const LostMotion& lost, std::span<const GearPlace> way);

}  // namespace millpose
