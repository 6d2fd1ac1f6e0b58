// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "program/conventions.hpp"
#include "program/motion_program.hpp"

namespace millpose {

/// An axis beside the arm's six, as a controller knows it.
struct ControllerAxis {
  std::string name;                   ///< in its programs: E1, U, or that of a channel axis
  std::string axis;                   ///< of the cell's external axes; empty: it stands still at `constant`
  AxisKind kind = AxisKind::kLinear;  ///< of one that stands still
  double constant = 0;                ///< mm or degrees, likewise
  bool coupled = false;  ///< the controller counts in it: its frames stay on what stands or is carried
};

/// What a controller adds to its count of one axis: factors times its own counts of the others.
struct AxisCoupling {
  int axis = 0;                     ///< 1…6
  Joints factors = Joints::Zero();  ///< of the six axes; 0 for the axis itself
};

/// What more than one controller is reported in its section of the cell's `controllers:`. Every default here
/// and only here; the keys stand in post_keys.cpp.
struct PostOptions {
  FrameAxis tool_axis = FrameAxis::kZ;     ///< of the controller's tool frame, along T's z
  AngleOrder rotation = AngleOrder::kRpy;  ///< how A, B, C turn
  /// Controller's angle = sign · arm's angle + offset (rad), as the cell states them, or once read what
  /// follows where it need not (SettleControllerZeros).
  std::optional<std::array<int, 6>> axis_signs;
  std::optional<Joints> axis_offsets;
  std::optional<std::vector<AxisCoupling>> axis_couplings;  ///< on top of these
  std::optional<double> path_acceleration;                  ///< mm/s², of the tip
  std::optional<double> cycle, block_time;                  ///< s, for the estimate of the speed
  /// mm that a corner whose path the maker does not document may be bounded by; empty: no such corner may be.
  std::optional<double> max_corner;
  int max_motions = 1400;  ///< per file; larger programs call sub-programs
  int max_kbytes = 500;    ///< per file
  std::vector<ControllerAxis> controller_axes;
  int controller_axes_line = 0;  ///< of the YAML, for later errors
  std::vector<PathOutput> outputs;
  std::map<std::string, std::string> texts;  ///< templates by event name, see Templates
  std::map<std::string, int> text_lines;     ///< of the YAML, by event name, for later errors
  std::vector<DeclaredCall> calls;           ///< that texts may make

  /// What axis_signs and axis_offsets say; as the arm counts where they are not given.
  AxisConvention UncoupledAxes() const;
  /// The same with axis_couplings: how the controller counts.
  AxisConvention Axes() const;
  size_t max_bytes() const { return static_cast<size_t>(max_kbytes) * 1000; }
  /// The controller's tool frame C in T.
  Eigen::Matrix3d R_TC() const { return ToolAxis(tool_axis); }
};

}  // namespace millpose
