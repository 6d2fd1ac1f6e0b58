// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "tests/audit/folder.hpp"

namespace millpose::audit {

/// What a plan made by hand gets wrong in one place; all zero: nothing.
struct Fault {
  double lift_mm = 0;          ///< one point off the surface, everything else following it
  double rotation_deg = 0;     ///< one point's tool turned about its axis, everything else following it
  bool narrow_limits = false;  ///< the job's limits exclude the point with the largest A1
  /// deg: A2 − A3 may be so much more than at the point where it is largest; negative: less, which is the
  /// fault.
  std::optional<double> coupled_room_deg = {};
  bool fixture_in_way = false;  ///< a post stands where the spindle passes
  bool layers = false;          ///< no fault: the first pass 1 mm above the surface, the second on it
  double lead_mm = 0;           ///< no fault: the last point of all is a lead's, so far above the cut
  bool cartesian = false;       ///< no fault: LinuxCNC's cuts as tool poses
  /// No fault: on a rail along the base's y, which moves by so much from point to point of a pass and by 100
  /// mm more for the second.
  std::optional<double> rail_step_mm = {};
  bool forces = false;  ///< no fault: planned for `surface_error`, with deflection.csv and summary.json
};

/// Texts of a folder by name, as `plan` would leave it, with the cell and the mesh beside.
using Texts = std::map<std::string, std::string>;

/// A plan of two passes of six points on the top of a block, solved by iteration. `fault` is built in
/// consistently.
Texts MakeFolder(const Fault& fault);

/// The programs' text by file for one straight motion of the tool in W, of either KRL or SINUMERIK.
Texts OneMotion(const Setup& setup, const Matrix4& from, const Matrix4& to);

/// Line `line` (from 0) of a text, changed.
void EditLine(std::string& text, size_t line, const std::function<std::string(std::string)>& edit);

}  // namespace millpose::audit
