// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/place_part.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/rotation.hpp"
#include "job/assemble.hpp"
#include "machine/collision/world.hpp"
#include "machine/robot/make_pose.hpp"
#include "planning/pose/scorer.hpp"
#include "program/controller_axes.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr size_t kPoints = 9;      // of a tool path that are looked at
constexpr int kRotations = 36;     // about the tool axis, at each
constexpr int kRoomEnough = 24;    // of the rotations: more is no reason to leave the usual places
constexpr size_t kClearPoses = 3;  // wanted at each: one alone leaves nothing to move on to

Vector3d Across(const Vector3d& v, const Vector3d& unit) { return v - v.dot(unit) * unit; }

/// The axis of P that lies most nearly across `direction`; z before x before y.
Vector3d CrossAxis(const Vector3d& direction) {
  for (const Vector3d& axis : {Vector3d::UnitZ().eval(), Vector3d::UnitX().eval(), Vector3d::UnitY().eval()})
    if (std::abs(axis.dot(direction)) < 0.6) return Across(axis, direction).normalized();
  return Across(Vector3d::UnitY(), direction).normalized();
}

/// To numbers that a file can hold.
Pose Rounded(const Pose& X) {
  PoseSettings settings{X.translation(), AnglesZyx(X.linear())};
  for (int k = 0; k < 3; ++k) {
    settings.position[k] = std::round(settings.position[k] * 10) / 10 + 0.0;
    settings.abc[k] = DegToRad(std::round(RadToDeg(settings.abc[k]) * 1000) / 1000 + 0.0);
  }
  return MakePose(settings);
}

/// Horizontal, the way the arm's tool lies at home, to a quarter turn.
Vector3d Front(const Cell& cell, const Joints& home) {
  const Pose X_WT = cell.X_WB * ForwardFlange(cell.arm, home) * cell.X_FT;
  const Vector3d out = X_WT.translation() - cell.X_WB.translation();
  if (std::abs(out.x()) >= std::abs(out.y())) return {out.x() < 0 ? -1.0 : 1.0, 0, 0};
  return {0, out.y() < 0 ? -1.0 : 1.0, 0};
}

/// The part's lowest place in W.
double LowestPlace(const ImportReport& part, const Pose& X_WP) {
  double lowest = std::numeric_limits<double>::max();
  for (int corner = 0; corner < 8; ++corner) {
    Vector3d p = part.lower;
    for (int k = 0; k < 3; ++k)
      if ((corner >> k) & 1) p[k] = part.upper[k];
    lowest = std::min(lowest, (X_WP * p).z());
  }
  return lowest;
}

std::vector<const MillingPoint*> SomePoints(const Toolpath& toolpath, std::vector<const Pass*>& passes) {
  std::vector<const MillingPoint*> all, some;
  std::vector<const Pass*> of;
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points) {
      all.push_back(&point);
      of.push_back(&pass);
    }
  const size_t count = std::min(kPoints, all.size());
  for (size_t i = 0; i < count; ++i) {
    const size_t at = count == 1 ? 0 : i * (all.size() - 1) / (count - 1);
    some.push_back(all[at]);
    passes.push_back(of[at]);
  }
  return some;
}

class Trial {
 public:
  Trial(const JobInputs& inputs, const Mesh& mesh, const Toolpath& toolpath)
      : inputs_(inputs),
        mesh_(mesh),
        toolpath_(toolpath),
        cell_(MakeCell(inputs.cell, inputs.body_bytes)),
        problem_(MakePoseProblem(inputs.job, inputs.cell, cell_)) {
    for (int i = 0; i < kRotations; ++i) rotations_.push_back({2 * kPi * i / kRotations});
  }

  /// Of the rotations how many are admissible at the point that has fewest.
  int Room(const Placement& placement) const {
    int least = kRoomEnough;
    ForEachPoint(placement, [&](const std::vector<Candidate>& candidates) {
      int room = 0;
      for (size_t i = 0; i < rotations_.size(); ++i)
        room += std::any_of(candidates.begin() + 8 * static_cast<long>(i),
                            candidates.begin() + 8 * static_cast<long>(i) + 8,
                            [](const Candidate& c) { return c.obstacle == Infeasibility::kNone; });
      least = std::min(least, room);
      return least > 0;
    });
    return least;
  }

