// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/engagement/engagement.hpp"

namespace millpose {

/// What the edges take from the spindle on average, W: the tangential forces of EdgeForce() over the engaged
/// arc of an upright cylinder as wide and deep as the cut. `feed` in mm/s, `spindle_speed` in rev/s, above 0.
double CuttingPower(const EdgeModel& edge, const Engagement& cut, double feed, double spindle_speed);

/// The same of a job's cutter or drill, W. `feed` in mm/s.
double CuttingPower(const EngagementOptions& options, const Engagement& cut, double feed);

}  // namespace millpose
