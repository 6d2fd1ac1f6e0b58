// SPDX-License-Identifier: GPL-3.0-or-later
// What a milled part says of the deflections that were predicted for it (docs/compensation.md).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "toolpath/milling_point.hpp"

namespace millpose {

/// One measured place of a face. Lengths along its normal, mm.
struct FaceReading {
  double predicted = 0;           ///< deflection of the uncompensated tip, away from the part
  double taken = 0;               ///< what the program took out of it
  double measured = 0;            ///< how far the face stands proud of the nominal one
  CutSide side = CutSide::kDown;  ///< of the cut that left the face there
  int place = -1;                 ///< readings of one place share a number; −1: its own
};

/// A factor with its 95 % interval.
struct CalibratedFactor {
  double value = 1, low = 0, high = 0;
  size_t readings = 0;
  bool determined = false;  ///< the readings tell it at all, and that it is above 0
};

struct Calibration {
  size_t readings = 0;
  double offset = 0;                      ///< mm, of the whole face: its place, not its deflection
  CalibratedFactor scale;                 ///< measured ÷ predicted
  std::array<CalibratedFactor, 4> sides;  ///< the same by CutSide
  double explained = 0;                   ///< R²: share of the measured variation, 0..1
  double residual = 0;                    ///< mm, standard deviation of what the scale leaves
  std::optional<double> repeatability;    ///< mm, standard deviation of one reading, from places read twice
  double measured_range = 0, predicted_range = 0;  ///< mm, largest − smallest
  bool explains_variation = false;                 ///< where the face is high and low
  bool explains_size = false;                      ///< and by how much
  std::string verdict;                             ///< one or two sentences

  /// Whether a next plan should be given its factors.
  bool usable() const { return explains_variation && explains_size; }
};

/// Least squares of measured + taken = offset + scale·predicted, and the same with one scale for each side of
/// the cut. The model counts as explaining the variation when it accounts for at least half of it and the
/// scale is above 0 with 95 % confidence; as explaining the size when the scale also lies between 1/1.7 and
/// 1.7, the spread of published cutting forces (docs/process-force.md). Fewer than five readings determine
/// nothing.
Calibration Calibrate(const std::vector<FaceReading>& readings);

}  // namespace millpose
