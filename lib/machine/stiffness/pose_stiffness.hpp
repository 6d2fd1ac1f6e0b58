// SPDX-License-Identifier: GPL-3.0-or-later
// Everything the model says about one pose, for `millpose stiffness` and reports. Not for hot loops.
#pragma once

#include <optional>

#include "machine/stiffness/compliance.hpp"
#include "machine/stiffness/series.hpp"

namespace millpose {

/// One pose's stiffness at one point, in B.
struct PoseStiffness {
  Eigen::Vector3d origin;    ///< the point at which all this holds, mm
  Matrix6 C;                 ///< mm/N, 1/N, 1/N, rad/(N·mm)
  std::optional<Matrix6> K;  ///< C⁻¹: N/mm, N, N, N·mm/rad; empty when C is singular
  Eigen::Vector3d lambda;  ///< λ1 ≥ λ2 ≥ λ3, semi-axes of the ellipsoid of c, mm/N (Chen 2021 eq. 17, 18)
  Eigen::Matrix3d directions;  ///< columns: directions of λ1, λ2, λ3; largest component positive
  std::optional<MillingPlaneIndices> indices;  ///< empty when c is singular
  Eigen::Vector3d t1_direction, t2_direction;  ///< of λτ1 and λτ2 in the plane; zero when c is singular
  PlaneDeflections deflections;
  double dexterity;
  SingularityDistance singularity;
};

/// `normal` is a unit vector in B; `p_FT` the point in F, mm. `elements` add to the joints' compliance.
PoseStiffness EvaluatePose(const Arm& arm, const Joints& q, const Eigen::Vector3d& p_FT,
                           const Eigen::Vector3d& normal, double characteristic_length,
                           const std::vector<SeriesCompliance>& elements = {});

}  // namespace millpose