  /// Whether home and some poses at every point are clear of the cell.
  bool IsClear(const Placement& placement) {
    if (!world_) {  // trees over the bodies' triangles are built once, the part is moved
      Cell cell = cell_;
      cell.X_WP = placement.X_WP;
      AddWorkpiece(inputs_, mesh_.triangles(), &cell);
      world_.emplace(std::move(cell));
    }
    const World world = world_->With(cell_.X_WB, placement.X_WP);
    Checker checker(world);
    if (checker.Blocked(inputs_.cell.home, Phase::kFree)) return false;
    bool clear = true;
    ForEachPoint(placement, [&](const std::vector<Candidate>& candidates) {
      size_t free = 0;
      for (size_t i = 0; i < candidates.size() && free < kClearPoses; ++i)
        free += candidates[i].obstacle == Infeasibility::kNone &&
                !checker.Blocked(candidates[i].q, Phase::kCutting);
      return clear = free == kClearPoses;
    });
    return clear;
  }

 private:
  template <class Look>
  void ForEachPoint(const Placement& placement, const Look& look) const {
    const Toolpath placed = PlacedToolpath(inputs_, toolpath_, placement.X_WP);
    std::vector<const Pass*> passes;
    const std::vector<const MillingPoint*> points = SomePoints(placed, passes);
    std::vector<Candidate> candidates(8 * rotations_.size());
    for (size_t i = 0; i < points.size(); ++i) {
      PointScorer(problem_, *points[i], passes[i]->rotation_reference).Score(rotations_, candidates);
      if (!look(candidates)) return;
    }
  }

  const JobInputs& inputs_;
  const Mesh& mesh_;
  const Toolpath& toolpath_;
  Cell cell_;
  PoseProblem problem_;
  std::vector<FreedomValues> rotations_;
  std::optional<World> world_;  ///< with the part at the first place that was asked for
};

}  // namespace

GroupSides SidesOf(const FacingGroup& group) {
  const Vector3d u = CrossAxis(group.direction), v = group.direction.cross(u);
  const auto extent = [&](const Vector3d& axis) { return (group.upper - group.lower).dot(axis.cwiseAbs()); };
  if (extent(u) >= extent(v)) return {u, v, extent(u), extent(v)};
  return {v, u, extent(v), extent(u)};
}

std::vector<Placement> LikelyPlacements(const FacingGroup& group, const ImportReport& part, const Cell& cell,
                                        const Joints& home) {
  const double reach = Reach(cell);
  const Vector3d front = Front(cell, home), up = Vector3d::UnitZ();
  const Vector3d across = CrossAxis(group.direction);
  const bool small = (part.upper - part.lower).maxCoeff() < 0.2 * reach;
  Eigen::Matrix3d of_part;
  of_part << group.direction, across, group.direction.cross(across);
  std::vector<Placement> placements;
  for (const bool upright : {!small, small}) {
    const Vector3d outward = upright ? Vector3d(-front) : up;
    for (const int quarter : {0, 1, 2, 3})
      for (const double distance : {0.65, 0.55, 0.75, 0.45})
        for (const double height : {0.35, 0.25, 0.45, 0.15}) {
          const Vector3d side = RotationAbout(outward, quarter * kPi / 2) * (upright ? up : front);
          Eigen::Matrix3d of_world;
          of_world << outward, side, outward.cross(side);
          Placement placement;
          placement.upright = upright;
          placement.X_WP.linear() = of_world * of_part.transpose();
          const Vector3d place = cell.X_WB.translation() + std::round(reach * distance / 10) * 10 * front +
                                 std::round(reach * height / 10) * 10 * up;
          placement.X_WP.translation() = place - placement.X_WP.linear() * group.seed;
          placement.X_WP = Rounded(placement.X_WP);
          // Nobody sinks a part into the floor that could stand on it.
          if (small && LowestPlace(part, placement.X_WP) < 0) continue;
          placements.push_back(placement);
        }
  }
  return placements;
}

std::vector<Placement> ReachedPlacements(const JobInputs& inputs, const Mesh& mesh, const Toolpath& toolpath,
                                         const std::vector<Placement>& placements, size_t most,
                                         const std::stop_token& stop) {
  Trial trial(inputs, mesh, toolpath);
  std::vector<std::pair<int, size_t>> rooms;
  for (size_t i = 0; i < placements.size(); ++i) {
    if (stop.stop_requested()) throw Interrupted();
    if (const int room = trial.Room(placements[i]); room > 0) rooms.emplace_back(room, i);
  }
  std::ranges::stable_sort(rooms, std::greater{}, &std::pair<int, size_t>::first);
  std::vector<Placement> reached;
  for (const auto& [room, i] : rooms) {
    if (stop.stop_requested()) throw Interrupted();
    if (reached.size() == most) break;
    if (trial.IsClear(placements[i])) reached.push_back(placements[i]);
  }
  return reached;
}

}  // namespace millpose
