// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace millpose {

/// A rotary axis of the machine that a G-code program was written for. In the workpiece frame with all
/// rotary axes at 0, where the tool axis is +z. mm.
struct RotaryAxis {
  char letter = 'A';  ///< A, B or C
  Eigen::Vector3d direction =
      Eigen::Vector3d::UnitX();  ///< unit vector: positive angles turn right-handed about it
  /// A point of the axis: of one that carries the workpiece in the workpiece frame, of one that carries the
  /// tool from the programmed point. Without effect where the program names the tip (TRAORI, G43.4).
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  bool carries_workpiece = false;  ///< else the tool
};

/// A machine's rotary axes: those that carry the tool in order from the bed to the tool, those that carry
/// the workpiece from the bed to the workpiece.
class RotaryAxes {
 public:
  RotaryAxes() = default;
  explicit RotaryAxes(std::vector<RotaryAxis> axes) : axes_(std::move(axes)) {}

  bool Has(char letter) const;
  /// Direction from tip to holder in the workpiece frame; `angles` of A, B, C, rad.
  Eigen::Vector3d ToolAxis(const std::array<double, 3>& angles) const;
  /// Where the tip stands in the workpiece frame when the linear axes stand at `machine`.
  Eigen::Vector3d Tip(const Eigen::Vector3d& machine, const std::array<double, 3>& angles) const;
  /// The other way round.
  Eigen::Vector3d Machine(const Eigen::Vector3d& tip, const std::array<double, 3>& angles) const;
  /// Largest distance of the tip from an axis that moves it outside of tip programming, mm.
  double Lever(const Eigen::Vector3d& machine) const;

 private:
  Eigen::Isometry3d Chain(const std::array<double, 3>& angles, bool workpiece) const;

  std::vector<RotaryAxis> axes_;
};

}  // namespace millpose
