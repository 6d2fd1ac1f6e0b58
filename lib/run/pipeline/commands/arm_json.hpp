// SPDX-License-Identifier: GPL-3.0-or-later
// What `millpose check --json` says of a cell's arm; keys name their units.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "job/arrival.hpp"
#include "job/measured_arm.hpp"

namespace millpose {

/// A number that is kept in another unit: with `factor` the file's again.
inline double Rounded(double value, double factor) { return std::round(factor * value * 1e6) / 1e6; }

inline nlohmann::ordered_json RoundedOrNull(const std::optional<double>& value, double factor) {
  return value ? nlohmann::ordered_json(Rounded(*value, factor)) : nlohmann::ordered_json();
}

nlohmann::ordered_json ArrivalJson(const ArmArrival& arrival);

/// What nobody has measured is null.
nlohmann::ordered_json MeasuredJson(const MeasuredArm& measured);

}  // namespace millpose
