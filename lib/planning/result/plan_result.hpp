// SPDX-License-Identifier: GPL-3.0-or-later
// The one value that the planner makes and that checkpoints, cluster, report and programs share.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/boxed.hpp"
#include "machine/robot/arm.hpp"
#include "machine/robot/mechanism.hpp"
#include "machine/stiffness/compliance.hpp"
#include "toolpath/infeasibility.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// What the paper's own formulation found at a point, before it is put on the exact pose.
struct PaperAnswer {
  bool within_tolerance = false;
  double position_error = 0;  ///< mm
  double angle_error = 0;     ///< rad
  double objective = 0;       ///< f at the angles found; +inf in a singular pose
};

/// What a program is given at a point in place of the planned pose, so that the tip is where it should be
/// when force and weight have moved it (docs/compensation.md). Vectors in W, lengths mm.
struct Compensation {
  /// The deflection along one direction under the cutting force: expected, between which values it lies, and
  /// how much of it is taken out. Positive: along the direction.
  struct Along {
    double low = 0, expected = 0, high = 0;
    double taken = 0;

    double LargestBefore() const { return std::max(std::abs(low), std::abs(high)); }
    double LargestAfter() const { return std::max(std::abs(low - taken), std::abs(high - taken)); }
  };
  Joints q = Joints::Zero();  ///< commanded, rad
  Eigen::Vector3d shift =
      Eigen::Vector3d::Zero();  ///< of the tip, from nominal, but for the arm's deviations
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();  ///< what the shift takes out of the arm's own sag
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< mean, on the tool, N
  Along normal, across;                              ///< the surface normal; normal × feed
  double map = 0;        ///< mm along the normal that the map of a measured part takes out
  bool bounded = false;  ///< the shift was cut to the largest allowed
  /// By how much the commanded tool lies elsewhere, and is turned (rotation vector, rad), for the deviations
  /// of the arm: so commanded, the arm as it is goes where `shift` has it.
  Eigen::Vector3d arm_shift = Eigen::Vector3d::Zero(), arm_turn = Eigen::Vector3d::Zero();
  /// Of arm_shift, what is for the law of its joints (gear tables, couplings).
  Eigen::Vector3d gear_shift = Eigen::Vector3d::Zero();
  /// Half of the 95 % interval along the normal of what the measured geometry leaves there, mm, once the
  /// part's frame was measured with the arm; empty where nobody says it, or the point leaves no face.
  std::optional<double> arm_left;
};

/// Two bodies, and where each is nearest to the other.
struct NearestPair {
  int first = 0, second = 0;  ///< of PassResult::bodies
  Eigen::Vector3d first_end = Eigen::Vector3d::Zero(), second_end = Eigen::Vector3d::Zero();  ///< in W, mm
};

/// A milling point as planned (vectors in W), or why it was skipped.
struct PlannedPoint {
  MillingPoint point;
  Infeasibility skip = Infeasibility::kNone;  ///< why it is skipped
  std::string detail;                         ///< for a skipped point: what and where
  int piece = 0;                              ///< of its pass
  std::vector<double> freedoms;               ///< rotation about the tool axis first, rad
  int branch = 0;                             ///< status bits S
  Joints q = Joints::Zero();                  ///< absolute, full revolutions fixed, rad
  MillingPlaneIndices indices;                ///< at the stiffness origin
  double lambda_3 = 0;                        ///< shortest semi-axis of the ellipsoid of c, mm/N
  Eigen::Vector3d lambda_3_direction = Eigen::Vector3d::Zero();  ///< along it, in W: the stiffest direction
  double dexterity = 0;
  double objective = 0;
  double unsmoothed = 0;       ///< objective before smoothing
  double free_optimum = 0;     ///< of this point's candidates that meet nothing, the least
  double genetic_optimum = 0;  ///< of this point alone, by the genetic algorithm; 0 when it has none
  double own_optimum = 0;  ///< of this point alone, refined from the ladder search's grid; 0 when it has none
  double exhaustive_optimum = 0;  ///< of this point alone, by the judge's fine grid; 0 when it was not asked
  double own_rotation = 0, free_rotation = 0;  ///< where own_optimum and free_optimum lie, rad
  int own_branch = -1, free_branch = -1;       ///< on which status bits S; −1 where there is none
  int barred = -1;  ///< the pair, of PassResult::pairs, that bars the former; −1: it is free or unknown
  std::vector<int> verdicts;  ///< what is known of interference at this point (verdict_map.hpp)
  int genetic_evaluations = 0;
  std::vector<PaperAnswer> paper;  ///< one with formulation paper, else none
  bool from_genetic = false;  ///< its node came from the genetic algorithm (and may have been smoothed since)
  double clearance = 0;       ///< mm, of the nearest pair of bodies; at most kPointClearanceBound
  std::optional<NearestPair> nearest;  ///< that pair; empty: none is so near
  Boxed<Compensation> compensation;    ///< of a planned point, where the job asks for it
  /// Where the external axes are at this point, in passes along which they move (ExternalAt); between two
  /// points of a piece each goes evenly. Vectors in W are then of that moment.
  std::optional<ExternalPosition> external;
};

