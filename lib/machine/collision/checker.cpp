// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "machine/collision/motion_bound.hpp"
#include "machine/collision/world_impl.hpp"
#include "machine/robot/compose.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

/// Two bodies nearer than this touch, mm; FCL's own distances are no better.
constexpr double kTouch = 1e-6;
/// What is seen to be nearer than wanted by this much, mm, needs no distance: FCL would find the same.
constexpr double kSure = 1e-5;
/// Between poses, distances are asked for up to this much more than the clearance, mm.
constexpr double kNearby = 15;

}  // namespace

struct Checker::Impl {
  std::shared_ptr<const World::Impl> world;
  std::vector<Placed> placed;  ///< the bodies at the pose last asked for, or some of them
  LinkPoses X_WL;              ///< the links at that pose
  CheckCounts counts;

  const double share, reserve;  ///< of the clearances; mm less than that

  std::shared_ptr<QueryLog> keeper;  ///< is told `looks` in the end; null: nobody asks
  QueryLog looks;

  Impl(std::shared_ptr<const World::Impl> shared, double clearance_share, double clearance_reserve)
      : world(std::move(shared)), share(clearance_share), reserve(clearance_reserve) {
    for (const WorldBody& body : world->bodies) placed.push_back(PlacePart(*body.part, body.X_LG));
  }
  ~Impl() {
    if (keeper) keeper->Take(looks);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void MoveTo(const Joints& q) {
    ++counts.poses;
    ++counts.looks;
    Place(q);
  }

  /// Takes note of a question about the poses between q0 and q1, each joint up to `tube` beside them. What
  /// stands still keeps `Clearances::free`, whatever the arm does.
  void Look(const Joints& q0, const Joints& q1, const Joints& tube) {
    if (!keeper) return;
    // The last interval that is looked at for the tube's sake reaches a little beyond (BlockedBetween), and
    // is settled where all that lies within it is.
    const Joints beside = tube.array() + kSmallBesideTube * tube.maxCoeff();
    const double moves = world->span * ((MostTurnOf(world->cell, beside).array() + 1).prod() - 1);
    looks.AddMotion(q0, q1, beside, world->cell.clearances.free + moves);
  }

  /// Takes note of an answer.
  void Tell(int pair) {
    if (!keeper) return;
    const WorldBody& first =
        world->bodies[static_cast<size_t>(world->pairs[static_cast<size_t>(pair)].first)];
    if (first.link == 0) looks.Meet(first.name);
  }

  void Place(const Joints& q) {
    PlaceLinks(q);
    for (size_t i = 0; i < placed.size(); ++i) PlaceBody(i);
  }
  void PlaceLinks(const Joints& q) {
    X_WL = FramesOf(world->cell, q);
    for (Pose& X : X_WL) X = Compose(world->cell.X_WB, X);
  }
  void PlaceBody(size_t i) {
    const WorldBody& body = world->bodies[i];
    if (body.link > 0) placed[i] = PlacePart(*body.part, Compose(X_WL[body.link], body.X_LG));
  }

  /// Whether a pair is proven to be `bound` apart, without its distance.
  bool IsApart(const BodyPair& pair, double bound) const {
    const Placed &a = placed[pair.first], &b = placed[pair.second];
    return !world->measures_all && (BoxesApart(a, b, bound) || ProvenDistance(a, b, bound, bound) >= bound);
  }

  BoundedDistance Distance(const BodyPair& pair, double bound) const {
    if (IsApart(pair, bound)) return {bound};
    return DistanceUpTo(placed[pair.first], placed[pair.second], bound);
  }

  double Wanted(const BodyPair& pair, int phase) const {
    return std::max(share * *pair.clearance[phase] - reserve, kTouch);
  }

  /// Whether a pair is nearer than `bound` at the pose moved to.
  bool Nearer(const BodyPair& pair, double bound) const {
    if (IsApart(pair, bound)) return false;
    const Placed &a = placed[pair.first], &b = placed[pair.second];
    const DistanceBracket certain = Bracket(pair, bound, bound - kSure);
    if (certain.most < bound - kSure) return true;
    if (certain.least >= bound) return false;
    return DistanceUpTo(a, b, bound).distance < bound;
  }

  DistanceBracket Bracket(const BodyPair& pair, double bound, double near) const {
    if (world->measures_all) return {0, std::numeric_limits<double>::infinity()};
    return BracketOf(placed[pair.first], placed[pair.second], bound, near);
  }

  /// Where the distance of a pair lies: below its clearance, from there on below what settles it, or beyond.
  enum class Gap : uint8_t { kTooNear, kOpen, kWide };

  /// The answer is that of the distance itself, whatever proves it first, so that a motion is cut up the same
  /// way whatever is tried before. Distances to far meshes cost more than looking at shorter parts of the
  /// motion: where more than kNearby is wanted, only the boxes settle a pair.
  Gap Compare(const BodyPair& pair, double clearance, double wanted) const {
    const Placed &a = placed[pair.first], &b = placed[pair.second];
    const bool far = wanted > clearance + kNearby;
    if ((far || !world->measures_all) && BoxesApart(a, b, wanted)) return Gap::kWide;
    if (far) return Nearer(pair, clearance) ? Gap::kTooNear : Gap::kOpen;
    const double least = world->measures_all ? 0 : ProvenDistance(a, b, wanted, clearance);
    if (least >= wanted) return Gap::kWide;
    const DistanceBracket certain = Bracket(pair, wanted, clearance - kSure);
    if (certain.most < clearance - kSure) return Gap::kTooNear;
    if (certain.least >= wanted) return Gap::kWide;
    if (std::max(least, certain.least) >= clearance && certain.most < wanted - kSure) return Gap::kOpen;
    const double distance = DistanceUpTo(a, b, wanted).distance;
    // The distance of two convex parts may come out too small: what boxes prove is not too near (FarFrom).
    if (distance < clearance) return BoxesApart(a, b, clearance) ? Gap::kOpen : Gap::kTooNear;
    return distance < wanted ? Gap::kOpen : Gap::kWide;
  }

  Interference Report(const BodyPair& pair, const BoundedDistance& found) const {
    return {world->bodies[pair.first].name, world->bodies[pair.second].name, found.ends, found.distance};
  }

  /// What is known of a body during the motion that is looked at.
  struct Moved {
    bool here = false;  ///< placed; of what was divided from longer motions few bodies are asked about
    double ball = -1;   ///< BallMoves(), mm
    std::optional<std::array<double, 7>> bounds;  ///< MotionBounds(), mm
  };
  std::vector<Moved> moved;  ///< a body each

  /// What may settle a pair.
  enum class Proof : uint8_t { kBoxes, kDistance };

  std::optional<ContactCandidate> Certify(const Joints& middle, const Joints& half_turn, int phase,
                                          double resolution, const std::vector<int>& pairs, Proof proof,
                                          std::vector<int>& undecided);
  std::vector<int> PairsIn(int phase) const;
  std::optional<ContactCandidate> BlockedBetween(const Joints& q0, const Joints& q1, int phase,
                                                 double resolution, const Joints& tube,
                                                 const std::vector<int>& pairs);
  std::optional<ContactCandidate> BlockedAlong(std::span<const Joints> line, int phase, double resolution,
                                               std::vector<int> pairs);
};

Checker::Checker(const World& world, double clearance_share, double reserve)
    : impl_(std::make_unique<Impl>(world.impl_, clearance_share, reserve)) {
  impl_->keeper = world.keeper_;
}
Checker::~Checker() = default;
Checker::Checker(Checker&&) noexcept = default;

const CheckCounts& Checker::counts() const { return impl_->counts; }

CheckCounts& CheckCounts::operator+=(const CheckCounts& other) {
  poses += other.poses;
  looks += other.looks;
  pairs += other.pairs;
  pairs_saved += other.pairs_saved;
  return *this;
}

Interference Checker::Measure(const ContactCandidate& sighting) {
  impl_->Place(sighting.q);
  const BodyPair& pair = impl_->world->pairs[sighting.pair];
  return impl_->Report(pair, impl_->Distance(pair, sighting.bound));
}

std::optional<Interference> Checker::At(const Joints& q, Phase phase) {
  const std::optional<ContactCandidate> found = Blocked(q, phase);
  return found ? std::optional(Measure(*found)) : std::nullopt;
}

std::optional<ContactCandidate> Checker::Blocked(const Joints& q, Phase phase) {
  impl_->MoveTo(q);
  impl_->Look(q, q, Joints::Zero());
  const std::vector<BodyPair>& pairs = impl_->world->pairs;
  for (int index = 0; index < static_cast<int>(pairs.size()); ++index) {
    if (!pairs[index].clearance[static_cast<int>(phase)]) continue;
    const double wanted = impl_->Wanted(pairs[index], static_cast<int>(phase));
    if (!impl_->Nearer(pairs[index], wanted)) continue;
    impl_->Tell(index);
    return ContactCandidate{q, index, wanted};
  }
  return std::nullopt;
}

std::optional<ContactCandidate> Checker::Blocked(const Joints& q, Phase phase,
                                                 const std::vector<double>& freedoms, PointMemory& memory) {
  if (impl_->world->measures_all) return Blocked(q, phase);
  impl_->MoveTo(q);
  impl_->Look(q, q, Joints::Zero());
  const std::array<PointMemory::Entry*, 4> entries = memory.Entries(freedoms, q);
  const std::vector<BodyPair>& pairs = impl_->world->pairs;
  for (int index = 0; index < static_cast<int>(pairs.size()); ++index) {
    if (!pairs[index].clearance[static_cast<int>(phase)]) continue;
    PointMemory::Entry* entry = entries[static_cast<size_t>(pairs[index].kind)];
    if (entry && entry->known) {
      ++impl_->counts.pairs_saved;
      if (entry->found.pair != index) continue;
      impl_->Tell(index);
      return entry->found;
    }
    ++impl_->counts.pairs;
    const double wanted = impl_->Wanted(pairs[index], static_cast<int>(phase));
    if (!impl_->Nearer(pairs[index], wanted)) continue;
    impl_->Tell(index);
    const ContactCandidate found{q, index, wanted};
    // The first of its kind: those before were looked at.
    if (entry) *entry = {true, found};
    return found;
  }
  for (PointMemory::Entry* entry : entries) {
    if (entry) entry->known = true;
  }
  return std::nullopt;
}

double Checker::Clearance(const Joints& q, Phase phase, double bound) {
  const std::optional<Interference> nearest = Nearest(q, phase, bound);
  return nearest ? nearest->distance : bound;
}

std::optional<Interference> Checker::Nearest(const Joints& q, Phase phase, double bound) {
  impl_->MoveTo(q);
  std::vector<std::pair<double, const BodyPair*>> nearest;
  double most = bound;  // of the smallest distance
  for (const BodyPair& pair : impl_->world->pairs) {
    if (!pair.clearance[static_cast<int>(phase)]) continue;
    const Placed &a = impl_->placed[pair.first], &b = impl_->placed[pair.second];
    if (!impl_->world->measures_all && BoxesApart(a, b, most)) continue;
    // Two shapes bound nothing: how far a part is that a mesh swallows depends on the bound (DistanceUpTo).
    DistanceBracket certain{0, std::numeric_limits<double>::infinity()};
    if (a.part->mesh() || b.part->mesh()) certain = impl_->Bracket(pair, most, 0);
    most = std::min(most, certain.most + kSure);
    const double apart = impl_->world->measures_all ? 0 : BoxDistance(a, b);
    nearest.emplace_back(std::max(apart, certain.least), &pair);
  }
  std::sort(nearest.begin(), nearest.end());
  const BodyPair* best = nullptr;
  BoundedDistance smallest{bound};
  // The nearer FCL is told to look, the fewer triangles it does look at.
  const auto measure_below = [&](double limit) {
    for (const auto& [least, pair] : nearest) {
      const double below = std::min(smallest.distance, limit);
      if (smallest.distance <= kTouch || least >= below) break;
      const BoundedDistance found = impl_->Distance(*pair, below);
      if (found.distance < below) smallest = found, best = pair;
    }
  };
  measure_below(most);
  if (!best && most < bound) measure_below(bound);  // FCL finds farther what the brackets saw nearer
  if (best) impl_->Tell(static_cast<int>(best - impl_->world->pairs.data()));
  if (impl_->keeper) impl_->looks.Add(q, q, smallest.distance);
  return best ? std::optional(impl_->Report(*best, smallest)) : std::nullopt;
}

/// Looks at the middle of a motion during which the controller turns no joint by more than `half_turn` from
/// it. Pairs that this does not settle for the whole motion go to `undecided`.
std::optional<ContactCandidate> Checker::Impl::Certify(const Joints& middle, const Joints& half_turn,
                                                       int phase, double resolution,
                                                       const std::vector<int>& pairs, Proof proof,
                                                       std::vector<int>& undecided) {
  ++counts.looks;
  PlaceLinks(middle);
  const JointAxes axes = AxesOf(X_WL);
  const Joints most = MostTurnOf(world->cell, half_turn);
  moved.assign(placed.size(), {});
  for (int index : pairs) {
    const BodyPair& pair = world->pairs[index];
    const WorldBody& body = world->bodies[pair.second];
    for (const auto i : {static_cast<size_t>(pair.first), static_cast<size_t>(pair.second)})
      if (!std::exchange(moved[i].here, true)) PlaceBody(i);
    const Placed& at = placed[pair.second];
    auto& [here, ball, bounds] = moved[pair.second];
    const double clearance = Wanted(pair, phase);
    // Most pairs are so far apart that the wider bound settles them, as the narrower one would.
    if (ball < 0) ball = BallMoves(axes, body.link, at.centre, at.part->radius, most) + kSure;
    if (!world->measures_all && BoxesApart(placed[pair.first], at, clearance + ball)) continue;
    if (!bounds) bounds = MotionBounds(axes, body.link, at.centre, at.half_axes, most);
    const double motion = (*bounds)[world->bodies[pair.first].link];
    // What settles the pair for the whole motion: even the worst movement leaves clearance − resolution.
    const double wanted = std::max(clearance, clearance - resolution + motion);
    const Gap gap = proof == Proof::kDistance       ? Compare(pair, clearance, wanted)
                    : IsApart(pair, wanted + kSure) ? Gap::kWide
                                                    : Gap::kOpen;
    if (gap == Gap::kTooNear) return ContactCandidate{middle, index, std::min(wanted, clearance + kNearby)};
    if (gap == Gap::kOpen) undecided.push_back(index);
  }
  return std::nullopt;
}

std::optional<Interference> Checker::Between(const Joints& q0, const Joints& q1, Phase phase,
                                             double resolution, const Joints& tube) {
  const std::optional<ContactCandidate> found = BlockedBetween(q0, q1, phase, resolution, tube);
  return found ? std::optional(Measure(*found)) : std::nullopt;
}

std::vector<int> Checker::Impl::PairsIn(int phase) const {
  std::vector<int> all;
  for (size_t i = 0; i < world->pairs.size(); ++i) {
    if (world->pairs[i].clearance[phase]) all.push_back(static_cast<int>(i));
  }
  return all;
}

std::optional<ContactCandidate> Checker::BlockedBetween(const Joints& q0, const Joints& q1, Phase phase,
                                                        double resolution, const Joints& tube) {
  const int phase_index = static_cast<int>(phase);
  return impl_->BlockedBetween(q0, q1, phase_index, resolution, tube, impl_->PairsIn(phase_index));
}

/// `pairs`: those that may be too near anywhere on the motion.
std::optional<ContactCandidate> Checker::Impl::BlockedBetween(const Joints& q0, const Joints& q1, int phase,
                                                              double resolution, const Joints& tube,
                                                              const std::vector<int>& pairs) {
  assert(resolution > 0);
  struct Interval {
    double begin, end;  // of the motion's 0..1
    std::vector<int> pairs;
  };
  // One question, however often the motion is halved: that may depend on bodies that no answer tells of.
  ++counts.poses;
  Look(q0, q1, tube);
  if (pairs.empty()) return std::nullopt;
  // Halving from the whole motion down: most pairs are settled by one look at its middle.
  std::vector<Interval> open{{0, 1, pairs}};
  while (!open.empty()) {
    const Interval interval = std::move(open.back());
    open.pop_back();
    const double middle = 0.5 * (interval.begin + interval.end);
    const Joints half_turn = 0.5 * (interval.end - interval.begin) * (q1 - q0).cwiseAbs();
    std::vector<int> undecided;
    auto found = Certify(q0 + middle * (q1 - q0), half_turn + tube, phase, resolution, interval.pairs,
                         Proof::kDistance, undecided);
    if (found) {
      Tell(found->pair);
      return found;
    }
    if (undecided.empty()) continue;
    // Once the interval is small against the tube, halving it settles nothing more.
    if (half_turn.maxCoeff() < kSmallBesideTube * tube.maxCoeff()) {
      const Joints q = q0 + middle * (q1 - q0);
      Tell(undecided.front());
      return ContactCandidate{q, undecided.front(), std::numeric_limits<double>::infinity()};
    }
    open.push_back({middle, interval.end, undecided});
    open.push_back({interval.begin, middle, std::move(undecided)});
  }
  return std::nullopt;
}

std::optional<ContactCandidate> Checker::BlockedAlong(std::span<const Joints> line, Phase phase,
                                                      double resolution) {
  const int phase_index = static_cast<int>(phase);
  return impl_->BlockedAlong(line, phase_index, resolution, impl_->PairsIn(phase_index));
}

std::optional<ContactCandidate> Checker::Impl::BlockedAlong(std::span<const Joints> line, int phase,
                                                            double resolution, std::vector<int> pairs) {
  if (line.size() < 2) return std::nullopt;
  if (line.size() == 2)
    return BlockedBetween(line.front(), line.back(), phase, resolution, Joints::Zero(), pairs);
  if (!pairs.empty() && !world->measures_all) {
    // Nowhere nearer than its clearance, so that no single motion would find less: resolution 0.
    Joints least = line.front(), most = line.front();
    for (const Joints& q : line) least = least.cwiseMin(q), most = most.cwiseMax(q);
    std::vector<int> undecided;
    Certify(0.5 * (least + most), 0.5 * (most - least), phase, 0, pairs, Proof::kBoxes, undecided);
    pairs = std::move(undecided);
  }
  const size_t half = line.size() / 2;
  const auto found = BlockedAlong(line.first(half + 1), phase, resolution, pairs);
  return found ? found : BlockedAlong(line.subspan(half), phase, resolution, std::move(pairs));
}

}  // namespace millpose
