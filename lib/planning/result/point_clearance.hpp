// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace millpose {

/// PlannedPoint::clearance is reported up to this, mm: farther is far enough.
inline constexpr double kPointClearanceBound = 50;

}  // namespace millpose
