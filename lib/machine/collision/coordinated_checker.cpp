// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/coordinated_checker.hpp"

#include "machine/collision/world_impl.hpp"
#include "machine/robot/kinematics.hpp"
#include "machine/robot/position_between.hpp"

namespace millpose {
namespace {

/// Of the resolution: what is left for the axes' way. The arm's check takes the rest.
constexpr double kAxesShare = 0.25;

}  // namespace

struct CoordinatedChecker::Impl {
  World world;
  Mechanism mechanism;
  double clearance_share, reserve;
  /// How far from the origins of base and part their bodies reach at most, and carriages from their own, mm.
  double robot_reach = 0, part_reach = 0;
  std::vector<double> radii;  ///< of the cell's bodies
  CheckCounts counts;

  Impl(const World& at_zero, double share, double short_by)
      : world(at_zero), mechanism(at_zero.cell().external_axes), clearance_share(share), reserve(short_by) {
    const Cell& cell = world.cell();
    const LinkPoses links = FramesOf(cell, Joints::Zero());
    double flange = 0;  // by the links' lengths, which no joint changes
    for (size_t i = 1; i < links.size(); ++i)
      flange += (links[i].translation() - links[i - 1].translation()).norm();
    for (const Body& body : cell.bodies) {
      radii.push_back(Radius(body.shape));
      const double beyond = body.X_MG.translation().norm() + radii.back();
      if (body.mount == Mount::kLink) robot_reach = std::max(robot_reach, flange + beyond);
      if (body.mount == Mount::kTool)
        robot_reach = std::max(robot_reach, flange + cell.X_FT.translation().norm() + beyond);
      if (body.mount == Mount::kWorkpiece) part_reach = std::max(part_reach, beyond);
    }
  }

  /// Bound of how far anything that `carried` names, and the carriages on its way, move from where they are
  /// at `middle` while each axis goes by at most half of its way, mm.
  double Travel(Carries carried, const ExternalPosition& middle, const ExternalPosition& way) const {
    const bool robot = carried == Carries::kRobot;
    const Cell& cell = world.cell();
    const Eigen::Vector3d centre =
        mechanism.Moved(carried, middle) * Eigen::Vector3d((robot ? cell.X_WB : cell.X_WP).translation());
    double travel = 0;
    for (size_t k = mechanism.axes().size(); k-- > 0;) {
      const ExternalAxis& axis = mechanism.axes()[k];
      if (axis.carries != carried) continue;
      const double half = 0.5 * std::abs(way[k]);
      if (axis.kind == AxisKind::kLinear || half == 0) {
        travel += half;
        continue;
      }
      // A point turns by the angle times its distance from the axis, to which the axes behind have added.
      const Eigen::Vector3d origin = mechanism.LineOf(k, middle).second;
      double reach = (centre - origin).norm() + (robot ? robot_reach : part_reach);
      for (size_t i = 0; i < cell.bodies.size(); ++i) {
        const Body& body = cell.bodies[i];
        if (body.mount != Mount::kCarriage) continue;
        const auto on = static_cast<size_t>(body.axis);
        if (on < k || mechanism.axes()[on].carries != carried) continue;
        const Eigen::Vector3d place =
            mechanism.MovedWith(on, middle) * Eigen::Vector3d(body.X_MG.translation());
        reach = std::max(reach, (place - origin).norm() + radii[i]);
      }
      travel += half * (reach + travel);
    }
    return travel;
  }

  std::optional<CoordinatedContact> Look(const CoordinatedPose& from, const CoordinatedPose& to, Phase phase,
                                         double resolution, const Joints& tube) {
    const ExternalPosition middle = PositionBetween(from.external, to.external, 0.5);
    ExternalPosition way = to.external;
    for (size_t i = 0; i < way.size(); ++i) way[i] -= from.external[i];
    // Two bodies that hang on the same axes move against each other by no more than the inner ones move them.
    const double moved = Travel(Carries::kRobot, middle, way) + Travel(Carries::kWorkpiece, middle, way);
    // What keeps clearance + moved − share with the axes at the middle, less the arm's part of the
    // resolution, keeps clearance − resolution where they are.
    const double share = kAxesShare * resolution;
    Checker checker(world.At(middle), clearance_share, reserve + share - moved);
    const std::optional<ContactCandidate> found =
        checker.BlockedBetween(from.q, to.q, phase, resolution - share, tube);
    counts += checker.counts();
    if (!found) return std::nullopt;
    // What is nearer than clearance + moved − share there is, by the axes' way, nearer than the clearance
    // here.
    if (2 * moved <= share) return CoordinatedContact{*found, middle};
    const CoordinatedPose halfway{0.5 * (from.q + to.q), middle};
    Checker here(world.At(middle), clearance_share, reserve);
    const std::optional<ContactCandidate> met = here.Blocked(halfway.q, phase);
    counts += here.counts();
    if (met) return CoordinatedContact{*met, middle};
    auto first = Look(from, halfway, phase, resolution, tube);
    return first ? first : Look(halfway, to, phase, resolution, tube);
  }
};

CoordinatedChecker::CoordinatedChecker(const World& at_zero, double clearance_share, double reserve)
    : impl_(std::make_unique<Impl>(at_zero, clearance_share, reserve)) {}
CoordinatedChecker::~CoordinatedChecker() = default;
CoordinatedChecker::CoordinatedChecker(CoordinatedChecker&&) noexcept = default;

std::optional<CoordinatedContact> CoordinatedChecker::BlockedBetween(const CoordinatedPose& from,
                                                                     const CoordinatedPose& to, Phase phase,
                                                                     double resolution, const Joints& tube) {
  return impl_->Look(from, to, phase, resolution, tube);
}

Interference CoordinatedChecker::Measure(const CoordinatedContact& seen) const {
  return Checker(impl_->world.At(seen.external)).Measure(seen.sighting);
}

const CheckCounts& CoordinatedChecker::counts() const { return impl_->counts; }

}  // namespace millpose
