// SPDX-License-Identifier: GPL-3.0-or-later
// Whether tools have been at a place (docs/stock.md).
#pragma once

#include <memory>

#include "geometry/mesh/bvh.hpp"
#include "toolpath/stock/swept_span.hpp"

namespace millpose {

/// All that several tools have swept, asked place by place. Immutable, so threads may share it.
class TakenOff {
 public:
  /// Axes that turn do so in steps, and corners have chords, that move no point by more than `tolerance`, mm.
  TakenOff(const std::vector<CutsOfTool>& cuts, double tolerance);

  bool Holds(const Eigen::Vector3d& place) const;

 private:
  std::vector<std::unique_ptr<const CutterProfile>> profiles_;  ///< which the volumes point at
  std::vector<SweptVolume> volumes_;
  Bvh tree_;
};

}  // namespace millpose
