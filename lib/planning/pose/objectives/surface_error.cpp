// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

enum Direction : uint8_t { kNormal, kWall, kAny };

/// The largest displacement along the surface normal n that a force near the point's mean cutting force F can
/// make, mm: |nᵀcF′| over all F′ that are up to `force_uncertainty_percent` (u) longer and lie up to
/// `force_direction_deg` (δ) off, (1 + u)·|F|·|g|·cos(max(0, θ − δ)) with g = c·n and θ the acute angle
/// between g and F. |nᵀcF| itself is zero where two parts of one force cancel, which no real force keeps to.
/// face_error is the same at a point, and judges whole ways besides.
/// `direction: wall` takes tool axis × feed in place of n: the side of a wall that the cutter's side mills;
/// `any` takes |cF′| whole.
class SurfaceError final : public Objective {
 public:
  SurfaceError(const char* name, bool judges_face, const ObjectiveParameters& parameters);
  std::string Name() const override { return name_; }
  std::string Unit() const override { return "mm"; }
  bool DependsOnFeed() const override { return true; }
  bool ReadsToolAxis() const override { return direction_ == kWall; }
  bool NeedsForce() const override { return true; }
  std::optional<ForceBounds> JudgesFace() const override { return judged_; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;

 private:
  void Along(const Eigen::Vector3d& n, const ComplianceBlock& c, const Eigen::Vector3d& force,
             Lanes& out) const;

  const char* name_;
  Direction direction_ = kNormal;
  double factor_;  // 1 + u
  SineCosine off_;
  std::optional<ForceBounds> judged_;
};

SurfaceError::SurfaceError(const char* name, bool judges_face, const ObjectiveParameters& parameters)
    : name_(name) {
  if (const auto given = parameters.find("direction"); given != parameters.end())
    direction_ = static_cast<Direction>(given->second);
  const double direction = parameters.at("force_direction_deg");
  if (direction > 90)
    throw InputError(
        SourceLocation{},
        fmt::format("objective {}: force_direction_deg is {:.6g}; allowed: at most 90", name, direction));
  factor_ = 1 + 0.01 * parameters.at("force_uncertainty_percent");
  off_ = SinCos(DegToRad(direction));
  if (judges_face) judged_ = {factor_ - 1, DegToRad(direction)};
}

// The longest c·f over unit vectors f that lie within the angle of `off` (0 to 90°) of the unit vector
// `axis`. A quadratic form has no other greatest value on the sphere than at its first eigenvector; where the
// cone does not hold that, the greatest lies on the cone's rim. There f = cos δ·axis + sin δ·p with p on the
// unit circle, and |c·f|² = a + 2bᵀp + pᵀAp is greatest where (λ − A)p = b for the λ ≥ A's larger eigenvalue
// that gives |p| = 1: one root, of a function that falls.
double LongestInCone(const Eigen::Matrix3d& c, const Eigen::Vector3d& axis, const SineCosine& off) {
  // c to the power of 2³², but for a factor: the projection onto its first eigenvectors.
  Eigen::Matrix3d power = c;
  for (int i = 0; i < 32 && power.trace() > 0; ++i) {
    power = (power / power.trace()).eval();
    power = (power * power).eval();
  }
  const Eigen::Vector3d nearest = power * axis;
  const double largest = nearest.norm();
  if (nearest.dot(axis) >= off.cos * largest) return largest > 0 ? (c * nearest).norm() / largest : 0;
  const Eigen::Vector3d across = axis.unitOrthogonal(), beside = axis.cross(across);
  const Eigen::Vector3d ca = off.cos * (c * axis), cu = off.sin * (c * across), cv = off.sin * (c * beside);
  const double a = cu.dot(cu), b = cu.dot(cv), d = cv.dot(cv);
  // Eigenvalues of A, and its first eigenvector (x, y).
  const double mean = 0.5 * (a + d), half = 0.5 * (a - d), radius = std::sqrt(half * half + b * b);
  double x = half >= 0 ? half + radius : b, y = half >= 0 ? b : radius - half;
  const double length = std::sqrt(x * x + y * y);
  if (length > 0)
    x /= length, y /= length;
  else
    x = 1, y = 0;
  const double first = mean + radius, second = mean - radius;
  const double u = ca.dot(cu), v = ca.dot(cv), b1 = x * u + y * v, b2 = x * v - y * u;
  // Above `first` by `up`; |p| ≥ 1 at |b1|, ≤ 1 at |b|.
  double low = std::fabs(b1), high = std::sqrt(b1 * b1 + b2 * b2);
  const double gap = first - second;
  for (int step = 0; step < 60 && low < high; ++step) {
    const double up = 0.5 * (low + high);
    const double p1 = up > 0 ? b1 / up : 0, p2 = up + gap > 0 ? b2 / (up + gap) : 0;
    (p1 * p1 + p2 * p2 >= 1 ? low : high) = up;
  }
  const double up = high;
  const double rim =
      ca.dot(ca) + first + up + (up > 0 ? b1 * b1 / up : 0) + (up + gap > 0 ? b2 * b2 / (up + gap) : 0);
  return std::sqrt(std::max(rim, 0.0));
}

void SurfaceError::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  if (direction_ == kNormal) return Along(context.normal, c, context.force, out);
  if (direction_ == kWall)
    return Along(context.tool_axis.cross(context.feed).normalized(), c, context.force, out);
  const double force = context.force.norm();
  const Eigen::Vector3d axis = context.force / force;
  for (int i = 0; i < kLanes; ++i) {
    Eigen::Matrix3d lane;
    lane << c.xx.v[i], c.xy.v[i], c.xz.v[i], c.xy.v[i], c.yy.v[i], c.yz.v[i], c.xz.v[i], c.yz.v[i], c.zz.v[i];
    out.v[i] = force > 0 ? factor_ * force * LongestInCone(lane, axis, off_) : 0;
  }
}

