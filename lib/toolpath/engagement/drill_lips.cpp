// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/drill_lips.hpp"

#include <cassert>

#include "base/trig.hpp"

namespace millpose {

double DrillLips::Height(double radius) const {
  const auto [sine, cosine] = SinCos(0.5 * point_angle);
  return radius * cosine / sine;
}

DrillLoad LoadOfDrill(const DrillLips& lips, double width, double depth, double feed_per_tooth) {
  constexpr double kThrustShare = 0.63;  // of the force of cutting
  assert(feed_per_tooth > 0 && 2 * depth <= width * (1 + 1e-9));
  const double sine = SinCos(0.5 * lips.point_angle).sin;
  const double specific = lips.material.kc11 * Pow(feed_per_tooth * sine, -lips.material.mc);  // N/mm²
  const double per_mm = lips.teeth * feed_per_tooth * specific;  // N per mm of radius, all lips
  const double outer = 0.5 * width, inner = outer - depth;
  return {kThrustShare * sine * per_mm * depth, 0.5 * per_mm * (outer * outer - inner * inner)};
}

}  // namespace millpose
