// SPDX-License-Identifier: GPL-3.0-or-later
// What World builds and Checker reads. Only cell/*.cpp include it.
#pragma once

#include <mutex>

#include "machine/collision/fcl_part.hpp"
#include "machine/collision/point_memory.hpp"

namespace millpose {

/// A body in the world: its part and the link that it moves with.
struct WorldBody {
  std::string name;
  std::shared_ptr<const FclPart> part;
  int link = 0;  ///< 0: does not move; 1..6: moves with that link
  Pose X_LG;     ///< pose of the shape in its link, or in W when it does not move
};

/// Two bodies that move relative to each other. `first` hangs on the lower link.
struct BodyPair {
  int first = 0, second = 0;  ///< into bodies
  /// Distance to keep in Phase::kFree and Phase::kCutting, mm; empty: not checked in that phase.
  std::array<std::optional<double>, 2> clearance;
  PointMemory::Kind kind = PointMemory::Kind::kOther;
};

struct World::Impl {
  Cell cell;  ///< without its meshes, which Whole() has
  std::vector<WorldBody> bodies;
  std::vector<BodyPair> pairs;  ///< in the order of checking: what touches most often first
  bool measures_all = false;    ///< as World::MeasuringAll
  double span = 0;  ///< mm: no point of a body that the arm carries is farther from any joint's axis

  /// Turns a cell without problems into bodies and pairs.
  static std::shared_ptr<const Impl> Build(Cell cell);
  /// A copy whose poses may be changed before Replace(). It shares geometry and meshes with this one: passes
  /// along which external axes move have a world for every point.
  std::shared_ptr<Impl> Copy() const;
  /// Puts the bodies where the cell's poses are now.
  void Replace();
  /// The cell with its meshes; of a copy made when it is first asked for.
  const Cell& Whole() const;

 private:
  struct Later {
    std::once_flag once;
    Cell cell;
  };
  std::shared_ptr<const Cell> meshes_, without_meshes_;  ///< as it was built
  std::shared_ptr<Later> later_;                         ///< of a copy

  /// Bodies i and j as a pair; two pairs for a cutter at the workpiece: all of it in the air, the part above
  /// the cutting length (added to `bodies`) while cutting.
  std::vector<BodyPair> PairsOf(const Cell& source, int i, int j);
  PointMemory::Kind KindOf(const Cell& source, const BodyPair& pair) const;
};

}  // namespace millpose
