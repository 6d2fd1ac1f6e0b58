// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>

#include "geometry/mesh/corner_normals.hpp"
#include "toolpath/strategies/scallop.hpp"
#include "toolpath/toolpath_options.hpp"

namespace millpose {

/// How densely passes must lie on each face of a mesh, by step-over or scallop height. docs/step-over.md.
class StepoverRule {
 public:
  StepoverRule(const Mesh& mesh, const ToolpathOptions& options);

  /// Passes per mm of a position (of planes, radii) whose gradient at a place of the face is the unit vector
  /// `gradient`.
  double Density(int face, const Eigen::Vector3d& gradient);
  /// Tells where faces lie so nearly along the passes that the step-over on them grows beyond the wanted.
  void AddNotes(std::vector<std::string>& notes) const;

 private:
  double Wanted(int face, const Eigen::Vector3d& across);

  const Mesh& mesh_;
  const ToolpathOptions& options_;
  std::optional<CornerNormals> normals_;  // for curvatures
  Scallops scallops_;
  std::map<long, double> known_;  // step-over by curvature in steps
  std::map<int, double> steep_;   // area of faces beyond the largest slope, mm²
};

/// By how much the surface bends over a face in a direction of its plane (1/mm, positive where it is convex):
/// the second fundamental form fitted to the corners' normals (Rusinkiewicz 2004).
double Curvature(const Mesh& mesh, const CornerNormals& normals, int face, const Eigen::Vector3d& direction);

}  // namespace millpose
