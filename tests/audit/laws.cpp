// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/laws.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

#include "tests/audit/kinematics.hpp"

namespace millpose::audit {
namespace {

/// The mean force on the tool at a point, in W, N.
std::optional<Vector3> ForceAt(const Folder& folder, const Row& row) {
  if (!folder.goal.given_force.isZero(0)) {
    const Vector3 across = row.axis.cross(row.feed_direction).normalized();
    Matrix3 R;
    R << across.cross(row.axis), across, row.axis;
    return R * folder.goal.given_force;
  }
  // Poses are chosen for the forces with all points milled, which only a whole plan states.
  const auto found = folder.deflected.find(row.point);
  if (found == folder.deflected.end() || !folder.whole) return std::nullopt;
  return found->second.force;
}

/// Over all forces that are up to a share longer than F and lie up to an angle off it, the largest
/// displacement along n: that force lies as near to c·n as it may.
OwnObjective SurfaceError(const Goal& goal, const Matrix3& c, const Vector3& n, const Vector3& F) {
  const Vector3 g = c * n;
  const Real most = (1 + goal.uncertainty) * F.norm() * g.norm(), angle = AngleBetween(g, F);
  const Real acute = std::min(angle, 180 * kDegree - angle);
  return {most * std::cos(std::max(Real{0}, acute - goal.direction)), most};
}

/// The largest |c·F′| over the same forces, by looking over the whole cone and then nearer and nearer.
Real LargestDisplacement(const Goal& goal, const Matrix3& c, const Vector3& F) {
  const Vector3 axis = F.normalized(), across = axis.unitOrthogonal(), beside = axis.cross(across);
  const auto length = [&](Real off, Real turn) {
    return (c * (std::cos(off) * axis + std::sin(off) * (std::cos(turn) * across + std::sin(turn) * beside)))
        .norm();
  };
  Real best = 0, best_off = 0, best_turn = 0;
  const auto look = [&](Real off, Real turn) {
    off = std::clamp<Real>(off, 0, goal.direction);
    if (const Real value = length(off, turn); value > best) best = value, best_off = off, best_turn = turn;
  };
  for (int i = 0; i <= 12; ++i)
    for (int k = 0; k < 72; ++k) look(goal.direction * i / 12, k * 5 * kDegree);
  Real off_step = goal.direction / 12, turn_step = 5 * kDegree;
  while (turn_step > 1e-9L) {
    const Real before = best, off = best_off, turn = best_turn;
    for (const int i : {-1, 0, 1})
      for (const int k : {-1, 0, 1}) look(off + i * off_step, turn + k * turn_step);
    if (best == before) off_step /= 2, turn_step /= 2;
  }
  return (1 + goal.uncertainty) * F.norm() * best;
}

Real LargestInPlane(const Matrix3& c, const Vector3& n) {
  const Matrix3 across = Matrix3::Identity() - n * n.transpose();
  return Eigen::JacobiSVD<Matrix3>(c * across).singularValues()[0];
}

}  // namespace

std::optional<OwnObjective> ObjectiveOf(const Folder& folder, const Row& row, const Matrix3& c) {
  const std::string& name = folder.goal.objective;
  const Vector3 n = row.normal.normalized();
  const auto plain = [](Real value) { return OwnObjective{value, value}; };
  if (name == "normal_deflection") return plain(n.dot(c * n));
  if (name == "drilling") return plain(row.axis.dot(c * row.axis) / row.axis.squaredNorm());
  if (name == "worst_in_plane") return plain(LargestInPlane(c, n));
  if (name != "surface_error" && name != "face_error" && name != "process_force") return std::nullopt;
  const std::optional<Vector3> F = ForceAt(folder, row);
  if (!F) return std::nullopt;
  if (name == "process_force") return plain((c * *F).norm());
  if (folder.goal.counted == "any") return plain(LargestDisplacement(folder.goal, c, *F));
  const Vector3 wall = row.axis.cross(row.feed_direction).normalized();
  return SurfaceError(folder.goal, c, folder.goal.counted == "wall" ? wall : n, *F);
}

bool NeedsForces(const Goal& goal) {
  return goal.objective == "surface_error" || goal.objective == "face_error" ||
         (goal.objective == "process_force" && goal.given_force.isZero(0));
}

Real DeflectionError(const Deflected& stated, const Row& row, const Matrix3& c) {
  const Vector3 moved = c * stated.force, n = row.normal.normalized();
  const Vector3 across = n.cross(row.feed_direction).normalized();
  Eigen::Matrix<Real, 7, 1> error;
  error << stated.moved - moved, stated.normal - n.dot(moved), stated.feed - across.cross(n).dot(moved),
      stated.across - across.dot(moved), stated.length - moved.norm();
  const Real off = error.cwiseAbs().maxCoeff();
  if (off == 0) return 0;
  return moved.norm() > 0 ? off / moved.norm() : std::numeric_limits<Real>::infinity();
}

Vector3 ContactOf(const Folder& folder, const Row& row) {
  if (folder.along_normal && !folder.leans) return row.position;
  // The cutter is a disc with a ring of the corner's radius around it: the lowest point of the disc's rim
  // over the surface, and down from there by the ring.
  const Vector3 n = row.normal.normalized(), a = row.axis.normalized();
  const Vector3 centre = row.position + folder.corner_radius * a;
  const Vector3 up = n - n.dot(a) * a;
  const Real flat = folder.cutter_radius - folder.corner_radius;
  const Vector3 rim = up.norm() > 1e-9L ? Vector3(centre - flat * up.normalized()) : centre;
  return rim - folder.corner_radius * n;
}

Real LeanError(const Row& row) {
  const Vector3 n = row.normal.normalized(), f = row.feed_direction.normalized();
  const Vector3 forward = std::cos(row.lean->lead) * n + std::sin(row.lean->lead) * f;
  // Turned about the feed, as a screw that goes forward with it.
  const Vector3 across = f.cross(forward);
  const Vector3 leaned = f.dot(forward) * f + std::cos(row.lean->tilt) * (forward - f.dot(forward) * f) +
                         std::sin(row.lean->tilt) * across;
  return AngleBetween(leaned, row.axis);
}

Real HalfwayDeviation(const Setup& setup, const Posture& from, const Posture& to) {
  Posture half = from;
  for (size_t i = 0; i < 6; ++i) half.angles[i] = (from.angles[i] + to.angles[i]) / 2;
  for (size_t i = 0; i < half.external.size(); ++i)
    half.external[i] = (from.external[i] + to.external[i]) / 2;
  const auto tip = [&](const Posture& posture) -> Vector3 {
    return ToolOnPart(setup, posture.angles, posture.external).block<3, 1>(0, 3);
  };
  return (tip(half) - (tip(from) + tip(to)) / 2).norm();
}

Real HalfwayUnchanged(const Folder& folder, const Row& from, const Row& to) {
  const Setup& setup = folder.At(to.external);
  const Matrix4 X_WT = Tool(setup, to.angles) * Turn(2, from.rotation - to.rotation);
  return HalfwayDeviation(folder.setup, {from.angles, from.external},
                          {Solve(setup, X_WT, from.angles), to.external});
}

Real MostHalfway(const Goal& goal, Real unchanged) { return std::max(goal.max_halfway, 1.25L * unchanged); }

}  // namespace millpose::audit
