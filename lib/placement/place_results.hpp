// SPDX-License-Identifier: GPL-3.0-or-later
// What `millpose place` found, as a value, and its texts.
#pragma once

#include <map>

#include "placement/place_score.hpp"

namespace millpose {

/// A scored place and what it comes to beside the job's own: below 1 is better.
struct RatedPlace {
  PlaceScore score;
  std::optional<double> worst, mean;  ///< ÷ the reference's; the greatest of the operations
  double value = 0;                   ///< what the search makes small
};

/// A place that was planned whole.
struct PlannedPlace {
  PoseSettings place;
  std::string folder;  ///< below the output folder
  size_t points = 0, planned = 0, gaps = 0, gaps_planned = 0;
  std::vector<std::optional<double>> worst, median;   ///< of the objective, one per operation
  std::vector<std::optional<double>> length, normal;  ///< worst |cF| and |n'cF|, mm, likewise
  std::optional<double> clearance;                    ///< mm
  std::map<std::string, double> cycle;                ///< s, by controller
};

/// One coordinate changed a little at the recommended place.
struct Sensitivity {
  size_t coordinate = 0;  ///< as kPlaceKeys
  double by = 0;          ///< mm or degrees
  RatedPlace rated;
};

struct FoundPlaces {
  std::string job, objective, unit;
  std::vector<std::string> operations;  ///< names; one without a name where the job is one itself
  std::vector<std::string> stands_on;
  std::vector<size_t> sampled;  ///< points of each operation
  RatedPlace own;               ///< the job's own place
  std::vector<RatedPlace> places;
  std::vector<PlannedPlace> plans;  ///< the job's own place first
  size_t recommended = 0;           ///< of `plans`; 0: nothing is better than the job's own place
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

/// plan's ÷ the job's own place's: the greatest over the operations that have one; empty where one is missing
/// beside the other.
std::optional<double> RatioOf(const std::vector<std::optional<double>>& plan,
                              const std::vector<std::optional<double>>& own);

/// A line for every place.
std::string PlacesCsv(const std::vector<RatedPlace>& places);
std::string PlacementMapVtk(const FoundPlaces& placement);
std::string PlacementJson(const FoundPlaces& placement);
/// The screenful for the user; `placed`: the file that was written, if one was.
std::string PlacementText(const FoundPlaces& placement, const std::string& placed);
std::string PlacementPage(const FoundPlaces& placement);

}  // namespace millpose
