// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "toolpath/cam/apt_scanner.hpp"
#include "toolpath/cam/cam_source.hpp"

namespace millpose {

/// What a SPINDL statement says.
struct AptSpindle {
  std::optional<double> speed;  ///< rev/s
  SpindleSense sense = SpindleSense::kNotStated;
};

/// The feed that FEDRAT and SPINDL leave in force.
class AptFeed {
 public:
  /// FEDRAT with its value and unit in any order; `unit` (mm) is the file's length unit, for feeds without
  /// one of their own. False for FEDRAT/RAPID, which makes the next motion a rapid. Throws InputError for
  /// words that are not known, for what gives no feed, and for inverse times.
  bool Take(const AptStatement& statement, double unit);
  /// SPINDL: revolutions, or a speed of the cutting edge (SFM: feet, SMM: metres per minute) on a cutter of
  /// `diameter` mm (0: none is known), with the sense (CLW, CCLW) in any order. Throws InputError for words
  /// that are not known, a speed that is not above 0, and a speed of the edge without a cutter.
  AptSpindle TakeSpindle(const AptStatement& statement, double diameter);
  /// mm/s.
  double Rate() const { return per_revolution_ ? feed_ * revolutions_ : feed_; }

 private:
  double feed_ = 0, revolutions_ = 0;  // mm/s or mm, 1/s
  bool per_revolution_ = false;
};

}  // namespace millpose
