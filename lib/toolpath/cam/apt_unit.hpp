// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "toolpath/cam/apt_scanner.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {

/// What tells the length unit of CLDATA: UNITS, else the job's, else the words of its feeds.
class AptUnit {
 public:
  explicit AptUnit(const CamReadOptions& options) : options_(options) {}
  /// Looks at every statement before it is read: words of feeds (MMPM, IPM), and lengths that come before
  /// UNITS.
  void Look(const AptStatement& statement);
  void SetStated(const SourceLocation& place, double unit);
  /// Of a cutter's diameter as the file writes it.
  void TakeCutter(double diameter);
  bool used_key() const { return unstated_.has_value() && options_.unit.has_value(); }
  /// Throws InputError with a guess where lengths were read in a unit that nothing states.
  void Check(const std::string& name) const;
  /// "mm, by UNITS in line 3".
  std::string ToText() const;

 private:
  const CamReadOptions& options_;
  std::optional<SourceLocation> unstated_;  // the first length before UNITS
  std::optional<SourceLocation> stated_;    // the first UNITS
  double unit_ = 1;                         // mm, as stated
  std::optional<AptWord> mm_, inch_;        // first words of feeds
  double smallest_ = 0, largest_ = 0;       // cutters before UNITS, file units
};

}  // namespace millpose
