// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/cam/cam_path.hpp"
#include "toolpath/cam/gcode_frame.hpp"

namespace millpose {

/// How the tool stands.
struct GcodeDirection {
  std::array<double, 3> angles{};                   ///< A, B, C, rad
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< from tip to holder, in the workpiece frame
  bool by_vector = false;                           ///< A3, B3, C3; else by the angles
};

/// One motion: what stands between two blocks.
struct GcodePath {
  Eigen::Vector3d from;                 ///< programmed coordinates
  std::vector<Eigen::Vector3d> points;  ///< after it; chords
  GcodeDirection start, end;
  bool tip_programmed = false;  ///< TRAORI, G43.4: the points are the tip's in the workpiece frame
  bool rapid = false;
  bool cut_from_known = false;  ///< the start is a known place that the tool comes from cutting
  double feed = 0;              ///< mm/s
  double inverse_time = 0;      ///< 1/s of the whole way, in place of the feed when above 0
  SourceLocation place;
};

/// Appends the tip's points in the workpiece frame. Rotary axes turn evenly over the motion: it gets points
/// every 3 degrees at least, and without tip programming so many that the tip's way keeps the chord
/// tolerance. Throws InputError when the path becomes too long.
void AppendWay(const GcodePath& way, const GcodeFrame& frame, const CamReadOptions& options, CamPath& path);

}  // namespace millpose
