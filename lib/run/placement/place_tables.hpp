// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of placement.html.
#pragma once

#include "run/placement/place_results.hpp"

namespace millpose {

/// "x, mm", "a, °".
std::string CoordinateLabel(size_t coordinate);

/// Places that were planned whole.
std::string PlansTable(const FoundPlaces& placement, Language language);

/// How well a place must be met.
std::string NearbyTable(const std::vector<Sensitivity>& sensitivity, Language language);

/// The splits that were planned, and how well the stations of the recommended one must be met; empty where
/// one place was asked for.
std::string StationsSection(const FoundPlaces& placement, Language language);

}  // namespace millpose
