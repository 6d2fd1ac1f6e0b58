// SPDX-License-Identifier: GPL-3.0-or-later
// `millpose register`: where a job's part stands, from probed points (docs/registration.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/execution.hpp"
#include "base/file_root.hpp"
#include "base/pose_settings.hpp"
#include "geometry/registration/next_places.hpp"

namespace millpose {

struct RegisterArguments {
  std::filesystem::path job;
  /// CSV files, each with x_mm,y_mm,z_mm in `workpiece.frame` and, at will, sd_mm. Faces: the centre of the
  /// probe's ball, at will radius_mm and the face's normal nx,ny,nz. Targets: nominal_x_mm, … in the part's
  /// frame as well.
  std::optional<std::filesystem::path> faces, edges, holes, targets;
  std::optional<double> sd;      ///< mm, of points whose file gives none
  std::optional<double> radius;  ///< mm, of the ball, likewise
  int propose = 3;               ///< how many places to probe next
  FileRoot root{};
};

/// A probed point that does not lie on the part as the others say.
struct ProbeOutlier {
  std::string file;
  int line = 0;
  double distance = 0;      ///< mm
  double standardised = 0;  ///< in its standard deviations
};

/// A place to probe next.
struct ProposedPlace {
  PartPlace place;
  double off_95 = 0;  ///< mm: of the face, with it and those before it
};

struct RegisteredPart {
  Registration found;                    ///< bent where the points ask for it and the job allows it
  std::optional<BentRegistration> bent;  ///< what the points ask for
  PoseSettings pose;                     ///< rounded as it is written, and what the figures below are of
  size_t points = 0;
  size_t milled = 0;  ///< cut points of the job
  FaceError error;    ///< at these
  PartPlace worst;    ///< where the face's place is known worst
  double moved = 0;   ///< mm: farthest that a cut point moved from the job's pose, bending too
  double rms = 0;     ///< mm, of the distances that count
  std::vector<ProbeOutlier> outliers;  ///< worst first
  std::vector<ProposedPlace> next;
  std::optional<double> tolerance;    ///< mm, of the job
  std::optional<double> max_bending;  ///< likewise
  std::optional<double> last_layer;   ///< mm, that it takes off at least; empty: no job says
  std::vector<std::string> findings;

  /// Whether the pose may be written.
  bool usable() const { return findings.empty(); }
  /// workpiece.pose and workpiece.registered as YAML in one line each.
  std::string PoseYaml() const;
  std::string RegisteredYaml() const;
  /// Of the covariance, in mm and mrad.
  double CovarianceMrad(int i, int j) const;
};

/// Throws InputError for what cannot be read and for a job without a part or whose part stands by targets;
/// Interrupted.
RegisteredPart RegisterPart(const RegisterArguments& arguments, const Execution& execution);

}  // namespace millpose
