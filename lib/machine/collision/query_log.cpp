// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/query_log.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/units.hpp"
#include "machine/collision/motion_bound.hpp"
#include "machine/collision/world.hpp"
#include "machine/collision/world_impl.hpp"
#include "machine/robot/compose.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

/// Poses whose joints differ by less than about this, rad, are put together: with all of it, what hangs on
/// the flange moves by some centimetres.
const std::array<double, 6> kTogether{DegToRad(1), DegToRad(1), DegToRad(1),
                                      DegToRad(4), DegToRad(4), DegToRad(10)};

constexpr double kFarthest = 1e7;  // mm: a body that far off is in no cell

/// The steps up to a value, so that what they hold is held.
int32_t Down(double value, double step) { return static_cast<int32_t>(std::floor(value / step)); }
int32_t Up(double value, double step) { return static_cast<int32_t>(std::ceil(value / step)); }

/// In which of the places that are put together a pose lies.
std::array<int16_t, 6> PlaceOf(const Joints& q) {
  std::array<int16_t, 6> place;
  for (size_t i = 0; i < 6; ++i)
    place[i] = static_cast<int16_t>(std::floor(q[static_cast<Eigen::Index>(i)] / kTogether[i]));
  return place;
}

Joints MiddleOf(const PoseBox& box) {
  Joints middle;
  for (size_t i = 0; i < 6; ++i)
    middle[static_cast<Eigen::Index>(i)] = kBoxAngle * (box.low[i] + 0.5 * box.width[i]);
  return middle;
}

}  // namespace

size_t QueryLog::Hash::operator()(const Place& place) const {
  uint64_t hash = 0;
  for (const int16_t at : place) {
    hash = (hash ^ static_cast<uint16_t>(at)) * 0x9e3779b97f4a7c15U;
    hash ^= hash >> 32U;
  }
  return hash;
}

void QueryLog::Widen(const Place& place, const PoseBox& box) {
  const auto [at, is_new] = boxes_.try_emplace(place, box);
  if (is_new) return;
  PoseBox& kept = at->second;
  for (size_t i = 0; i < 6; ++i) {
    const int32_t high = std::max(kept.low[i] + kept.width[i], box.low[i] + box.width[i]);
    kept.low[i] = std::min(kept.low[i], box.low[i]);
    kept.width[i] = high - kept.low[i];
  }
  kept.reach = std::max(kept.reach, box.reach);
}

void QueryLog::Add(const Joints& low, const Joints& high, double reach) {
  PoseBox box;
  for (size_t i = 0; i < 6; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    box.low[i] = Down(low[joint], kBoxAngle);
    box.width[i] = Up(high[joint], kBoxAngle) - box.low[i];
  }
  box.reach = Up(std::min(reach, kFarthest), kBoxLength);
  Widen(PlaceOf(0.5 * (low + high)), box);
}

void QueryLog::AddMotion(const Joints& q0, const Joints& q1, const Joints& beside, double reach) {
  double most = 0;
  for (size_t i = 0; i < 6; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    most = std::max(most, std::abs(q1[joint] - q0[joint]) / kTogether[i]);
  }
  // A long way by a box of its own would be one by all that lies between its corners.
  const int parts = std::max(1, static_cast<int>(std::ceil(most)));
  for (int k = 0; k < parts; ++k) {
    const Joints a = q0 + static_cast<double>(k) / parts * (q1 - q0),
                 b = k + 1 < parts ? Joints(q0 + static_cast<double>(k + 1) / parts * (q1 - q0)) : q1;
    Add(a.cwiseMin(b) - beside, a.cwiseMax(b) + beside, reach);
  }
}

void QueryLog::Take(const QueryLog& other) {
  const std::lock_guard lock(mutex_);
  for (const auto& [place, box] : other.boxes_) Widen(place, box);
  met_.insert(other.met_.begin(), other.met_.end());
}

void QueryLog::Take(const Queries& earlier) {
  const std::lock_guard lock(mutex_);
  for (const PoseBox& box : earlier.boxes) Widen(PlaceOf(MiddleOf(box)), box);
  met_.insert(earlier.met.begin(), earlier.met.end());
}

