// SPDX-License-Identifier: GPL-3.0-or-later
// A way is cut into parts so short that the external axes may stand in their middle: what they move a body by
// meanwhile is added to what is looked for. Slow (a world for every part), and needed for what is not proven
// otherwise alone.
#include "verify/ride_way.hpp"

#include "cell/station_way.hpp"
#include "robot/kinematics.hpp"
#include "verify/arm_bodies.hpp"

namespace millpose {
namespace {

constexpr double kStandingShare =
    0.25;  // of the resolution: how far a body may be from where it is looked at

ExternalPosition At(const RideWay& way, double share) {
  ExternalPosition external = way.from;
  for (size_t k = 0; k < external.size(); ++k) external[k] += share * (way.to[k] - way.from[k]);
  return external;
}

/// mm: no point that axis `axis` carries is farther from it at `external`.
double RadiusAbout(const Cell& cell, const RideWay& way, size_t axis, const ExternalPosition& external) {
  const auto [direction, place] = way.mechanism.LineOf(axis, external);
  const auto distance = [&, d = direction, p = place](const Eigen::Vector3d& point) {
    return d.cross(point - p).norm();
  };
  if (way.mechanism.axes()[axis].carries == Carries::kRobot) {
    const Pose X_WB = way.mechanism.Moved(Carries::kRobot, external) * cell.X_WB;
    double most = distance(X_WB.translation()) + ArmBodies(cell).reach();
    for (const Body& body : cell.bodies)
      if (body.mount == Mount::kCarriage)
        most = std::max(most, distance(way.mechanism.MovedWith(static_cast<size_t>(body.axis), external) *
                                       body.X_MG.translation()) +
                                  Radius(body.shape));
    return most;
  }
  const Pose X_WP = way.mechanism.Moved(Carries::kWorkpiece, external) * cell.X_WP;
  double most = 0;
  for (const Body& body : cell.bodies) {
    if (body.mount != Mount::kWorkpiece && body.mount != Mount::kCarriage) continue;
    const Pose X_WG = body.mount == Mount::kWorkpiece
                          ? X_WP * body.X_MG
                          : way.mechanism.MovedWith(static_cast<size_t>(body.axis), external) * body.X_MG;
    most = std::max(most, distance(X_WG.translation()) + Radius(body.shape));
  }
  return most;
}

/// Bound of what the external axes move any body by against any other on the whole way, mm.
double Travel(const Cell& cell, const RideWay& way) {
  double travel = 0;
  for (size_t k = 0; k < way.from.size(); ++k) {
    const double by = std::abs(way.to[k] - way.from[k]);
    if (by == 0) continue;
    if (way.mechanism.axes()[k].kind == AxisKind::kLinear) {
      travel += by;
      continue;
    }
    // Bodies on other axes come nearer to this one, or go farther off, by no more than these move them.
    travel += by * (RadiusAbout(cell, way, k, way.from) + travel);
  }
  return travel;
}

}  // namespace

std::optional<Interference> FindOnRide(const World& at_zero, const RideWay& way,
                                       const RideClearance& clearance) {
  const double allowed = kStandingShare * clearance.resolution, travel = Travel(at_zero.cell(), way);
  const StationWay standing(at_zero, way.joints.front().second, clearance.resolution);
  for (size_t i = 1; i < way.joints.size(); ++i) {
    const auto& [begin, q0] = way.joints[i - 1];
    const auto& [end, q1] = way.joints[i];
    const int parts = std::max(1, static_cast<int>(std::ceil(travel * (end - begin) / (2 * allowed))));
    for (int part = 0; part < parts; ++part) {
      const double first = static_cast<double>(part) / parts, last = static_cast<double>(part + 1) / parts;
      const ExternalPosition there = At(way, begin + (end - begin) * (first + last) / 2);
      Checker checker(at_zero.At(there), clearance.share, clearance.reserve + allowed);
      if (auto hit = checker.Between(q0 + first * (q1 - q0), q0 + last * (q1 - q0), Phase::kCutting,
                                     clearance.resolution - 2 * allowed))
        return hit;
      if (auto hit = standing.At(there)) return hit;
    }
  }
  return std::nullopt;
}

}  // namespace millpose
