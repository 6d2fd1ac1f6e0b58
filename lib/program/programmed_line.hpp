// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "machine/motion/line.hpp"
#include "program/conventions.hpp"

namespace millpose {

/// A straight motion as a controller makes it: the tool turns evenly about one axis; or it swivels a
/// direction of its own evenly and turns evenly about it; or three angles run evenly.
class ProgrammedLine {
 public:
  ProgrammedLine(const Pose& from, const Pose& to) : line_(from, to) {}
  /// `direction`: unit, in the frame that moves. It swivels on the shortest way, and the rest of the
  /// orientation turns about it (KRL's LIN with $ORI_TYPE = #VAR; the direction is $TOOL_DIRECTION).
  ProgrammedLine(const Pose& from, const Pose& to, const Eigen::Vector3d& direction);
  /// Orientation by angles (rad) from `first` to `last`: R = FromToolAngles(rotation, angles)·R_TCᵀ.
  ProgrammedLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, AngleOrder rotation,
                 const Eigen::Matrix3d& R_TC, const Eigen::Vector3d& first, const Eigen::Vector3d& last);

  Pose At(double share) const;  ///< 0..1
  double length() const { return line_.length(); }
  double angle() const;  ///< rad; a bound where the tool does not turn about one axis

 private:
  struct ByAngles {
    AngleOrder rotation = AngleOrder::kRpy;
    Eigen::Matrix3d R_CT;
    Eigen::Vector3d first, last;
  };
  struct BySwivel {
    Eigen::Matrix3d R;              // at the start
    Eigen::Vector3d axis, own;      // of the swivel, outside; of the turn, in the tool
    double swivel = 0, turned = 0;  // rad
  };

  PoseLine line_;
  std::optional<ByAngles> by_angles_;
  std::optional<BySwivel> by_swivel_;
};

/// How a controller makes a straight motion between two poses of the tool.
using LineModel = std::function<ProgrammedLine(const Pose& from, const Pose& to)>;

/// The largest angle (rad) between the orientation that `line` has and that of one even turn, at a quarter,
/// half and three quarters of the way.
double TurnDeviation(const ProgrammedLine& line, const Pose& from, const Pose& to);

}  // namespace millpose
