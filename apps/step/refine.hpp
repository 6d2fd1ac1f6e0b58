// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <array>
#include <functional>
#include <vector>

namespace millpose {

/// One face of a solid model, cut into triangles.
struct FaceTriangles {
  std::vector<Eigen::Vector3d> points;      ///< mm
  std::vector<Eigen::Vector2d> parameters;  ///< of the points on the surface
  std::vector<std::array<int, 3>> faces;
};

/// Splits sides within the face until none lies farther than `tolerance` (mm) from the surface in its middle;
/// sides at the face's rim stay, as the neighbour has them too. OpenCASCADE bounds the rims' chords, but
/// joins the two rims of a cylinder as it likes. `surface` gives the point of a parameter. Returns the
/// largest distance that is left, of sides within the face.
double Refine(FaceTriangles& cut, double tolerance,
              const std::function<Eigen::Vector3d(const Eigen::Vector2d&)>& surface);

}  // namespace millpose
