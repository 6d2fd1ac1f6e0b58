// SPDX-License-Identifier: GPL-3.0-or-later
// The candidates for a segment of a pass, and which of them is best.
#pragma once

#include "planning/pass/face_segment.hpp"

namespace millpose {

class FaceSearch {
 public:
  FaceSearch(FaceSegment& segment, double limit)
      : segment_(segment), limit_(limit), layers_(segment.Layers()) {}

  /// The largest displacement at the best fixed rotation, interference left aside, or where none serves as a
  /// search finds it, mm.
  double Attainable() const;

  /// Puts in place of `best` what is better and free; true when something is.
  bool Improve(std::pair<FaceWay, FaceCandidate>& best);

  /// A fixed rotation that serves but for interference; the figures of AtFixed() up to rounding.
  struct Fixed {
    FixedPose at;
    FaceChoiceFigures figures;
  };
  std::vector<Fixed> AllFixed() const;
  /// The segment at a fixed rotation; empty where limits or joint steps bar it.
  std::optional<FaceCandidate> AtFixed(const FixedPose& at) const;

 private:
  std::vector<const FlankNode*> NodesAt(const FixedPose& at) const;
  bool Better(const FaceChoiceFigures& a, const FaceChoiceFigures& b) const;
  /// The best fixed rotation that is better than `than` and free, if one is.
  std::optional<FaceCandidate> BestFixed(const FaceChoiceFigures& than);
  std::optional<FaceCandidate> Searched();
  std::vector<std::vector<FlankNode>> Coarse() const;
  FlankRules CoarseRules() const;
  std::vector<FlankNode> Refined(const std::vector<std::vector<FlankNode>>& coarse,
                                 const std::vector<size_t>& nodes, bool bar);
  FaceCandidate Smoothed(FaceCandidate found);

  FaceSegment& segment_;
  double limit_;
  std::vector<std::vector<FlankNode>> layers_;
};

}  // namespace millpose
