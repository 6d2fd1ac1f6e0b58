// SPDX-License-Identifier: GPL-3.0-or-later
// Feed where no material is near (docs/stock.md).
#pragma once

#include <vector>

#include "planning/result/plan_result.hpp"
#include "planning/result/stock_figures.hpp"
#include "toolpath/stock/in_air.hpp"

namespace millpose {

/// What the motions to the points meet, by pass and point; kCuts where a point begins a piece.
using AirCourse = std::vector<std::vector<InAir>>;

/// Raises the feeds of points whose motions, and their neighbours in one go over more than `longer_than`
/// (mm), are clear, to `feed` (mm/s) or what the axes can hold of it as ReduceFeeds() says. Feeds that are
/// higher stay, and so do those of lead-ins. Returns which were raised, by pass and point.
std::vector<std::vector<char>> RaiseFeedsInAir(const AirCourse& air, double feed, double longer_than,
                                               PlanResult& plan);

/// At the feeds that the plan now has. `raised` as above, or empty.
AirTime TimeInAir(const AirCourse& air, const std::vector<std::vector<char>>& raised, const PlanResult& plan);

}  // namespace millpose
