// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/external/places_along.hpp"
#include "planning/ladder/step_bound.hpp"
#include "planning/pose/scorer.hpp"
#include "planning/result/compared.hpp"

namespace millpose {

/// What every rotation of a grid gives on every branch over the planned points of a pass, interference left
/// aside.
struct FixedTable {
  struct Entry {
    bool serves =
        true;  ///< all points within limits, steps within their bound, full revolutions within the limits
    double worst = 0, sum = 0;  ///< of the objective over the points that count
  };
  size_t rotations = 0;
  double first = 0, step = 0;  ///< rad, of the grid
  std::vector<Entry> entries;  ///< 8 branches a rotation; the figures of one that does not serve are 0

  const Entry& At(size_t rotation, int branch) const {
    return entries[8 * rotation + static_cast<size_t>(branch)];
  }
  double Rotation(size_t index) const { return first + static_cast<double>(index) * step; }
};

struct FixedTableOptions {
  double rotation_step;  ///< rad: the ladder search's
  StepBounds steps;
};

/// A planned pass and what its points were planned in.
struct PlannedIn {
  const PassResult& pass;
  const Station& station;         ///< where the axes stand, or with them at the pass's first point
  std::vector<PlaceAlong> along;  ///< of each point, where they move along the pass; else empty

  PlannedIn(const Stations& stations, const PassResult& planned);
  const Station& At(size_t t) const { return along.empty() ? station : *along[t].station; }
  Carrier CarrierAt(size_t t) const;
  /// In a frame that all points of the pass have in common.
  MillingPoint StepPoint(size_t t) const;
};

/// The rotation is the problem's first freedom, others are 0.
FixedTable MakeFixedTable(const PlannedIn& planned, const PointFilter& counts,
                          const FixedTableOptions& options);

/// Eight rotations of a table's grid from r on, other freedoms at 0, as ScoreBlock takes them; the last one
/// fills up.
std::vector<double> ValuesOfBlock(const FixedTable& table, size_t r, size_t dimensions);

}  // namespace millpose
