// SPDX-License-Identifier: GPL-3.0-or-later
// Motions of the arm while external axes move (docs/external-axes.md).
#pragma once

#include <memory>
#include <optional>

#include "machine/collision/world.hpp"

namespace millpose {

/// Where joints and external axes are at once.
struct CoordinatedPose {
  Joints q = Joints::Zero();  ///< rad
  ExternalPosition external;  ///< one value for each axis
};

/// What a pair was found too near at.
struct CoordinatedContact {
  ContactCandidate sighting;  ///< of a checker of the world with the axes at `external`
  ExternalPosition external;
};

/// Asks a cell about motions on which joints and external axes move together. One per thread.
class CoordinatedChecker {
 public:
  /// `at_zero`: with the external axes at 0; the others as those of Checker.
  explicit CoordinatedChecker(const World& at_zero, double clearance_share = 1, double reserve = 0);
  ~CoordinatedChecker();
  CoordinatedChecker(CoordinatedChecker&&) noexcept;

  /// Conservative check of the motion on which all joints and external axes go evenly, with the same share of
  /// their ways, from one pose to another: empty means that no pair that the arm's checks look at
  /// (Checker) comes nearer than its clearance less `resolution` (mm) anywhere on it, nor on any motion whose
  /// joints leave that one by at most `tube` (rad, per joint). Else a pair that comes nearer than its
  /// clearance or, with a tube, may. Bodies that stand still in passes are StationPath's.
  std::optional<CoordinatedContact> BlockedBetween(const CoordinatedPose& from, const CoordinatedPose& to,
                                                   Phase phase, double resolution,
                                                   const Joints& tube = Joints::Zero());

  Interference Measure(const CoordinatedContact& seen) const;

  const CheckCounts& counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace millpose
