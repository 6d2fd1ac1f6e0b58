// SPDX-License-Identifier: GPL-3.0-or-later
// Round holes of a part: where a drill goes.
#pragma once

#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// What a hole looks like in the mesh.
enum class HoleKind : uint8_t {
  kBlind,    ///< a wall with one open end
  kThrough,  ///< a wall with two
  kRim,      ///< a rim of an open sheet: how thick the part is nobody knows
};

/// A round hole, in the mesh's frame.
struct RoundHole {
  HoleKind kind = HoleKind::kThrough;
  /// On the hole's axis, as high as its mouth reaches; of a through hole the end that `axis` points to. A
  /// conical mouth (chamfer, countersink) belongs to the hole.
  Eigen::Vector3d entrance = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< out of the material there; unit vector
  double diameter = 0;                              ///< of the wall or the rim, mm
  double depth = 0;        ///< from the entrance to the wall's far end, mm; a rim's: 0
  double residual = 0;     ///< largest distance of a corner from the fitted wall or rim, mm
  std::vector<int> faces;  ///< of its wall; of a rim those along it
};

/// The cylindrical walls that go all the way round a void, and the circular rims of open sheets, in the order
/// of their first faces. A wall ends at edges that bend by more than `crease` (rad). Circle and axis are
/// fitted to the corners by least squares (Kåsa 1976); a corner off by more than `tolerance` (mm) makes it no
/// hole. A through hole's axis points along its largest coordinate.
std::vector<RoundHole> FindRoundHoles(const Mesh& mesh, double crease, double tolerance);

}  // namespace millpose
