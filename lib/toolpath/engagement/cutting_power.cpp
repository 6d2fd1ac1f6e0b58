// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/cutting_power.hpp"

#include <algorithm>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kWatts = 1e-3;  // of N·mm/s

}  // namespace

double CuttingPower(const EdgeModel& edge, const Engagement& cut, double feed, double spindle_speed) {
  constexpr int kParts = 180;
  if (cut.side == CutSide::kAir || cut.depth <= 0) return 0;
  const double radius = edge.cutter.radius;
  const double arc = cut.side == CutSide::kSlot ? kPi : Acos(std::clamp(1 - cut.width / radius, -1.0, 1.0));
  const double per_tooth = feed / (spindle_speed * edge.teeth);
  double sum = 0;  // of the force per mm of edge, N/mm
  for (int i = 0; i < kParts; ++i)
    sum += EdgeForce(edge, per_tooth * SinCos(arc * (i + 0.5) / kParts).sin).x();
  const double mean = edge.teeth * cut.depth * sum * (arc / kParts) / (2 * kPi);  // N, of all teeth
  return kWatts * mean * 2 * kPi * radius * spindle_speed;
}

double CuttingPower(const EngagementOptions& options, const Engagement& cut, double feed) {
  if (!options.drill) return CuttingPower(options.edge, cut, feed, options.spindle_speed);
  if (cut.side == CutSide::kAir) return 0;
  const double per_tooth = feed / (options.spindle_speed * options.drill->teeth);
  return kWatts * LoadOfDrill(*options.drill, cut.width, cut.depth, per_tooth).torque * 2 * kPi *
         options.spindle_speed;
}

}  // namespace millpose
