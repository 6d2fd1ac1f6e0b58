// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/time_law.hpp"

#include <limits>

namespace millpose {

double TimeLaw::Share(double time) const {
  if (time <= 0) return 0;
  if (time >= duration) return 1;
  const double rise = speed / acceleration;
  if (time < rise) return 0.5 * acceleration * time * time;
  const double left = duration - time;
  if (left < rise) return 1 - 0.5 * acceleration * left * left;
  return speed * (time - 0.5 * rise);
}

TimeLaw FastestLaw(const Joints& delta, const Joints& speed, const Joints& acceleration) {
  assert(speed.minCoeff() > 0 && acceleration.minCoeff() > 0);
  TimeLaw law;
  double v = std::numeric_limits<double>::infinity(), a = v;
  for (int i = 0; i < 6; ++i) {
    if (delta[i] == 0) continue;
    v = std::min(v, speed[i] / std::abs(delta[i]));
    a = std::min(a, acceleration[i] / std::abs(delta[i]));
  }
  if (std::isinf(v)) return law;
  law.acceleration = a;
  law.speed = std::min(v, std::sqrt(a));  // a short way is over before the full speed is reached
  law.duration = 1 / law.speed + law.speed / a;
  return law;
}

double PathDuration(std::span<const Joints> corners, const Joints& speed, const Joints& acceleration) {
  double duration = 0;
  for (size_t i = 1; i < corners.size(); ++i) {
    duration += FastestLaw(corners[i] - corners[i - 1], speed, acceleration).duration;
  }
  return duration;
}

}  // namespace millpose
