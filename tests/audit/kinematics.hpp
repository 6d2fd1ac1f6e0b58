// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "tests/audit/folder.hpp"

namespace millpose::audit {

/// Tool tip in W.
Matrix4 Tool(const Setup& setup, const Angles& angles);

/// Tool tip on the part, with the external axes at `external` (empty: as the setup has them).
Matrix4 ToolOnPart(const Setup& setup, const Angles& angles, const std::vector<Real>& external);

/// The same by the joints of the URDF that the cell names.
Matrix4 UrdfTool(const UrdfArm& arm, const Angles& angles);

/// Angles equal to `angles` up to full revolutions, nearest to `near`.
Angles TurnedNear(Angles angles, const Angles& near);

/// Joint angles that bring the tool to X_WT, by Newton's iteration on differences, from a start nearby.
Angles Solve(const Setup& setup, const Matrix4& X_WT, Angles angles);

/// Displacement of the stiffness's origin per force there, in W, mm/N: the arm's joints and the springs
/// beside.
Matrix3 ComplianceAt(const Setup& setup, const Angles& angles);

/// What points.csv says of stiffness, by another route: Jacobian by central differences of Tool(), and the
/// ellipsoid's section and radius by singular values of c⁻¹ restricted to the plane and to the normal.
struct Indices {
  Real lambda_t1, lambda_t2, lambda_n, mu, dexterity, objective;
};
Indices ComputeIndices(const Setup& setup, const Angles& angles, const Vector3& normal_W);

/// Angle between two directions, rad; good for small ones.
Real AngleBetween(const Vector3& a, const Vector3& b);
/// Angle of the rotation that takes one frame's axes to the other's, rad.
Real AngleBetween(const Matrix3& a, const Matrix3& b);

}  // namespace millpose::audit