/// Points first..last of a pass, cut without lifting the tool.
struct Segment {
  int pass = 0;
  int piece = 0;
  int first = 0, last = 0;  ///< inclusive, into PassResult::points
  bool closed = false;      ///< cut from first round to first again
};

/// What smoothing did to a pass.
struct Smoothing {
  double square_before = 0, square_after = 0;        ///< SquaredAcceleration, rad²/s³
  double objective_before = 0, objective_after = 0;  ///< summed over the planned points
};

/// How far the ladder search's answer is from the least that any can cost, as it came out on the grid: both
/// in the objective's unit, the sum with joint motion. Bounds hold for sequences lifted at the same places.
struct LadderBound {
  double cost = 0, cost_bound = 0;    ///< objective and motion, summed
  double worst = 0, worst_bound = 0;  ///< largest objective; the bound 0 where the sum alone was sought
};

/// One pass, planned on its own.
struct PassResult {
  int pass = 0;
  Eigen::Vector3d rotation_reference = Eigen::Vector3d::UnitZ();
  ExternalPosition external;  ///< where the external axes stand while it is milled, or when it begins
  std::vector<PlannedPoint> points;
  std::vector<Segment> pieces;
  double grid_gap = 0;          ///< relative: (coarse path cost − refined path cost) ÷ refined
  long long poses_checked = 0;  ///< interference
  int nodes_pruned = 0;         ///< pruned for interference
  long long nodes = 0;          ///< candidates of the ladder search
  long long nodes_checked = 0;  ///< of them, for interference: the others never had to be
  long long pairs_checked = 0;  ///< pairs of bodies looked at for these candidates
  long long pairs_saved = 0;    ///< and not looked at again: known from another pose of the point
  Smoothing smoothing;
  LadderBound bound;
  std::vector<std::string> pairs;   ///< of bodies that were found to interfere: "link4 and workpiece"
  std::vector<std::string> bodies;  ///< names of those that are nearest to another at some point
  std::vector<int> uncut;  ///< points after which the pass is split and the step to the next is not cut
  std::vector<int> lifts;  ///< pieces before which the tool is lifted because that pays
  double lift_gain = 0;    ///< share of the pass's objective that these gain, 0..1
  std::string stripe;      ///< of a closed ring: what makes it dear, and what leaving it open would cost
  int opened_at = -1;      ///< a ring left open: which of its points, as laid, it begins with; else −1
};

/// The external axes go from one station to another, evenly and all together (each with the same share of
/// its way at any time), while the arm stands still at home.
struct ExternalMove {
  ExternalPosition from, to;
  int at = 0;           ///< index into Gap::joints: where the arm, at home, stands meanwhile
  double duration = 0;  ///< s, by the axes' speeds and accelerations; in Gap::duration too
};

/// The way between two pieces: retract along the tool axis, joint-space path, approach. −1 is home. Where the
/// pieces are milled at different stations the way goes by home, where the external axes move; the external
/// axes' home is the station before the first piece and after the last. Poses hold at the station where the
/// external axes stand then.
struct LinkMove {
  int from_pass = -1, from_piece = -1;
  int to_pass = -1, to_piece = -1;
  bool planned = false;
  std::string detail;  ///< what blocked it; of a planned one: by how much clearances were reduced
  Pose X_WT_retracted = Pose::Identity();  ///< tool at the end of the retract (from ≠ home)
  Pose X_WT_approach = Pose::Identity();   ///< tool where the approach begins (to ≠ home)
  std::vector<Joints> joints;  ///< of the joint-space path, from retracted (or home) to approach (or home)
  double clearance = 0;        ///< mm, smallest on the way, bounded
  double clearance_share = 1;  ///< of the cell's clearances, with which it was planned
  double duration = 0;         ///< s, by the joints' speeds and accelerations
  std::optional<ExternalMove> external;  ///< where the external axes move on the way
  long long poses_checked = 0;           ///< interference
};

/// The whole plan of a job.
struct PlanResult {
  std::string job;         ///< name
  std::string cell;        ///< name
  std::string input_hash;  ///< of everything that the plan depends on
  uint64_t seed = 0;
  Arm arm;
  std::vector<ExternalAxis> external_axes;
  /// X_WB and X_WP: with all external axes at 0.
  Pose X_WB = Pose::Identity(), X_FT = Pose::Identity(), X_WP = Pose::Identity();
  Joints home = Joints::Zero();
  double spindle_speed = 0;        ///< rev/s
  std::vector<PassResult> passes;  ///< by pass number
  std::vector<LinkMove> gaps;  ///< in the order of execution: home → piece, piece → piece, …, → home
  std::string objective_name, objective_unit;
  StiffnessOrigin stiffness_origin = StiffnessOrigin::kToolTip;
};

/// A plan as CBOR; exact (doubles bit for bit). Parse throws InputError naming `name`.
std::string Serialise(const PlanResult& result);
PlanResult ParsePlanResult(std::string_view bytes, const std::string& name);
/// The same of plan.cbor.gz, which WritePlan() writes.
PlanResult ParsePlanFile(std::string_view bytes, const std::string& name);

}  // namespace millpose
