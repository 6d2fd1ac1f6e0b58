// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a motion of the cutter meets material that stands (docs/stock.md).
#pragma once

#include "toolpath/stock/standing_stock.hpp"

namespace millpose {

/// What a motion meets, the most first.
enum class InAir : uint8_t {
  kCuts,     ///< it takes material off, or nobody knows
  kTouches,  ///< it takes nothing off, but material is within the margin
  kClear     ///< none is within the margin
};

/// Asks a stock about motions of one cutter, which is looked at along its cutting length.
class AirCheck {
 public:
  /// `spacing`: of the lines of the stocks that are asked. `margin`, mm: what material keeps off a motion
  /// that is clear. To it comes all that a stock does not know between its lines: √2 of the spacing, and the
  /// quarter of it by which axes turn.
  AirCheck(const CutterShape& cutter, double margin, double spacing);

  /// Material that the cutter goes into by less than 0.05 mm counts as not cut.
  InAir Of(const CutterMotion& motion, const StandingStock& stock) const;

 private:
  /// The cutter with all its surface moved outwards by some mm.
  struct Grown {
    CutterProfile profile;
    double by, turn;

    Grown(const CutterShape& cutter, double by, double spacing);
    bool Meets(const CutterMotion& motion, const StandingStock& stock) const;
  };
  Grown cut_, near_;
};

}  // namespace millpose
