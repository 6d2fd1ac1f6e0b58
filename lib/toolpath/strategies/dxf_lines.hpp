// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace millpose {

struct DxfOptions {
  std::optional<double> unit;       ///< mm, where the file states none
  std::vector<std::string> layers;  ///< only these; empty: all
  double chord_tolerance = 0.01;    ///< mm, of arcs
};

struct DxfLines {
  std::vector<std::vector<Eigen::Vector3d>>
      lines;                       ///< mm, two points or more each; a closed one ends where it begins
  std::vector<std::string> notes;  ///< what was left out, one sentence each
};

/// The lines of a text DXF: LINE, LWPOLYLINE, POLYLINE, ARC and CIRCLE of the model space, in the order of
/// the file; those whose ends lie within 0.01 mm of each other are joined. `name` is for messages. Throws
/// InputError with the line for what is no DXF, other curves (SPLINE, ELLIPSE), blocks (INSERT), layers that
/// are not there, and a unit that the file does not state or states otherwise.
DxfLines ReadDxfLines(std::string_view bytes, const std::string& name, const DxfOptions& options);

}  // namespace millpose
