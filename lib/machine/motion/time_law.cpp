// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/time_law.hpp"

#include <limits>

namespace millpose {

double TimeLaw::Share(double time) const {
  if (time <= 0) return 0;
  if (time >= duration) return 1;
  const double rise = from_rest && acceleration > 0 ? speed / acceleration : 0;
  const double fall = to_rest && acceleration > 0 ? speed / acceleration : 0;
  if (time < rise) return 0.5 * acceleration * time * time;
  const double left = duration - time;
  if (left < fall) return 1 - 0.5 * acceleration * left * left;
  return speed * (time - 0.5 * rise);
}

double TimeLaw::Rate(double time) const {
  if (duration <= 0) return 0;
  const double rising = from_rest && acceleration > 0 ? acceleration * std::max(0.0, time) : speed;
  const double falling = to_rest && acceleration > 0 ? acceleration * std::max(0.0, duration - time) : speed;
  return std::min({speed, rising, falling});
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

TimeLaw FeedLaw(double seconds, double ramp, bool from_rest, bool to_rest) {
  assert(seconds > 0 && ramp >= 0);
  TimeLaw law{1 / seconds, ramp > 0 ? 1 / (seconds * ramp) : 0, seconds, from_rest, to_rest};
  const int ramps = ramp > 0 ? int{from_rest} + int{to_rest} : 0;
  if (ramps == 0) return law;
  if (0.5 * ramp * ramps <= seconds) {
    law.duration = seconds + 0.5 * ramp * ramps;
  } else {  // it never reaches its speed: each ramp has its part of the way, speed²/2 ÷ acceleration
    law.speed = std::sqrt(2 * law.acceleration / ramps);
    law.duration = ramps * law.speed / law.acceleration;
  }
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
