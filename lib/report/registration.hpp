// SPDX-License-Identifier: GPL-3.0-or-later
// What a report says of the part's registered place (docs/registration.md).
#pragma once

#include <optional>

namespace millpose {

/// How far the finished face may be off along its normal, since the part's place is known no better. mm
struct RegistrationFigures {
  double off_95 = 0;                ///< with 95 % probability no cut point is farther off
  double median_off = 0;            ///< in half of all cases
  double beside_95 = 0;             ///< across the normal, 95 % at the worst cut point
  std::optional<double> tolerance;  ///< that the job asks for
  std::optional<double> bent;       ///< largest at the cut points, of a part that its clamps bend
};

}  // namespace millpose
