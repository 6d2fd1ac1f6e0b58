// SPDX-License-Identifier: GPL-3.0-or-later
// The face that a plan leaves when the tool errs as stated, and how sure that is (docs/face.md).
#pragma once

#include <array>
#include <optional>

#include "base/execution.hpp"
#include "planning/face/erring_path.hpp"
#include "planning/face/face_figures.hpp"

namespace millpose {

/// What is stated of what moves the tool, and between which bounds it is known.
struct StatedErrors {
  bool force = false;              ///< the plan's points have mean cutting forces
  double force_share = 0;          ///< by which they may be longer or shorter
  double force_angle = 0;          ///< rad, by which they may point elsewhere
  std::optional<LostMotion> lost;  ///< widths as stated: each lies between 0 and that
  bool geometry = false;           ///< the arm's deviations are in the path
  double tip = 0;                  ///< of the tip in the flange, mm to either side
  double lean = 0;                 ///< of the tool axis in the flange, rad
  std::optional<GearError> gears;  ///< periodic, of any phase
  /// Where the part stands: standard deviations of its shift (mm) and turn (rad) about `part_centre`, in P,
  /// as the root L of their covariance L·Lᵀ; below them rows of the modes of `part_bending`, mm.
  std::optional<ProbeMatrix> part;
  PartBending part_bending;  ///< its frame; the modes' sizes do not count
  Eigen::Vector3d part_centre = Eigen::Vector3d::Zero();

  /// Whether a drawn face can differ from the expected one.
  bool AreUnsure() const {
    return (force && (force_share > 0 || force_angle > 0)) || (lost && lost->Any()) || tip > 0 || lean > 0 ||
           gears || part;
  }
};

/// One face.
struct CutFace {
  FaceFigures figures;
  std::vector<RayHeight> heights;
};

/// 5 % of the draws lie below, 5 % above; mm.
struct DrawnInterval {
  double low = 0, high = 0;
};

/// What faces are like that are drawn within the stated bounds.
struct DrawnFaces {
  int count = 0;
  size_t rays = 0;             ///< that each was cut on, fewer than of the expected face
  FaceFigures expected;        ///< the expected face on these
  DrawnInterval level, added;  ///< of FaceFigures::heights; high − low of FaceFigures::added
  std::optional<DrawnInterval> flatness;
};

struct FaceStudy {
  CutFace flawless;  ///< by a tool that does not err: scallops and allowance
  std::optional<FaceFigures> by_force, by_lost, by_geometry;  ///< by these alone, where stated
  CutFace expected;                                           ///< by all that is stated, the tool as measured
  std::optional<DrawnFaces> drawn;  ///< where something is unsure and draws were asked for
};

struct FaceStudyOptions {
  int draws = 0;
  uint64_t seed = 1;
  /// Height of the stock over the surface, mm: where the tool comes no lower, between passes that do not
  /// quite meet, nothing is cut.
  double top = std::numeric_limits<double>::infinity();
};

/// `rays` for the expected face, `few` for the drawn ones. The same for any number of threads. Throws
/// Interrupted.
FaceStudy StudyFace(const ErringPath& path, const CutterShape& cutter, const FaceRays& rays,
                    const FaceRays& few, const StatedErrors& stated, const FaceStudyOptions& options,
                    const Execution& execution);

}  // namespace millpose
