// SPDX-License-Identifier: GPL-3.0-or-later
// Which way to mill each pass, so that neither a displacement nor a step between neighbouring passes is
// larger than it must be (docs/face-error.md).
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "planning/result/face_choice.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// Two pieces of different passes that cut side by side: passes by their places in a list, pieces by theirs
/// within the pass as it was laid.
struct NeighbourPieces {
  size_t pass = 0, piece = 0, other_pass = 0, other_piece = 0;
};

/// Pairs of pieces of which some point that cuts has a point of the other beside it, the next one to that
/// side across the feed and no farther than `width` (mm, the cutter's diameter). `first`: passes before it
/// have no face and no neighbours. Each pair once, the pass that comes first first; sorted.
std::vector<NeighbourPieces> FindNeighbourPieces(const std::vector<PassResult>& passes, size_t first,
                                                 double width);

/// What a pass leaves, by pieces as they lie when it is run as it was laid.
using PassFace = std::vector<FaceChoiceFigures>;

/// What the passes together leave.
struct JobFace {
  double worst = 0;  ///< largest displacement, mm
  double step = 0;   ///< largest difference of the mean displacement between neighbours, mm
  double marks = 0;  ///< summed, mm
  double Largest() const { return std::max(worst, step); }
};

/// One candidate of each pass.
JobFace ValueOf(const std::vector<const PassFace*>& faces, const std::vector<NeighbourPieces>& neighbours);

/// Whether `a` is better: up to `limit` (mm) largest values count alike, then the marks decide.
bool IsBetter(const JobFace& a, const JobFace& b, double limit);

/// A candidate of each pass such that the largest displacement or step is no larger than it must be,
/// nor than `limit`, and the marks beneath that are least. Exact where neighbours follow each other in the
/// list; steps between others are not looked at. Empty where a pass has no candidate. All candidates of a
/// pass have the same number of pieces.
std::vector<size_t> ChooseSequence(const std::vector<std::vector<PassFace>>& candidates,
                                   const std::vector<NeighbourPieces>& neighbours, double limit);

}  // namespace millpose
