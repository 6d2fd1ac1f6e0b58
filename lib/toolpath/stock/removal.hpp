// SPDX-License-Identifier: GPL-3.0-or-later
// Material while it is milled off, as pages show it (docs/stock.md).
#pragma once

#include "toolpath/stock/standing_stock.hpp"

namespace millpose {

/// From where to where material stands on each line of a lattice, frame by frame; what is hollow between a
/// line's ends is not told. Frame P, mm.
struct Removal {
  /// What a stretch of the run has changed.
  struct Frame {
    double time = 0;     ///< s, at its end
    double volume = 0;   ///< mm³ that stand then
    size_t changed = 0;  ///< lines: the next ones of `lines`
  };

  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the first line, 0 along the lines
  int along = 2;       ///< axis of the lines; columns lie along the next axis, rows along the one after
  double spacing = 0;  ///< of the lines
  size_t rows = 0, columns = 0;
  double volume = 0;          ///< mm³ that stand at first
  std::vector<Span> blank;    ///< by line, row by row; high < low where nothing stands
  std::vector<Span> part;     ///< of the finished part, likewise
  std::vector<Frame> frames;  ///< in the order of time
  std::vector<uint32_t> lines;
  std::vector<Span> ends;  ///< of `lines` after their frames
};

/// A motion of a run.
struct TimedMotion {
  CutterMotion motion;
  double until = 0;  ///< s: its end
};

/// The axis of P that the motions' tool axes are nearest to in the mean, 0 to 2.
int AxisOfLines(std::span<const TimedMotion> motions);

/// Mills motions out of `stock` and tells what changes, in `most_frames` frames at most. What moves by less
/// than a 500th of the blank's thickness is told in the last. Throws Interrupted.
Removal WatchRemoval(StandingStock stock, const Triangles& part, const CutterShape& cutter,
                     std::span<const TimedMotion> motions, size_t most_frames, int threads,
                     std::stop_token stop = {});

}  // namespace millpose
