// SPDX-License-Identifier: GPL-3.0-or-later
// The error of the face as the motion of a piece leaves it: what the force and the gears' lost motion
// displace the tip by along the normal (docs/face-error.md).
#pragma once

#include "machine/stiffness/force_cone.hpp"
#include "planning/pose/scorer.hpp"
#include "planning/result/face_choice.hpp"
#include "planning/result/gear_course.hpp"

namespace millpose {

/// One place of a piece, with what a pose there makes of force and lost motion. Displacements are along the
/// normal, positive out of the material, mm.
struct FacePlace {
  PosedGears gears;
  double low = 0, high = 0;  ///< between which the force displaces
  bool counts = false;       ///< the cut there leaves the face
};

/// What the figures of a face go by.
struct FaceModel {
  GearModel gears;
  ForceBounds force;
  std::vector<ExternalAxis> external_axes;
};

/// Makes the places of poses at one milling point (in W). What is the same in all of them is worked out once.
class FaceAtPoint {
 public:
  /// `problem`: with the external axes at `external`; it and the model are kept by reference.
  FaceAtPoint(const PoseProblem& problem, const FaceModel& model, const MillingPoint& point,
              ExternalPosition external);

  /// The place where the arm stands at `q`, rad.
  FacePlace At(const Joints& q) const;

 private:
  const PoseProblem& problem_;
  const FaceModel& model_;
  ExternalPosition external_;
  std::vector<double> external_levers_;
  Eigen::Vector3d normal_, force_;  ///< in B
  ForceCone cone_;
  bool counts_;
};

/// The largest displacement where lost motion gives `lost` of it.
inline double LargestWith(const FacePlace& place, double lost) {
  return std::max(std::abs(place.low + lost), std::abs(place.high + lost));
}

/// Of a piece entered settled: every gear rests where its own first direction leaves it. A closed piece is
/// milled round to its first place again. `worst_at` receives the place of the largest displacement.
FaceChoiceFigures FiguresOf(const LostMotion& lost, std::vector<FacePlace> places, bool closed,
                            size_t* worst_at = nullptr);

}  // namespace millpose
