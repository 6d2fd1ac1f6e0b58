// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace millpose {

/// Which way a spindle turns, seen from the holder towards the tip.
enum class SpindleSense : uint8_t {
  kNotStated,
  kClockwise,         ///< M3, CLW
  kCounterClockwise,  ///< M4, CCLW
};

/// Cuts of a CAM path one behind the other with the same tool at the same speed.
struct CamSection {
  std::string tool;                ///< number or name in the file; empty: none
  std::optional<double> diameter;  ///< of the cutter, mm
  double corner_radius = 0;        ///< mm
  std::optional<double> speed;     ///< of the spindle, rev/s
  SpindleSense sense = SpindleSense::kNotStated;
  int first_line = 0, last_line = 0;  ///< of the file, of its cuts and holes

  /// Whether tool, cutter and spindle are the same.
  bool SameAs(const CamSection& other) const;
  /// "tool 1 D20 at 12,000/min clockwise".
  std::string ToText() const;
};

/// How a CAM path was taken, for reports.
struct CamSource {
  std::string sender;         ///< "Creo"; "not recognised"
  std::string unit;           ///< "mm, by UNITS in line 3"
  std::string frame;          ///< "CATIA0 of line 4"; "as written"
  std::string three_numbers;  ///< "+z", "keep the axis"; empty: no point asks
  std::vector<CamSection> sections;

  /// "Creo, mm by UNITS, frame CSYS (identity), three numbers = +z, tool 1 D20 at 12,000/min clockwise".
  std::string ToText() const;
};

}  // namespace millpose
