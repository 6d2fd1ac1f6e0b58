// SPDX-License-Identifier: GPL-3.0-or-later
// How much of an uncertain deflection to take out, and how that runs along a cut (docs/compensation.md).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planning/compensation/interval.hpp"

namespace millpose {

/// How much of a deflection to take out, mm. With a `share` (0..1) that share of what is expected. Without
/// one the amount that makes the largest of what may remain, max(|low − x|, |high − x|), least among those
/// that leave no possible deflection larger than it is: between nothing and the expected, and never more than
/// twice the least that is sure. Nothing where not even the sign is sure.
double TakenOut(const Compensation::Along& deflection, std::optional<double> share);

/// Bounds how fast the amounts change along a cut by lowering them towards zero, never raising: `times[i]`
/// (s) from entry i to i + 1, `speed` in mm/s. A closed cut goes on from its last entry to its first, in the
/// last of `times`.
void LimitChange(std::span<double> amounts, std::span<const double> times, double speed, bool closed);

}  // namespace millpose
