// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/rapid/rapid_configuration.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

constexpr double kBorder = 1e-3;                      // degrees
constexpr std::array<int, 3> kQuartered = {0, 3, 5};  // axes 1, 4, 6

int QuarterOf(double degrees) { return static_cast<int>(std::floor(degrees / 90)); }

}  // namespace

RapidConfiguration RapidConfigurationOf(const Arm& arm, const AxisConvention& axes, const Joints& q) {
  const Joints angles = axes.FromArm(q) * kDegPerRad;
  const int status = Status(arm, q);
  RapidConfiguration configuration{};
  for (size_t i = 0; i < kQuartered.size(); ++i) configuration[i] = QuarterOf(angles[kQuartered[i]]);
  // Status bit 1 is set where the elbow is bent downwards: the wrist centre is in front of the lower arm.
  configuration[3] = (angles[4] < 0 ? 1 : 0) | ((status & 2) != 0 ? 0 : 2) | ((status & 1) != 0 ? 4 : 0);
  return configuration;
}

bool FitsRapidConfiguration(const RapidConfiguration& given, const Arm& arm, const AxisConvention& axes,
                            const Joints& q) {
  const Joints angles = axes.FromArm(q) * kDegPerRad;
  const RapidConfiguration exact = RapidConfigurationOf(arm, axes, q);
  for (size_t i = 0; i < kQuartered.size(); ++i) {
    const double angle = angles[kQuartered[i]];
    if (given[i] != exact[i] && given[i] != QuarterOf(angle - kBorder) &&
        given[i] != QuarterOf(angle + kBorder))
      return false;
  }
  const int open = std::abs(angles[4]) <= kBorder ? 1 : 0;
  return (given[3] | open) == (exact[3] | open);
}

std::string RapidConfigurationText(const RapidConfiguration& c) {
  return fmt::format("[{},{},{},{}]", c[0], c[1], c[2], c[3]);
}

}  // namespace millpose
