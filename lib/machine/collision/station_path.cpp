// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/station_path.hpp"

#include "machine/collision/body_pairs.hpp"
#include "machine/collision/world_impl.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

/// Distances are asked for up to this much more than the clearance, mm.
constexpr double kNearPath = 200;

}  // namespace

struct StationPath::Impl {
  struct WayPair {
    size_t first, second;
    double clearance;
    bool standing;  ///< both stand still in passes
  };

  std::shared_ptr<const World::Impl> world;
  Mechanism mechanism;
  double resolution;
  std::vector<int> carrier;   ///< of each body: the external axis that it moves with, or kNoCarrier
  std::vector<Pose> at_zero;  ///< of each body's shape in W, with all external axes at 0
  std::vector<WayPair> pairs;

  Impl(std::shared_ptr<const World::Impl> of, const Joints& q, double allowed)
      : world(std::move(of)), mechanism(world->cell.external_axes), resolution(allowed) {
    const LinkPoses frames = FramesOf(world->cell, q);
    for (size_t i = 0; i < world->bodies.size(); ++i) {
      const WorldBody& body = world->bodies[i];
      carrier.push_back(CarrierOfBody(i));
      at_zero.push_back(body.link > 0 ? world->cell.X_WB * frames[static_cast<size_t>(body.link)] * body.X_LG
                                      : body.X_LG);
    }
    for (const BodyPair& pair : world->pairs)
      if (pair.clearance[0] && carrier[Index(pair.first)] != carrier[Index(pair.second)])
        pairs.push_back({Index(pair.first), Index(pair.second), *pair.clearance[0], false});
    AddStanding();
  }

  static size_t Index(int body) { return static_cast<size_t>(body); }

  int CarrierOfBody(size_t index) const {
    // Bodies that the world made itself hang on the tool.
    if (index >= world->cell.bodies.size()) return LastCarrier(mechanism.axes(), Carries::kRobot);
    return CarrierOf(mechanism.axes(), world->cell.bodies[index]);
  }

  /// Pairs that stand still in passes and move against each other on the way of external axes.
  void AddStanding() {
    const std::vector<Body>& bodies = world->cell.bodies;
    for (size_t i = 0; i < bodies.size(); ++i)
      for (size_t j = i + 1; j < bodies.size(); ++j)
        if (world->bodies[i].link == 0 && world->bodies[j].link == 0 &&
            !NeverChecked(world->cell, bodies[i], bodies[j]))
          pairs.push_back({i, j, world->cell.clearances.free, true});
  }

  std::vector<Placed> Place(const ExternalPosition& external) const {
    std::vector<Pose> moved;
    for (size_t i = 0; i < mechanism.axes().size(); ++i) moved.push_back(mechanism.MovedWith(i, external));
    std::vector<Placed> placed;
    for (size_t i = 0; i < world->bodies.size(); ++i)
      placed.push_back(PlacePart(*world->bodies[i].part, carrier[i] == kNoCarrier
                                                             ? at_zero[i]
                                                             : moved[Index(carrier[i])] * at_zero[i]));
    return placed;
  }

  /// Bound of how far any point of a body travels on the whole move, mm. An axis turns a point by its angle
  /// times the point's distance from it, to which the axes beyond add at most what they move it by.
  double Travel(size_t body, const Placed& start, const ExternalPosition& from,
                const ExternalPosition& to) const {
    double travel = 0;
    for (int axis = carrier[body]; axis != kNoCarrier; axis = CarrierOfAxis(mechanism.axes(), axis)) {
      const double way = std::abs(to[Index(axis)] - from[Index(axis)]);
      if (mechanism.axes()[Index(axis)].kind == AxisKind::kLinear) {
        travel += way;
        continue;
      }
      const Eigen::Vector3d origin = mechanism.LineOf(Index(axis), from).second;
      const double reach = (start.centre - origin).norm() + start.half_axes.cwiseAbs().rowwise().sum().norm();
      travel += way * (reach + travel);
    }
    return travel;
  }

  Interference Report(const WayPair& pair, const BoundedDistance& found) const {
    return {world->bodies[pair.first].name, world->bodies[pair.second].name, found.ends, found.distance};
  }
};

StationPath::StationPath(const World& at_zero, const Joints& q, double resolution)
    : impl_(std::make_unique<const Impl>(at_zero.impl_, q, resolution)) {}
StationPath::~StationPath() = default;

std::optional<Interference> StationPath::At(const ExternalPosition& external) const {
  const std::vector<Placed> placed = impl_->Place(external);
  for (const Impl::WayPair& pair : impl_->pairs) {
    if (!pair.standing) continue;
    const Placed &a = placed[pair.first], &b = placed[pair.second];
    const double wanted = std::max(pair.clearance, 1e-6);
    if (BoxesApart(a, b, wanted)) continue;
    const BoundedDistance found = DistanceUpTo(a, b, wanted);
    if (found.distance < wanted) return impl_->Report(pair, found);
  }
  return std::nullopt;
}

std::optional<Interference> StationPath::Between(const ExternalPosition& from,
                                                 const ExternalPosition& to) const {
  return Look(from, to, false);
}

std::optional<Interference> StationPath::StandingBetween(const ExternalPosition& from,
                                                         const ExternalPosition& to) const {
  return Look(from, to, true);
}

std::optional<Interference> StationPath::Look(const ExternalPosition& from, const ExternalPosition& to,
                                              bool standing) const {
  struct Interval {
    double begin, end;  // of the move's 0..1
    std::vector<size_t> pairs;
  };
  const std::vector<Placed> start = impl_->Place(from);
  std::vector<double> travel;
  for (size_t i = 0; i < start.size(); ++i) travel.push_back(impl_->Travel(i, start[i], from, to));
  std::vector<size_t> all;
  for (size_t i = 0; i < impl_->pairs.size(); ++i)
    if (!standing || impl_->pairs[i].standing) all.push_back(i);
  std::vector<Interval> open{{0, 1, std::move(all)}};
  while (!open.empty()) {
    const Interval interval = std::move(open.back());
    open.pop_back();
    const double middle = 0.5 * (interval.begin + interval.end), half = 0.5 * (interval.end - interval.begin);
    ExternalPosition at = from;
    for (size_t i = 0; i < at.size(); ++i) at[i] += middle * (to[i] - from[i]);
    const std::vector<Placed> placed = impl_->Place(at);
    std::vector<size_t> undecided;
    for (const size_t index : interval.pairs) {
      const Impl::WayPair& pair = impl_->pairs[index];
      const Placed &a = placed[pair.first], &b = placed[pair.second];
      const double clearance = std::max(pair.clearance, 1e-6);
      const double motion = half * (travel[pair.first] + travel[pair.second]);
      const double wanted = std::max(clearance, clearance - impl_->resolution + motion);
      if (BoxesApart(a, b, wanted)) continue;
      const BoundedDistance found = DistanceUpTo(a, b, std::min(wanted, clearance + kNearPath));
      if (found.distance < clearance) return impl_->Report(pair, found);
      if (found.distance < wanted) undecided.push_back(index);
    }
    if (undecided.empty()) continue;
    open.push_back({middle, interval.end, undecided});
    open.push_back({interval.begin, middle, std::move(undecided)});
  }
  return std::nullopt;
}

}  // namespace millpose
