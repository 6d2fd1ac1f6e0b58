// SPDX-License-Identifier: GPL-3.0-or-later
// What external axes move against each other (docs/external-axes.md).
#pragma once

#include <memory>
#include <optional>

#include "machine/collision/world.hpp"

namespace millpose {

/// Looks at positions of the external axes and at the moves between them, the arm standing still. All bodies
/// that move against each other then keep the free clearance: also those that stand still while a pass is
/// milled, but for a carriage and the one that carries it (they meet in their joint) and what the cell
/// excludes.
class StationPath {
 public:
  /// `at_zero`: the world with the external axes at 0; `q`: where the arm stands, rad.
  StationPath(const World& at_zero, const Joints& q, double resolution);
  ~StationPath();

  /// The first pair of bodies that stand still in passes which comes too near at `external`.
  std::optional<Interference> At(const ExternalPosition& external) const;

  /// Conservative check of the whole move, all axes together and evenly: empty means that no pair comes
  /// nearer than its clearance less `resolution` (mm) anywhere on it.
  std::optional<Interference> Between(const ExternalPosition& from, const ExternalPosition& to) const;
  /// The same of those pairs alone that stand still in passes: what the arm does makes no difference.
  std::optional<Interference> StandingBetween(const ExternalPosition& from, const ExternalPosition& to) const;

 private:
  std::optional<Interference> Look(const ExternalPosition& from, const ExternalPosition& to,
                                   bool standing) const;

  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace millpose
