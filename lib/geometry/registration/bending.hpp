// SPDX-License-Identifier: GPL-3.0-or-later
// A part that its clamps bend (docs/registration.md).
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// How many modes of bending are looked for.
inline constexpr int kMostModes = 6, kLeastModes = 3;
/// Unknowns of a part's place: shift, turn, modes of bending.
using ProbeVector = Eigen::VectorXd;
using ProbeMatrix = Eigen::MatrixXd;

/// Slopes up to this are small ones, mm/mm.
inline constexpr double kSteepestBending = 0.1;

/// The modes' names, in the order in which they are taken.
inline constexpr std::array<const char*, kMostModes> kModeNames = {"u2", "uv", "v2", "u3", "u2v", "uv2"};

/// How a part is bent, as a thin plate is (Kirchhoff): d(u, v) = Σ aᵢ·φᵢ(u, v) mm along w, the direction
/// across it, and what stands across it turns with it. A point p of the unbent part, z = w·(p − origin) over
/// the middle plane, goes to p + d·w − z·∇d. The modes φᵢ are Legendre's polynomials in u and v, each 1 at u
/// = v = 1: P₂(u), uv, P₂(v), P₃(u), P₂(u)·v, u·P₂(v), with P₂(x) = (3x² − 1)/2, P₃(x) = (5x³ − 3x)/2. Over
/// the rectangle −1 ≤ u, v ≤ 1 they stand at right angles to each other and to 1, u and v, which are a rigid
/// part's shift along w and turns: so they say of the part's shape what its place cannot. Displacements count
/// to their first order; slopes are small (some 0.01). All in the part's frame P, mm.
struct PartBending {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< u = v = 0, in the middle of the part's thickness
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();      ///< from there to u = 1: half of the part's length
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();      ///< likewise, across it
  std::vector<double> modes;                         ///< a, mm: of the first modes

  Eigen::Vector3d Across() const { return u.cross(v).normalized(); }  ///< w
  /// Where the modes, each 1 mm large, take p: a column a mode, mm.
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostModes> ModeShifts(const Eigen::Vector3d& p) const;
  /// d at p, mm.
  double Height(const Eigen::Vector3d& p) const;
  /// |∇d| at p.
  double Slope(const Eigen::Vector3d& p) const;
  Eigen::Vector3d Bent(const Eigen::Vector3d& p) const;
  /// The point that Bent takes to p.
  Eigen::Vector3d Unbent(const Eigen::Vector3d& p) const;
  /// Derivative of Bent at p: directions along lines of the part.
  Eigen::Matrix3d Gradient(const Eigen::Vector3d& p) const;
  /// How the plate turns at p, as a small rotation vector: ∇d × w.
  Eigen::Vector3d SmallTurn(const Eigen::Vector3d& p) const;
  /// The surface's unit normal n at p, after bending.
  Eigen::Vector3d BentNormal(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const;
  /// How a body at p turns that stands on a surface of normal n: n goes to BentNormal, and what lies across n
  /// as the plate turns.
  Eigen::Matrix3d Turn(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const;
};

/// The frame of a part's bending, without modes: its two widest principal axes by area, w the third, u = ±1
/// and v = ±1 where the part ends, `origin` in the middle of these and at the height of its area's centre.
/// Where both widest are alike, u is the first axis of P that lies along the part best. Rounded to 1e-4 mm.
PartBending PlateFrame(const Mesh& mesh);

/// The part, bent: faces are divided until no side is off the bent surface by more than `within` (mm).
/// Divided faces keep their `source`.
Triangles BentTriangles(const Triangles& part, const PartBending& bending, double within);

/// The same faces before: corners are taken back.
Triangles UnbentTriangles(Triangles bent, const PartBending& bending);

/// Largest |d| over the part's corners, mm, and where.
std::pair<double, Eigen::Vector3d> LargestBending(const Triangles& part, const PartBending& bending);
/// Largest |∇d| there.
double SteepestBending(const Triangles& part, const PartBending& bending);

}  // namespace millpose
