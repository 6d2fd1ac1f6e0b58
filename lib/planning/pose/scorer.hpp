// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "machine/robot/kinematics.hpp"
#include "machine/stiffness/compliance.hpp"
#include "machine/stiffness/series_block.hpp"
#include "planning/pose/freedom.hpp"
#include "planning/pose/objective.hpp"
#include "planning/pose/rotated_flange.hpp"
#include "toolpath/infeasibility.hpp"
#include "toolpath/lean_law.hpp"

namespace millpose {

/// Bounds of the admissible predicate (judge_block.hpp) that genetic algorithm, exhaustive search, ladder
/// search and smoothing share through PointScorer.
struct AdmissibleBounds {
  Joints lower = Joints::Zero(), upper = Joints::Zero();  ///< limits already minus the margin, rad
  double dexterity_min = 0;                               ///< with the problem's characteristic length
  double wrist_min = 0;                                   ///< least |sin q5|
  double elbow_min = 0;                                   ///< least |sin| of the elbow
  double shoulder_min_mm = 0;                             ///< least distance of SingularityDistance::shoulder
  std::vector<CoupledLimit> coupled = {};                 ///< likewise minus the margin

  /// Whether `q` (its revolutions as they are) is within all limits, to `slack` rad.
  bool Hold(const Joints& q, double slack) const {
    return (q.array() >= lower.array() - slack).all() && (q.array() <= upper.array() + slack).all() &&
           FirstBeyond(coupled, q, slack) == nullptr;
  }
};

/// All that the choice of a pose depends on besides the point itself; shared and immutable.
struct PoseProblem {
  Arm arm;
  Pose X_WB = Pose::Identity(), X_FT = Pose::Identity();
  StiffnessOrigin origin = StiffnessOrigin::kToolTip;
  double characteristic_length = 1000;  ///< mm, for dexterity
  AdmissibleBounds bounds;
  std::vector<SeriesCompliance> compliances;  ///< in series with the joints'
  /// The rotation about the tool axis first, then those that lean the axis.
  std::vector<std::shared_ptr<const Freedom>> freedoms;
  std::optional<LeanRules> lean;  ///< where a freedom leans the axis
  std::shared_ptr<const Objective> objective;
};

/// One branch of one choice of freedoms.
struct Candidate {
  Infeasibility obstacle = Infeasibility::kUnreachable;
  double objective = 0;       ///< defined where admissible
  double shortfall = 0;       ///< by how much the bounds are missed (rad, sines, m summed); 0 when admissible
  Joints q = Joints::Zero();  ///< a representative within the bounds where one exists, else principal; rad
};

/// kLanes settings of the freedoms × 8 branches as structure of arrays. The flips of a spherical wrist
/// (branch bit 2) share the joints' compliance, but not that of elements on links 4 and 5.
struct ScoredBlock {
  Lanes objective[8];  ///< defined where admissible
  Lanes shortfall[8];  ///< as in Candidate
  Lanes q[8][6];       ///< as in Candidate
  std::array<Infeasibility, kLanes> obstacle[8];
};

/// One entry of a block.
Candidate CandidateOf(const ScoredBlock& block, int branch, int lane);

inline constexpr unsigned kAllArmBranches = 0b1111;

/// Scores candidates of one milling point (given in W). Immutable, so threads may share it.
class PointScorer {
 public:
  PointScorer(const PoseProblem& problem, const MillingPoint& point,
              const Eigen::Vector3d& rotation_reference);

  /// Candidates for each entry of `freedoms` × 8 branches (index 8·i + branch). `out` has 8 × freedoms.size()
  /// entries. Works in blocks of kLanes poses; the result for an entry does not depend on its neighbours.
  void Score(std::span<const FreedomValues> freedoms, std::span<Candidate> out) const;

  /// The candidate on one branch.
  Candidate ScoreOne(const FreedomValues& freedoms, int branch) const;

  /// A block: `values` holds kLanes × (number of freedoms), one lane after the other. Only the arm branches
  /// in `arm_branches` (bit i: branch & 3 == i) are worked out; the others come back unreachable.
  void ScoreBlock(std::span<const double> values, unsigned arm_branches, ScoredBlock& out) const;

  /// The tool pose in W for some freedoms.
  Pose ToolPose(const FreedomValues& freedoms) const { return ToolPose(freedoms.data()); }

  const PoseProblem& problem() const { return *problem_; }

 private:
  /// The tool axes of a block where freedoms lean.
  struct BlockAxes {
    std::array<Eigen::Vector3d, kLanes> axis;  ///< W
    unsigned barred = 0;                       ///< bit l: the lean of lane l is not admitted
    bool alike = true;
  };

  Pose ToolPose(const double* freedoms) const;
  void FlangePoses(std::span<const double> values, FlangeBlock& out, BlockAxes& axes) const;
  void LeaningFlangePoses(std::span<const double> values, FlangeBlock& out, BlockAxes& axes) const;
  void ScoreEntry(int entry, const FlangeBlock& flange, const ArmBranchBlock& solved, const BlockAxes& axes,
                  ScoredBlock& out) const;
  void Evaluate(const ComplianceBlock& c, const BlockAxes& axes, Lanes& out) const;

  const PoseProblem* problem_;
  Pose X_WT_nominal_;
  Pose X_BW_, X_TF_;
  Eigen::Vector3d p_FO_;  ///< the stiffness origin in F, mm
  ObjectiveContext context_;
  SeriesBlock series_;     ///< the problem's compliances at that point
  RotatedFlange rotated_;  ///< where the rotation about the tool axis is the only freedom
  bool rotation_only_, leans_, rotates_and_leans_;
  CutterContact contact_;  ///< where freedoms lean, as the following
  Eigen::Vector3d rotation_reference_;
  std::optional<LeanBound> bound_;
};

}  // namespace millpose
