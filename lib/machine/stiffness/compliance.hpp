// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/enum_words.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {

/// Where stiffness holds (facts 4); the flange only reproduces the paper's text.
enum class StiffnessOrigin : uint8_t { kToolTip, kFlange };
inline constexpr EnumWords<StiffnessOrigin, 2> kStiffnessOriginWords = {
    {{"tool_tip", StiffnessOrigin::kToolTip}, {"flange", StiffnessOrigin::kFlange}}};

/// Cartesian compliance C = J·diag(1/k)·Jᵀ at the point where J is taken (Chen 2021 eq. 8, 9): blocks mm/N,
/// 1/N, 1/N, rad/(N·mm). Symmetric, positive where J is regular.
Matrix6 Compliance(const Matrix6& J, const Joints& joint_stiffness);

/// Dexterity D = 6/sqrt(tr(JᵀJ)·tr((JᵀJ)⁻¹)) (Chen 2021 eq. 3) with the translational rows divided by
/// `characteristic_length` (mm), which makes D free of units; 0 where J is singular.
double Dexterity(const Matrix6& J, double characteristic_length);

/// What the 3×3 linear compliance c (mm/N) says about milling a plane with unit normal n.
struct MillingPlaneIndices {
  double lambda_t1 = 0;  ///< larger semi-axis of the ellipsoid's section with the plane, mm/N (eq. 19)
  double lambda_t2 = 0;  ///< smaller semi-axis of that section, mm/N (eq. 19)
  double lambda_n = 0;   ///< radius of the ellipsoid along n, mm/N (eq. 21)
  double mu = 0;         ///< isotropy λτ2/λτ1, 0..1 (section 4.1)
  double normal_compliance = 0;  ///< nᵀcn: displacement along n under 1 N along n, mm/N (not λn, facts 12)
};

/// An orthonormal basis of the plane normal to a unit vector, right-handed with it: first × second = normal.
struct PlaneBasis {
  Eigen::Vector3d first, second;
};
PlaneBasis BasisOfPlane(const Eigen::Vector3d& normal);

/// c counts as singular when its determinant is below this share of its trace cubed: rounding has then eaten
/// the shortest semi-axis.
inline constexpr double kSingularCompliance = 1e-12;

/// Closed form, without an eigensolver (docs/stiffness.md). `normal` is a unit vector in the frame of c.
/// Empty when c is singular.
std::optional<MillingPlaneIndices> IndicesInPlane(const Eigen::Matrix3d& c, const Eigen::Vector3d& normal);

/// Displacements under unit forces, mm/N, which the radii λ are not (docs/stiffness.md).
struct PlaneDeflections {
  double normal = 0;    ///< nᵀcn: along n under a force along n
  double in_plane = 0;  ///< σmax(BᵀcB): largest in the plane under a force in the plane
  double largest = 0;   ///< σmax(cB): largest of all under a force in the plane
  double cross = 0;     ///< |nᵀcB|: largest along n under a force in the plane
};
PlaneDeflections DeflectionsInPlane(const Eigen::Matrix3d& c, const Eigen::Vector3d& normal);

}  // namespace millpose
