// SPDX-License-Identifier: GPL-3.0-or-later
// `placement:` of a job: where `millpose place` may put the part. Inside units (mm, rad).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/pose_settings.hpp"
#include "job/config/cell_settings.hpp"

namespace millpose {

/// A direction in which a place is looked for.
struct PlaceRange {
  double from = 0, to = 0;  ///< of one coordinate of workpiece.pose, mm or rad
};

/// A body that stands in the cell for the search alone: where the part must not be.
struct KeepOutSettings {
  std::string name;
  ShapeSettings shape;
  PoseSettings pose;  ///< in W
};

/// What `millpose place` moves.
enum class PlaceMoves : uint8_t { kPart, kRobot };

/// The coordinates of a place: x, y, z of xyz_mm, then A, B, C of abc_deg.
inline constexpr std::array<const char*, 6> kPlaceKeys{"x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg"};

inline constexpr int kMostStations = 9;

/// Several stations: the part or the robot is moved between them, and each mills its share of the part.
struct StationSettings {
  int most = 2;      ///< stations
  double error = 0;  ///< mm: how far off its place on the part a station may mill
  std::optional<Eigen::Vector3d>
      along;                   ///< P, unit: the part is split across it; none: the longest of x, y, z
  std::optional<double> gain;  ///< share of the worst value for which one more pays; none: points alone
};

struct PlacementSettings {
  std::array<std::optional<PlaceRange>, 6> ranges;  ///< as kPlaceKeys; none: as the job has it
  PlaceMoves moves = PlaceMoves::kPart;
  int points = 200;              ///< of the tool path, looked at in every place
  int places = 2000;             ///< looked at
  int plans = 3;                 ///< of the best places, planned whole
  std::vector<std::string> map;  ///< its directions, one or two of kPlaceKeys; none: the first with a range
  int map_points = 41;           ///< of the map, along each of its two directions
  std::vector<KeepOutSettings> keep_out;
  std::optional<StationSettings> stations;  ///< none: one place
};

}  // namespace millpose
