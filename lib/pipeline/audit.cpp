// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/audit.hpp"

#include <atomic>

#include "base/parallel.hpp"

namespace millpose {
namespace {

constexpr double kTravel = 0.2;        // mm between poses that are looked at
constexpr double kFarthest = 5000;     // mm from any axis to any point of arm and tool, generous
constexpr double kGoodEnough = 0.001;  // relative: "within 0.1 %"

void AuditGenetic(const PlanResult& plan, AuditFigures* figures) {
  long long judged = 0, good = 0;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      if (point.exhaustive_optimum <= 0) continue;
      ++judged;
      // A point that only the exhaustive search could plan counts as missed altogether.
      const double gap = point.genetic_optimum > 0 ? point.genetic_optimum / point.exhaustive_optimum - 1 : 1;
      if (gap <= kGoodEnough) ++good;
      figures->ga_worst_gap_percent = std::max(figures->ga_worst_gap_percent, 100 * gap);
    }
  figures->ga_share_within_0p1_percent =
      judged > 0 ? 100 * static_cast<double>(good) / static_cast<double>(judged) : 0;
}

void AuditPoints(const PlanResult& plan, const Mesh& mesh, const AdmissibleBounds& bounds,
                 AuditFigures* figures) {
  const Pose X_PW = plan.X_WP.inverse();
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      if (point.point.kind == PointKind::kCut)
        figures->max_slice_distance_mm =
            std::max(figures->max_slice_distance_mm, mesh.Closest(X_PW * point.point.position).distance);
      if (point.skip != SkipReason::kNone) continue;
      const bool inside = (point.q.array() >= bounds.lower.array() - 1e-9).all() &&
                          (point.q.array() <= bounds.upper.array() + 1e-9).all();
      if (!inside) ++figures->limit_violations;
    }
}

// One straight motion in joint space.
struct Step {
  Joints from, to;
  Phase phase;
};

std::vector<Step> StepsOf(const PlanResult& plan) {
  std::vector<Step> steps;
  for (const PassResult& pass : plan.passes)
    for (const Piece& piece : pass.pieces)
      for (int i = piece.first; i < piece.last; ++i)
        steps.push_back({pass.points[static_cast<size_t>(i)].q, pass.points[static_cast<size_t>(i) + 1].q,
                         Phase::kCutting});
  for (const Gap& gap : plan.gaps)
    for (size_t i = 1; i < gap.joints.size(); ++i)
      steps.push_back({gap.joints[i - 1], gap.joints[i], Phase::kFree});
  return steps;
}

long long CountInterferences(const World& world, const Step& step) {
  Checker checker(world);
  const double turned = (step.to - step.from).cwiseAbs().sum();
  const int count = std::max(1, static_cast<int>(std::ceil(turned * kFarthest / kTravel)));
  long long found = 0;
  for (int i = 0; i <= count; ++i) {
    const Joints q = step.from + (step.to - step.from) * (static_cast<double>(i) / count);
    if (checker.At(q, step.phase)) ++found;
  }
  return found;
}

}  // namespace

AuditFigures Audit(const PlanResult& plan, const Mesh& mesh, const World& world,
                   const AdmissibleBounds& bounds, int threads, std::stop_token stop) {
  AuditFigures figures;
  AuditGenetic(plan, &figures);
  AuditPoints(plan, mesh, bounds, &figures);
  const std::vector<Step> steps = StepsOf(plan);
  std::atomic<long long> interferences = 0;
  ParallelFor(steps.size(), threads, stop,
              [&](size_t i) { interferences += CountInterferences(world, steps[i]); });
  figures.interferences = interferences;
  return figures;
}

}  // namespace millpose
