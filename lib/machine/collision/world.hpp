// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "machine/collision/cell.hpp"
#include "machine/collision/query_log.hpp"

namespace millpose {

/// What the arm is doing; decides clearances and whether the cutter may touch the workpiece.
enum class Phase : uint8_t { kFree, kCutting };

/// Two bodies that touch or come nearer than their clearance.
struct Interference {
  std::string first, second;
  std::array<Eigen::Vector3d, 2> ends{Eigen::Vector3d::Zero(),
                                      Eigen::Vector3d::Zero()};        ///< of BoundedDistance
  Eigen::Vector3d place() const { return 0.5 * (ends[0] + ends[1]); }  ///< in W, mm
  double distance = 0;  ///< mm; ≤ 0 when they touch (then minus the depth where known)
};

/// Where a pair was found too near, not yet measured: Checker::Measure says how near.
struct ContactCandidate {
  Joints q = Joints::Zero();  ///< the pose, rad
  int pair = -1;
  double bound = 0;  ///< up to which the distance is wanted, mm
};

class PointMemory;

/// The cell as an FCL world, immutable and shared between threads.
class World {
 public:
  /// Throws InputError for shapes that cannot be built and excluded pairs that name no body.
  explicit World(Cell cell);
  ~World();
  const Cell& cell() const;
  /// The same world with the robot's base at X_WB and the workpiece, and what hangs on it, at X_WP.
  World With(const Pose& X_WB, const Pose& X_WP) const;
  /// Of a world whose external axes stand at 0: the same with them at `external`, one value for each.
  World At(const ExternalPosition& external) const;
  /// The same world, whose checkers ask FCL for every distance and share nothing between poses: slow, to show
  /// that what they try before changes no answer.
  World MeasuringAll() const;
  /// Names of the bodies that stand still and that others touch which hang on `mount` and stand still too:
  /// the workpiece, or the robot's base (Mount::kLink).
  std::vector<std::string> TouchedBy(Mount mount) const;
  /// The same world, whose checkers tell `keeper` what they are asked (when they go).
  World Recording(std::shared_ptr<QueryLog> keeper) const;
  /// Whether bodies of these names, which stand still, are so far from the arm in all of `looks` that no
  /// answer tells whether they are there. May say no where that is so.
  bool FarFrom(const std::vector<std::string>& still, const Queries& looks) const;
  /// Of a pair as in Sighting: "link4 and workpiece".
  std::string PairName(int pair) const;

 private:
  friend class Checker;
  friend class StationPath;
  struct Impl;
  explicit World(std::shared_ptr<const Impl> impl);
  std::shared_ptr<const Impl> impl_;
  std::shared_ptr<QueryLog> keeper_;
};

/// What checks took.
struct CheckCounts {
  long long poses = 0;  ///< and motions
  long long looks = 0;  ///< at poses, also at those by which motions are divided; for tests
  long long pairs = 0,
            pairs_saved = 0;  ///< of bodies, at poses with a PointMemory: looked at, and not for its sake
  CheckCounts& operator+=(const CheckCounts& other);
};

/// Asks a World about poses and motions. One per thread (it holds the moving FCL objects); cheap to make.
class Checker {
 public:
  /// `clearance_share`: of every clearance that is kept, 0..1; 1 is what the cell asks for. `reserve`: mm
  /// that it may fall short of that.
  explicit Checker(const World& world, double clearance_share = 1, double reserve = 0);
  ~Checker();
  Checker(Checker&&) noexcept;

  /// The first pair found to touch or to be nearer than its clearance at joint angles q; empty when free.
  std::optional<Interference> At(const Joints& q, Phase phase);

  /// The same without the distance: far cheaper, since it is hardly ever needed to know that it is too small.
  std::optional<ContactCandidate> Blocked(const Joints& q, Phase phase);

  /// The same for a pose at a milling point, with what is known of others there: pairs that `memory` knows to
  /// be free are not looked at again, and what it knows to interfere is answered with the pose where that was
  /// seen.
  std::optional<ContactCandidate> Blocked(const Joints& q, Phase phase, const std::vector<double>& freedoms,
                                          PointMemory& memory);

  /// The smallest distance of any checked pair, mm, never more than `bound` (so `bound` means "at least
  /// that").
  double Clearance(const Joints& q, Phase phase, double bound);

  /// The checked pair with that distance and the places where both are nearest; empty where none is nearer
  /// than `bound`.
  std::optional<Interference> Nearest(const Joints& q, Phase phase, double bound);

  /// Conservative check of the straight joint-space motion from q0 to q1: empty means that no pair comes
  /// nearer than its clearance less `resolution` (mm) anywhere on it. Steps by distance ÷ bound of each
  /// body's motion. The same holds of every motion whose joints leave that one by at most `tube` (rad, per
  /// joint); where the tube is so wide that a pair at its clearance cannot be told free, the pair is
  /// reported.
  std::optional<Interference> Between(const Joints& q0, const Joints& q1, Phase phase,
                                      double resolution = 0.5, const Joints& tube = Joints::Zero());

  std::optional<ContactCandidate> BlockedBetween(const Joints& q0, const Joints& q1, Phase phase,
                                                 double resolution = 0.5,
                                                 const Joints& tube = Joints::Zero());

  /// The first answer of BlockedBetween to the motions from each pose of a line to the next, of one joint
  /// motion after the other. Costs less than to ask for each: bodies that stay far apart all along are seen
  /// to at once.
  std::optional<ContactCandidate> BlockedAlong(std::span<const Joints> line, Phase phase,
                                               double resolution = 0.5);

  /// What was sighted by a checker of the same world, clearances and reserve.
  Interference Measure(const ContactCandidate& sighting);

  /// What was done so far, for the summary.
  const CheckCounts& counts() const;
  long long poses_checked() const { return counts().poses; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace millpose
