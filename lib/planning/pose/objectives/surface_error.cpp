// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

/// The largest displacement along the surface normal n that a force near the point's mean cutting force F can
/// make, mm: |nᵀcF′| over all F′ that are up to `force_uncertainty_percent` (u) longer and lie up to
/// `force_direction_deg` (δ) off, (1 + u)·|F|·|g|·cos(max(0, θ − δ)) with g = c·n and θ the acute angle
/// between g and F. |nᵀcF| itself is zero where two parts of one force cancel, which no real force keeps to.
/// face_error is the same at a point, and judges whole ways besides.
class SurfaceError final : public Objective {
 public:
  SurfaceError(const char* name, bool judges_face, const ObjectiveParameters& parameters);
  std::string Name() const override { return name_; }
  std::string Unit() const override { return "mm"; }
  bool DependsOnFeed() const override { return true; }
  bool ReadsToolAxis() const override { return false; }
  bool NeedsForce() const override { return true; }
  std::optional<ForceBounds> JudgesFace() const override { return judged_; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;

 private:
  const char* name_;
  double factor_;  // 1 + u
  SineCosine off_;
  std::optional<ForceBounds> judged_;
};

SurfaceError::SurfaceError(const char* name, bool judges_face, const ObjectiveParameters& parameters)
    : name_(name) {
  const double direction = parameters.at("force_direction_deg");
  if (direction > 90)
    throw InputError(
        SourceLocation{},
        fmt::format("objective {}: force_direction_deg is {:.6g}; allowed: at most 90", name, direction));
  factor_ = 1 + 0.01 * parameters.at("force_uncertainty_percent");
  off_ = SinCos(DegToRad(direction));
  if (judges_face) judged_ = {factor_ - 1, DegToRad(direction)};
}

void SurfaceError::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  const double nx = context.normal.x(), ny = context.normal.y(), nz = context.normal.z();
  const double fx = context.force.x(), fy = context.force.y(), fz = context.force.z();
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
  return {.name = name,
          .parameters = {{"force_uncertainty_percent", 30, 0}, {"force_direction_deg", 20, 0}},
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
