// SPDX-License-Identifier: GPL-3.0-or-later
// What the gears do along the cuts of a plan: where joints turn back, and what lost motion leaves on the face
// (docs/lost-motion.md).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "machine/motion/lost_motion.hpp"
#include "machine/stiffness/series.hpp"
#include "planning/result/compared.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// What presses outputs against their flanks beside the cutting force; without it load is not looked at.
struct GearWeights {
  std::vector<LinkMass> masses;
  Counterbalance counterbalance;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< in B, mm/s²
};

/// What a cell says of its gears.
struct GearModel {
  LostMotion lost;
  /// Whether a gear's lost motion is known. The others' reversals are counted and told per arcmin.
  std::array<bool, kMostGears> known{};
  std::optional<GearWeights> weights;
  std::optional<GearError> error;  ///< of the arm's gears; its phase is not known
};

/// A milling point in a pose.
struct PosedPoint {
  const MillingPoint* point;  ///< in W, with the external axes where they then are
  Joints q;                   ///< rad
  Pose X_WB;
  ExternalPosition external;
};

/// What moves the tool.
struct GearedArm {
  const Arm& arm;
  const Pose& X_FT;
  const Mechanism& mechanism;
};

/// The gears at such a point, with what presses them where the model says it, and their levers along its
/// normal, signed, mm/rad (mm/mm).
struct PosedGears {
  GearPlace place;
  GearValues levers = GearValues::Zero();
};

/// How far the tip goes against the part along the point's normal per unit of each external axis, mm/rad
/// (mm/mm): the same in every pose of the arm.
std::vector<double> ExternalLevers(const Mechanism& mechanism, const MillingPoint& point,
                                   const ExternalPosition& external);

/// A pose of the arm at a point, and what of it is known already. Directions are in B.
struct KnownPose {
  const Joints& q;          ///< rad
  const LinkPoses& frames;  ///< LinkFrames() of q
  const Matrix6& J;         ///< Jacobian() at the tool tip
  Eigen::Vector3d normal;   ///< of the point
  Eigen::Vector3d force;    ///< N, on the tool
  const ExternalPosition& external;
  const std::vector<double>& external_levers;  ///< ExternalLevers()
};
PosedGears GearsAt(const GearModel& model, const Arm& arm, const KnownPose& pose);

/// What the gears do along one piece, which is entered settled. `places`: of all its points; a closed piece
/// comes back to the first, whose second visit is the place behind the last. Joint angles are taken modulo
/// full revolutions, each to where it is nearest to the place before.
struct PieceGears {
  std::vector<GearEvent> events;
  std::vector<GearValues> levers;  ///< of each place along the point's normal, signed, mm/rad (mm/mm)
  /// Displacement of the tip along the normal by y − q of all gears that are known, mm.
  std::vector<double> errors;
};
PieceGears FollowPiece(const GearModel& model, const GearedArm& arm, const std::vector<PosedPoint>& places,
                       bool closed);

/// A gear that turns back, or whose output goes over, at a point of the face.
struct GearMark {
  int pass = 0;
  size_t point = 0;  ///< number in the job
  int gear = 0;      ///< 0..5; 6 and on: an external axis
  bool turns = false, crosses = false;
  double lever = 0;  ///< |n·J|, mm/rad (mm/mm)
};

/// What one gear's mark leaves: h·|n·J|, mm; empty where its lost motion is not known.
std::optional<double> HeightOf(const GearMark& mark, const GearModel& model);
/// Per arcmin (of a linear axis per 0.001 mm), mm.
double HeightPerUnit(const GearMark& mark, const std::vector<ExternalAxis>& external);

/// What the gears do where the face is cut.
struct GearCourse {
  std::vector<GearMark> marks;  ///< in the order of the points
  std::vector<bool> face;       ///< for every point of the job, whether it leaves the face
  /// Displacement along the normal by lost motion, mm, for every point of the job; empty where it is not of
  /// the face, or lost motion is not known for any gear.
  std::vector<std::optional<double>> errors;
  /// Likewise Σ|n·J_i| over the arm's gears, mm/rad: of every point of the face.
  std::vector<std::optional<double>> lever_sums;
  /// Likewise the largest displacement along the normal by the gears' periodic error, mm, all gears adding
  /// up; empty where nobody states it.
  std::vector<std::optional<double>> periodic;
};
/// Whether a point of a pass leaves the face: where it is Compared(), and its pass is one of those from
/// `finished_from` on, which earlier layers are cut away by. A drilled hole has no face along its normal.
using FaceFilter = std::function<bool(const PassResult& pass, const PlannedPoint& point)>;
FaceFilter OfFace(const std::vector<PassResult>& passes, int finished_from);

/// Adds what the gears do along a pass; `posed`: its planned points by their index.
void FollowPass(const GearModel& model, const GearedArm& arm, const PassResult& pass,
                const std::function<PosedPoint(size_t)>& posed, const FaceFilter& face, GearCourse& course);
GearCourse FollowGears(const PlanResult& plan, const GearModel& model, const FaceFilter& face);

/// By gears, for every point of every pass: how far the tip goes along the normal per unit of half the lost
/// motion, mm/rad (mm/mm), where the output stands in its gap; on a flank ± the lever, between the flanks
/// less; zero where nothing is planned. Each piece is entered as by its approach. A gap that is not known
/// counts with 0.5 arcmin (0.01 mm).
std::vector<std::vector<GearValues>> FlankLevers(const PlanResult& plan, const GearModel& model);

/// Figures of a course. Where a gear's lost motion is not known it counts with 1 arcmin (0.001 mm).
struct GearTally {
  std::array<int, kMostGears> turns{}, crossings{};
  double largest = 0, sum = 0;  ///< of the marks of crossings, mm
  double worst = 0;             ///< largest |error|, mm; 0 where nothing is known

  int Turns() const;
  void Add(const GearTally& other);
};
GearTally TallyOf(const GearCourse& course, const GearModel& model,
                  const std::vector<ExternalAxis>& external);

}  // namespace millpose