void SurfaceError::Along(const Eigen::Vector3d& n, const ComplianceBlock& c, const Eigen::Vector3d& force,
                         Lanes& out) const {
  const double nx = n.x(), ny = n.y(), nz = n.z(), fx = force.x(), fy = force.y(), fz = force.z();
  const double force2 = fx * fx + fy * fy + fz * fz;
  const double factor = factor_, off_cos = off_.cos, off_sin = off_.sin;
  ForEachLane(
      WidestInstructionSet(), [&](int i) __attribute__((always_inline)) {
        const double gx = c.xx.v[i] * nx + c.xy.v[i] * ny + c.xz.v[i] * nz;
        const double gy = c.xy.v[i] * nx + c.yy.v[i] * ny + c.yz.v[i] * nz;
        const double gz = c.xz.v[i] * nx + c.yz.v[i] * ny + c.zz.v[i] * nz;
        const double along = std::fabs(gx * fx + gy * fy + gz * fz);  // |g|·|F|·cos θ
        const double square = (gx * gx + gy * gy + gz * gz) * force2;
        const double whole = std::sqrt(square);
        const double rest = square - along * along;
        const double beside = std::sqrt(rest > 0.0 ? rest : 0.0);  // |g|·|F|·sin θ
        // cos(θ − δ), or 1 where θ ≤ δ.
        const double off = along * off_cos + beside * off_sin;
        out.v[i] = factor * (along >= whole * off_cos ? whole : off);
      });
}

/// An entry under `name`; both are worst first.
ObjectiveEntry EntryOf(const char* name, bool judges_face) {
  std::vector<ParameterRule> parameters{{"force_uncertainty_percent", 30, 0}, {"force_direction_deg", 20, 0}};
  // Gears' lost motion is judged along the normal alone.
  if (!judges_face)
    parameters.push_back(
        {"direction",
         kNormal,
         0,
         {"normal", "wall", "any"},
         "Of surface_error: which part of the displacement counts: along the surface normal (the "
         "default), across the feed and the tool's axis (the side of a wall), or all of it."});
  return {.name = name,
          .parameters = std::move(parameters),
          .make = [name, judges_face](
                      const auto& all) { return std::make_unique<SurfaceError>(name, judges_face, all); },
          .worst_first = true,
          .with_force = !judges_face,
          .of_paper = false,
          .with_lost_motion = judges_face};
}

}  // namespace

ObjectiveEntry SurfaceErrorEntry() { return EntryOf("surface_error", false); }

ObjectiveEntry FaceErrorEntry() { return EntryOf("face_error", true); }

}  // namespace millpose
