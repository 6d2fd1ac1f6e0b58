// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <array>
#include <string>
#include <vector>

namespace millpose {

/// A face of the solid model that triangles come from.
struct SourceFace {
  std::string id;     ///< in the file: "#123"
  std::string name;   ///< empty where it has none
  std::string kind;   ///< plane, cylinder, cone, sphere, torus, spline or other
  double area = 0;    ///< of the exact face, mm²
  bool lost = false;  ///< could not be cut into triangles, or not for half of its area
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(),
                  upper = Eigen::Vector3d::Zero();  ///< bounds of a lost one, mm
};

/// A triangle soup with shared vertices: what readers return and what interference uses. Coordinates mm.
struct Triangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;   ///< indices into `vertices`, counter-clockwise seen from outside
  std::vector<int> source{};               ///< by face: into `source_faces`; empty when those are
  std::vector<SourceFace> source_faces{};  ///< of a STEP part, in its order
};

}  // namespace millpose