Queries QueryLog::Collected() const {
  // In one order, whatever the threads' was.
  std::vector<std::pair<Place, PoseBox>> sorted(boxes_.begin(), boxes_.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Queries looks;
  looks.boxes.reserve(sorted.size());
  for (const auto& [place, box] : sorted) looks.boxes.push_back(box);
  looks.met.assign(met_.begin(), met_.end());
  return looks;
}

namespace {

/// How often a box is halved where it is too wide to tell. More of it proves little more.
constexpr int kHalvings = 6;

/// A body of the arm and something that stands still.
struct Pair {
  const WorldBody* body;
  const Placed* still;
};

/// Tells what stays away from what stands still in all poses of a box.
class FarCheck {
 public:
  FarCheck(const Cell& cell, double reach) : cell_(cell), reach_(reach) {}

  /// Whether all pairs do. A box that is too wide to tell is halved for the pairs that are in doubt.
  bool Far(const Joints& middle, const Joints& half, const std::vector<Pair>& pairs, int halvings) const {
    const Joints turn = MostTurnOf(cell_, half);
    LinkPoses X_WL = FramesOf(cell_, middle);
    for (Pose& X : X_WL) X = Compose(cell_.X_WB, X);
    const JointAxes axes = AxesOf(X_WL);
    std::vector<Pair> doubtful;
    const WorldBody* placed = nullptr;
    std::optional<Placed> part;
    std::optional<double> about, moves;  // the wide bound and the narrower one, which costs more
    for (const Pair& pair : pairs) {
      const int link = pair.body->link;
      if (pair.body != placed) {
        placed = pair.body;
        part = PlacePart(*placed->part, Compose(X_WL[static_cast<size_t>(link)], placed->X_LG));
        about = BallMoves(axes, link, part->centre, part->part->radius, turn);
        moves.reset();
      }
      const Placed& still = *pair.still;
      if (ApartFromStill(still, *part, Bound(*about))) continue;
      if (!moves) moves = MotionBounds(axes, link, part->centre, part->half_axes, turn)[0];
      if (ApartFromStill(still, *part, Bound(*moves))) continue;
      // As seen from the body, what stands still moves as what hangs on the same link would there.
      if (ApartAlongAxes(*part, still, Bound(BallMoves(axes, link, still.centre, still.part->radius, turn))))
        continue;
      if (halvings == 0 || !BoxesApart(*part, still, reach_)) return false;
      doubtful.push_back(pair);
    }
    if (doubtful.empty()) return true;
    Eigen::Index widest = 0;
    for (Eigen::Index i = 1; i < 6; ++i)
      if (Width(half, i) > Width(half, widest)) widest = i;
    Joints narrower = half, off = Joints::Zero();
    narrower[widest] *= 0.5;
    off[widest] = narrower[widest];
    return Far(middle - off, narrower, doubtful, halvings - 1) &&
           Far(middle + off, narrower, doubtful, halvings - 1);
  }

 private:
  static double Width(const Joints& half, Eigen::Index joint) {
    return half[joint] / kTogether[static_cast<size_t>(joint)];
  }
  /// Gaps along the directions of one of two boxes are less at another pose, all three together by √3 times
  /// what one moves at most as seen from the other. A motion is looked at in ever shorter parts until they
  /// suffice: as long as they exceed the clearance, no part ends the check.
  double Bound(double moves) const { return reach_ + std::sqrt(3.0) * moves; }

  const Cell& cell_;
  double reach_;
};

}  // namespace

bool World::FarFrom(const std::vector<std::string>& still, const Queries& looks) const {
  std::vector<Placed> obstacles;
  for (const WorldBody& body : impl_->bodies) {
    if (body.link == 0 && std::find(still.begin(), still.end(), body.name) != still.end())
      obstacles.push_back(PlacePart(*body.part, body.X_LG));
  }
  std::vector<Pair> pairs;
  for (const WorldBody& body : impl_->bodies)
    for (const Placed& obstacle : obstacles)
      if (body.link != 0) pairs.push_back({&body, &obstacle});
  return std::ranges::all_of(looks.boxes, [&](const PoseBox& box) {
    Joints half;
    for (size_t i = 0; i < 6; ++i) half[static_cast<Eigen::Index>(i)] = 0.5 * kBoxAngle * box.width[i];
    return FarCheck(impl_->cell, kBoxLength * box.reach).Far(MiddleOf(box), half, pairs, kHalvings);
  });
}

}  // namespace millpose
