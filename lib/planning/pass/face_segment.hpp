// SPDX-License-Identifier: GPL-3.0-or-later
// One segment of a planned pass, and the candidates that could take its place.
#pragma once

#include "planning/pass/bend_law.hpp"
#include "planning/pass/face_planner.hpp"
#include "planning/pass/fixed_table.hpp"
#include "planning/pass/flank_search.hpp"
#include "planning/pass/segment_check.hpp"

namespace millpose {

/// A way to mill a segment, and what it leaves.
struct FaceCandidate {
  std::vector<PathNode> path;  ///< joints continuous, within the limits
  FaceChoiceFigures figures;
};

/// The points of a segment with their tool axes as they stand: the rotation is the only freedom of
/// `stations`.
class FaceSegment {
 public:
  FaceSegment(const Stations& stations, const PassResult& pass, const Segment& segment,
              const FacePlanOptions& options, const Execution& execution);

  size_t size() const { return points_.size(); }
  bool closed() const { return segment_.closed; }
  FaceCandidate AsPlanned() const;
  /// The figures of a path; nothing of it is checked.
  FaceChoiceFigures Figures(std::span<const PathNode> path, size_t* worst_at = nullptr) const;

  /// Candidates of every point on the ladder search's grid of the rotation, all branches.
  std::vector<std::vector<FlankNode>> Layers() const;
  int ring() const { return ring_; }
  double step() const { return step_; }
  /// Those of a point on one branch, `reach` places of `step` rad to either side of a rotation.
  std::vector<FlankNode> LayerAround(size_t t, double rotation, int branch, double step, int reach) const;

  FlankRules Rules() const;

  /// The nodes as a path; empty where limits or joint steps bar it.
  std::optional<FaceCandidate> Join(std::vector<PathNode> nodes) const;
  /// The figures that the nodes would have as a path; empty likewise. `faces`: of the nodes, by any full
  /// revolutions; the figures are those of Join() up to the rounding of these.
  std::optional<FaceChoiceFigures> FiguresJoined(std::vector<PathNode> nodes,
                                                 std::vector<FacePlace> faces) const;
  /// Of a path from Join(): what interferes, bends too far or cannot be left.
  SegmentHits Hits(const FaceCandidate& candidate);
  /// Bars the nodes of a branch that interfere by themselves; of the layers that `asked` names.
  void BarBlocked(int branch, const std::vector<bool>& asked, std::vector<std::vector<FlankNode>>& layers);
  /// Shifts the rotation so that the joints accelerate less; stays free.
  FaceCandidate Smoothed(FaceCandidate candidate);
  long long poses_checked() const { return checker_.poses_checked(); }

 private:
  FlankNode NodeAt(size_t t, const Candidate& candidate, int branch, int place, double rotation) const;
  bool Connect(std::vector<PathNode>& nodes) const;
  const PoseProblem& ProblemAt(size_t t) const { return in_.At(first_ + t).problem; }
  double Bend(size_t t, const Joints& from, const Joints& to) const;

  const PassResult& pass_;
  Segment segment_;
  const FacePlanOptions& options_;
  PlannedIn in_;
  FaceModel model_;
  size_t first_;
  std::vector<MillingPoint> points_;
  std::vector<FaceAtPoint> faces_;  ///< of the points
  std::vector<PointScorer> scorers_;
  std::vector<Joints> max_step_;
  std::vector<Eigen::Vector3d> middles_;
  std::vector<std::shared_ptr<PointVerdicts>> verdicts_;
  PassChecks checks_;
  SegmentChecker checker_;
  BendLaw law_;
  EndShares ends_;
  double motion_weight_;
  double step_;
  int ring_;
};

}  // namespace millpose
