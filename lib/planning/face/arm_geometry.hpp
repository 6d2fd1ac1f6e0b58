// SPDX-License-Identifier: GPL-3.0-or-later
// How the tool errs because the arm's own geometry is not that of its sheet (docs/arm-deviations.md).
#pragma once

#include <vector>

#include "machine/robot/deviations.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// Shift of a place (mm) and turn (rotation vector, rad), upper and lower three.
using FrameTwist = Eigen::Matrix<double, 6, 1>;

/// A place on the face and how far the tool is off there, in P.
struct OffPlace {
  Eigen::Vector3d position, normal;  ///< mm, unit
  FrameTwist off;                    ///< of the tip, and of the tool's direction
};

/// At point `number` of a planned pass, run as it is commanded: true less nominal, but for what compensation
/// shifts. Next to nothing where the deviations are taken out.
OffPlace OffByArm(const PlanResult& plan, const PassResult& pass, size_t number,
                  const ArmDeviations& deviations);

/// A program commands what the law of the arm's joints asks for at the points of the path, and goes straight
/// between them: by how much waves of the law take the tip off along the normal there, mm, the largest over
/// the cut points of passes from `finished_from` on.
double LeftBetweenPoints(const PlanResult& plan, const JointLaw& law, int finished_from);

/// A shift and a turn about `centre`.
struct MeasuredFrame {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mm
  FrameTwist twist = FrameTwist::Zero();             ///< shift of the centre; turn

  /// By how much it moves a place: shift there, and turn.
  FrameTwist At(const Eigen::Vector3d& position) const;
};

/// The frame that the part gets when it is measured with this arm all over the face: what leaves the least
/// squares along the normals. A flat face says nothing of shifts along it: these are 0.
MeasuredFrame FrameByArm(const std::vector<OffPlace>& places);

/// Sets `arm_left` of the commanded cut points of passes from `finished_from` on: `patterns` are the ways in
/// which the arm may differ from `deviations` yet, each by its standard deviation, independent.
void TellWhatIsLeft(const ArmDeviations& deviations, const std::vector<ArmDeviations>& patterns,
                    int finished_from, PlanResult& plan);

/// All cut points of passes from `finished_from` on.
std::vector<OffPlace> OffPlaces(const PlanResult& plan, const ArmDeviations& deviations, int finished_from);

}  // namespace millpose
