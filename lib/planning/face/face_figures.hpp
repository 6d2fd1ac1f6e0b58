// SPDX-License-Identifier: GPL-3.0-or-later
// A milled face as heights, and what is said of it (docs/face.md).
#pragma once

#include <optional>
#include <vector>

#include "toolpath/stock/swept_cutter.hpp"

namespace millpose {

/// Where a face is looked at.
struct FaceRays {
  std::vector<SurfaceRay> rays;
  std::vector<std::array<int, 2>> next;  ///< NextRays()
  double spacing = 0;                    ///< mm
  bool plane = false;                    ///< all rays begin in one plane, along its normal
};
FaceRays MakeFaceRays(const Region& region, double spacing);

/// Neighbouring rays, cut by different passes, at which the face steps; numbers of FaceRays::rays.
struct FaceStep {
  double height = 0;  ///< mm, above 0
  size_t ray = 0, other = 0;
  int pass = 0, other_pass = 0;
};

/// How much the heights that one pass leaves differ, mm.
struct PassRange {
  double range = 0;
  int pass = 0;
};

/// Mean, least and greatest of heights, mm.
struct HeightSpread {
  double level = 0, low = 0, high = 0;
};

/// What a face is like; mm. Rays at which nothing was cut do not count.
struct FaceFigures {
  size_t rays = 0;      ///< that count
  size_t standing = 0;  ///< at which the tool that does not err cuts and this one leaves the stock
  HeightSpread heights;
  HeightSpread added;  ///< to what a tool that does not err leaves: scallops, say, are in `heights` alone
  /// Eq. 37 and least distance of two planes around the surface's points; of a plane region alone. The
  /// latter takes longer and is worked out where it is asked for.
  std::optional<double> flatness, minimum_zone;
  std::optional<FaceStep> step;     ///< the greatest of `added` between passes
  std::optional<PassRange> within;  ///< the greatest of `added` within one pass
};

/// `heights` on `rays`, cut by `motions`; `flawless`: by the tool that does not err.
FaceFigures FiguresOf(const FaceRays& rays, const std::vector<RayHeight>& heights,
                      const std::vector<RayHeight>& flawless, const std::vector<CutterMotion>& motions,
                      bool zone);

/// The surface's points that count, in P, mm.
std::vector<Eigen::Vector3d> SurfaceOf(const FaceRays& rays, const std::vector<RayHeight>& heights);

/// "x_mm,y_mm,z_mm,error_um" in P, 17 significant digits, one row for each ray that counts: as a measuring
/// machine would give it, read by `flatness` and `calibrate`.
std::string FaceCsv(const FaceRays& rays, const std::vector<RayHeight>& heights);

}  // namespace millpose
