// SPDX-License-Identifier: GPL-3.0-or-later
// Search through candidates of a piece with the gears' flanks as state: what a sequence costs at a place
// depends on the directions in which its joints have come there (docs/face-error.md).
#pragma once

#include <stop_token>

#include "planning/pass/face_figures.hpp"

namespace millpose {

/// A candidate pose of a point.
struct FlankNode {
  int branch = 0;
  int place = 0;  ///< on the grid of the rotation
  FreedomValues freedoms;
  Joints q = Joints::Zero();
  double objective = 0;
  FacePlace face;
  bool barred = false;
};

/// What a sequence may do, and how it is judged.
struct FlankRules {
  const LostMotion& lost;
  std::span<const Joints> max_step;  ///< rad: entry t of the step from point t on
  int window = 1;                    ///< places that the rotation may go from one point to the next
  int ring = 0;                      ///< places of a whole turn of the rotation; 0: it does not come round
  double motion_weight = 0;          ///< mm per rad² of joint motion
  double displaced_weight = 0;       ///< of a displacement beside the height of a mark
  double crossing_cost = 0;          ///< mm: what a mark costs beside its height
  double limit = 0;                  ///< mm: no less than this is asked of the largest displacement,
  double slack = 0;                  ///< and no less than this share above the least possible
  bool closed = false;               ///< from the last point to the first again
  std::stop_token stop;
};

/// One node of each layer, sorted by branch: of the sequences whose largest displacement keeps to `limit`, or
/// is within `slack` of the least that any can have, that with the least sum of marks, displacements and
/// motion. Exact where every joint that moves between two points crosses its gap whole. A sequence keeps its
/// branch and is entered settled. Rings of many candidates begin where an endless way round would. Empty
/// where none serves.
std::vector<size_t> SearchFlanks(std::span<const std::vector<FlankNode>> layers, const FlankRules& rules);

}  // namespace millpose
