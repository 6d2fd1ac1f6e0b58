// SPDX-License-Identifier: GPL-3.0-or-later
// The deflection that force and weight are expected to cause, taken out of a plan's commanded poses
// (docs/compensation.md).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/enum_words.hpp"
#include "machine/robot/deviations.hpp"
#include "planning/compensation/interval.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// What of a point's deflection under the cutting force is taken out: nothing, its part along the surface
/// normal, or that across the feed as well. A shift along the feed would do nothing to the face.
enum class TakeOut : uint8_t { kOff, kNormal, kFull };
inline constexpr EnumWords<TakeOut, 3> kTakeOutWords = {
    {{"off", TakeOut::kOff}, {"normal", TakeOut::kNormal}, {"full", TakeOut::kFull}}};

/// Which layers are compensated: the one that leaves the finished face, or all.
enum class CompensatedLayers : uint8_t { kFinished, kAll };
inline constexpr EnumWords<CompensatedLayers, 2> kCompensatedLayersWords = {
    {{"finished", CompensatedLayers::kFinished}, {"all", CompensatedLayers::kAll}}};

/// An amount for every point of every pass of a plan, mm.
using PointAmounts = std::vector<std::vector<double>>;

struct CompensationOptions {
  TakeOut deflection = TakeOut::kOff;
  std::optional<double> share;  ///< of the expected deflection, 0..1; empty: by what is sure (TakenOut)
  ForceBounds force;
  StiffnessBounds stiffness;
  double most = 0.1;  ///< mm, of every shift, weight's included
  CompensatedLayers which = CompensatedLayers::kFinished;
  size_t layers = 1;         ///< that the passes fall into, the same number each, from the outermost
  double cutter_radius = 0;  ///< mm
  std::vector<SeriesCompliance> beside;  ///< the joints
  /// How far weight moves the tip in a pose, in B, mm, against the pose in which the workpiece's frame was
  /// measured. Empty: weight is left alone.
  std::function<Eigen::Vector3d(const Joints& q)> weight;
  /// What the map of a measured part takes out along the normal, after everything else; empty: no map.
  PointAmounts map;
  /// How the arm differs from what its controller has: its frames, and what its joints do; empty: left
  /// alone.
  std::optional<ArmDeviations> deviations;
};

/// Whether anything is to be shifted.
bool IsOn(const CompensationOptions& options);

/// The mean force on the tool at every point of every pass of a plan, in W, N.
using PointForces = std::vector<std::vector<Eigen::Vector3d>>;

/// The forces that a plan's points hold, for the feed that they were worked out for.
PointForces ForcesOf(const PlanResult& plan);

/// What became of the points.
struct CompensationCounts {
  size_t shifted = 0;      ///< points whose commanded pose is another than the nominal one
  size_t cut = 0;          ///< points whose shift would be larger than `most`
  double largest_cut = 0;  ///< mm, the largest that any of them would be
  size_t unreached = 0;    ///< points that keep their nominal pose since the arm does not reach the other
  /// Points (index of the pass, of the point) that the arm as it is does not reach within its limits.
  std::vector<std::pair<size_t, size_t>> out_of_reach;
  double largest_arm_shift = 0;   ///< mm, that the deviations of its frames ask for
  double largest_gear_shift = 0;  ///< mm, that the law of its joints asks for
};

/// Sets `compensation` of all planned points (empty where nothing is asked for). A cut point with a force
/// gets what is to be taken out there, bounded in how fast it changes along its piece; where the cutter meets
/// nothing, on leads, and where a ring begins and closes the shift is zero but for weight's. A layer cut
/// above another leaves its own residual, which counts in the depth and so in the force of the one below it.
/// With deviations every planned point is commanded such that the arm as it is comes to the pose so found,
/// its orientation too; nothing of that is bounded or blended. Interference is not looked at.
CompensationCounts Compensate(const CompensationOptions& options, const PointForces& forces,
                              PlanResult& plan);

/// A piece runs without its shifts: at its nominal poses, or where there are deviations, at those that bring
/// the arm as it is there.
void LeaveNominal(const CompensationOptions& options, size_t pass, const Segment& piece, PlanResult& plan);

/// Whether any point of a plan is shifted: such a program cuts deeper where the stock is gone.
bool IsCompensated(const PlanResult& plan);
/// Whether any is commanded to another pose than its nominal one.
bool HasCommanded(const PlanResult& plan);

/// Exchanges nominal and commanded angles where both are; twice: nothing.
void SwapCommanded(std::vector<PassResult>& passes);
/// Takes `compensation` from all points.
void ForgetCommanded(std::vector<PassResult>& passes);

/// The plan with the commanded angles in place of the nominal ones: what programs are made of.
PlanResult Commanded(PlanResult plan);

}  // namespace millpose
