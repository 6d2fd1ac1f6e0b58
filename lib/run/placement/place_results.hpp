// SPDX-License-Identifier: GPL-3.0-or-later
// What `millpose place` found, as a value, and its texts.
#pragma once

#include "report/words/words.hpp"
#include "run/placement/plan_place.hpp"
#include "run/placement/rater.hpp"
#include "run/placement/station_search.hpp"

namespace millpose {

/// One coordinate changed a little at the recommended place.
struct Sensitivity {
  size_t coordinate = 0;  ///< as kPlaceKeys
  double by = 0;          ///< mm or degrees
  RatedPlace rated;
};

/// A station that was planned whole.
struct PlannedStation {
  PathSection share;
  PlannedPlace plan;
  std::vector<Sensitivity> sensitivity;  ///< of the recommended split
};

struct PlannedSplit {
  std::vector<PlannedStation> stations;

  /// All stations together; the worst values are the greatest, the medians too.
  PlannedPlace Whole() const;
};

struct FoundPlaces {
  std::string job, objective, unit;
  std::vector<std::string> operations;  ///< names; one without a name where the job is one itself
  std::vector<std::string> stands_on;
  std::vector<size_t> sampled;  ///< points of each operation
  RatedPlace own;               ///< the job's own place
  std::vector<RatedPlace> places;
  std::vector<PlannedPlace> plans;      ///< the job's own place first
  size_t recommended = 0;               ///< of `plans`; 0: nothing is better than the job's own place
  std::optional<SplitRule> split_rule;  ///< where several stations were asked for
  std::vector<PlannedSplit> splits;     ///< by number of stations
  std::optional<size_t> split;          ///< the recommended one; none: one place is
  std::vector<Sensitivity> sensitivity;
  std::array<size_t, 2> map_coordinates{};  ///< as kPlaceKeys; twice the same where only one has a range
  std::vector<RatedPlace> map;              ///< row by row, the first coordinate fastest
  size_t map_columns = 0;

  // What the top view shows, in workpiece.frame (the world where the robot moves), mm.
  bool robot = false;                              ///< the robot moves, not the part
  Eigen::Vector3d base = Eigen::Vector3d::Zero();  ///< of the robot, where the part moves
  Pose X_WP = Pose::Identity();                    ///< where the robot moves
  std::vector<Eigen::Vector3d> part, sample;       ///< in P: the part's vertices, the sampled points
};

/// What keeps the part from a place, or most of its points: empty where all sampled points are free.
std::string CauseOf(const PlaceScore& score);

/// The plans that are recommended: of a place, or of every station.
std::vector<const PlannedPlace*> Recommended(const FoundPlaces& placement);

/// "up to 2950 mm", "from 2950 mm on", "2950 to 5900 mm".
std::string SpanText(const PathSection& share);

/// plan's ÷ the job's own place's: the greatest over the operations that have one; empty where one is missing
/// beside the other.
std::optional<double> RatioOf(const std::vector<std::optional<double>>& plan,
                              const std::vector<std::optional<double>>& own);

/// A line for every place.
std::string PlacesCsv(const std::vector<RatedPlace>& places);
std::string PlacementMapVtk(const FoundPlaces& placement);
std::string PlacementJson(const FoundPlaces& placement);
/// The screenful for the user; `placed`: the files that were written, if some were.
std::string PlacementText(const FoundPlaces& placement, const std::vector<std::string>& placed);
std::string PlacementPage(const FoundPlaces& placement, Language language = Language::kEnglish);

}  // namespace millpose
