// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/gain.hpp"

#include "base/random.hpp"
#include "base/trig.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr int kDraws = 200;

/// A compensated point: what each part of the compliance moves along the normal per newton.
struct Place {
  std::array<Vector3d, ComplianceParts::kParts> parts;
  Vector3d normal, force;
  double taken;
};

std::vector<Place> PlacesOf(const CompensationOptions& options, const PlanResult& plan) {
  std::vector<Place> places;
  for (const PassResult& pass : plan.passes) {
    Eigen::Matrix3d R_BW = BaseAt(plan, pass.external).linear().transpose();
    std::vector<SeriesCompliance> beside = CompliancesAt(plan, pass.external, options.beside);
    for (const PlannedPoint& point : pass.points) {
      if (!point.compensation || point.compensation->normal.taken == 0) continue;
      if (point.external) {
        R_BW = BaseAt(plan, *point.external).linear().transpose();
        beside = CompliancesAt(plan, *point.external, options.beside);
      }
      const ComplianceParts parts(plan.arm, point.q, plan.X_FT.translation(), beside);
      const Vector3d normal = R_BW * point.point.normal;
      places.push_back({parts.Towards(normal), normal, R_BW * point.compensation->force,
                        point.compensation->normal.taken});
    }
  }
  return places;
}

/// An arm and a force that may be.
struct Truth {
  std::array<double, ComplianceParts::kParts> softer{};
  double length = 1;
  SineCosine off{}, azimuth{};

  Truth(const CompensationOptions& options, uint64_t draw) {
    RandomStream random(0x636f6d70, draw);  // a stream of its own
    for (size_t i = 0; i < softer.size(); ++i) {
      const double share =
          i < 6 ? options.stiffness.joints[static_cast<Eigen::Index>(i)] : options.stiffness.beside;
      softer[i] = 1 / (1 + random.Uniform(-share, share));
    }
    length = random.Uniform(std::max(0.0, 1 - options.force.length), 1 + options.force.length);
    off = SinCos(random.Uniform(0, options.force.angle));
    azimuth = SinCos(random.Uniform(0, 2 * kPi));
  }

  double Error(const Place& place) const {
    Vector3d g = Vector3d::Zero();
    for (size_t i = 0; i < softer.size(); ++i) g += softer[i] * place.parts[i];
    const Vector3d along = place.force.normalized();
    Vector3d side = place.normal - place.normal.dot(along) * along;
    side = side.norm() > 1e-6 ? side.normalized() : along.unitOrthogonal();
    const Vector3d towards = azimuth.cos * side + azimuth.sin * along.cross(side);
    return length * place.force.norm() * g.dot(off.cos * along + off.sin * towards);
  }
};

}  // namespace

std::optional<double> MedianRemains(const CompensationOptions& options, const PlanResult& plan) {
  const std::vector<Place> places = PlacesOf(options, plan);
  std::vector<double> remains;
  for (uint64_t draw = 0; draw < kDraws; ++draw) {
    const Truth truth(options, draw);
    for (const Place& place : places)
      if (const double error = truth.Error(place); error != 0)
        remains.push_back(std::abs((error - place.taken) / error));
  }
  if (remains.empty()) return std::nullopt;
  const auto middle = remains.begin() + static_cast<std::ptrdiff_t>(remains.size() / 2);
  std::ranges::nth_element(remains, middle);
  return *middle;
}

}  // namespace millpose
