// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "planning/smoothing/freedom_course.hpp"

namespace millpose {

/// The path before smoothing, which the smoothed one is held against.
struct SmoothReference {
  double square = 0;              ///< mean square of the joint accelerations, rad²/s⁴
  double objective = 0;           ///< summed
  double worst = 0;               ///< the largest objective
  std::vector<double> deviation;  ///< mm, of each motion half-way (HalfwayDeviation); the last closes a ring
};

/// What the smoothing of a piece goes by.
struct SmoothOptions {
  SmoothReference before;
  double loss = 0;               ///< share of the objective that may be given up
  size_t freedom = 0;            ///< which of the points' is shifted
  std::vector<Joints> max_step;  ///< rad, one per motion
  std::vector<double> max_lean;  ///< rad, one per motion: of the leans; empty where nothing leans
  double max_deviation = 0;      ///< mm, of the tip half-way between points
  bool repair = true;       ///< motions that deviate by more are repaired; else they only may not get worse
  bool keep_worst = false;  ///< no point may come to have a larger objective than the worst had
  bool closed = false;
  std::stop_token stop;
  std::vector<Eigen::Vector3d> middles = {};  ///< as CourseBounds::middles, where external axes move
  /// Of the objective, as an earlier smoothing found it (Smoothed::weight); 0: by giving ever more of the
  /// objective.
  double weight = 0;
};

/// What came of smoothing.
struct Smoothed {
  bool repaired = true;  ///< all motions that deviate by more than they may
  double weight = 0;     ///< of the objective, with which the path came out; 0: it is as it was
};

SmoothReference MeasurePath(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                            const SmoothOptions& options, std::span<const PathNode> path);

/// How far each motion may deviate half-way, mm.
std::vector<double> DeviationLimits(const SmoothOptions& options);

/// Shifts one freedom (the rotation about the tool axis, or a lean) along a piece so that the mean square of
/// the joint accelerations at the points' feeds (RatesAlong, all joints alike, weighted by time) becomes
/// small: Gauss-Newton on the closed-form inverse, branches and full revolutions kept, every point admissible
/// and within `ranges`, which hold the path. Joint steps and changes of a lean stay within their bounds, the
/// objective's sum within `loss` of what it was before, deviations half-way within `max_deviation`; where
/// these cannot all be repaired for the loss allowed they only may not grow beyond what they were before. A
/// path that keeps to its bounds stays within them and gets no rougher; one that does not comes as near to
/// them as is found. Joint angles of `path` are continuous. Interference is not looked at.
Smoothed SmoothPath(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                    std::span<const FreedomRange> ranges, const SmoothOptions& options,
                    std::span<PathNode> path);

}  // namespace millpose
