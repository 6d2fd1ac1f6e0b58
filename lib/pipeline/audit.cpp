// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/audit.hpp"

#include <atomic>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "motion/line.hpp"
#include "robot/kinematics.hpp"

namespace millpose {
namespace {

constexpr double kTravel = 0.2;              // mm between poses that are looked at
constexpr double kPortion = 2 * kRadPerDeg;  // of a motion for which one reach holds
constexpr double kReachGrowth = 1.04;        // of any reach while every joint turns by half a portion
constexpr double kGoodEnough = 0.001;        // relative: "within 0.1 %"

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
      if (point.point.kind == PointKind::kCut && mesh.face_count() > 0)
        figures->max_slice_distance_mm =
            std::max(figures->max_slice_distance_mm, mesh.Closest(X_PW * point.point.position).distance);
      if (point.skip != SkipReason::kNone) continue;
      const bool inside = (point.q.array() >= bounds.lower.array() - 1e-9).all() &&
                          (point.q.array() <= bounds.upper.array() + 1e-9).all();
      if (!inside) ++figures->limit_violations;
    }
}

constexpr int kLineParts = 8;  // joint motions for one straight motion of the tool in a cut

// One straight motion in joint space.
struct Step {
  Joints from, to;
  Phase phase;
};

// A straight motion of the tool as programs run it in cuts.
void AddLine(const Carrier& carrier, const Joints& from, const Joints& to, std::vector<Step>* steps) {
  Joints q = from;
  for (int k = 1; k <= kLineParts; ++k) {
    // Where the arm leaves its branch the line is no motion; read-back says so.
    const Joints next =
        k == kLineParts ? to : OnLine(carrier, from, to, static_cast<double>(k) / kLineParts).value_or(q);
    steps->push_back({q, next, Phase::kCutting});
    q = next;
  }
}

std::vector<Step> StepsOf(const PlanResult& plan) {
  const Carrier carrier{plan.arm, plan.X_WB, plan.X_FT};
  std::vector<Step> steps;
  for (const PassResult& pass : plan.passes)
    for (const Piece& piece : pass.pieces)
      for (int i = piece.first; i < piece.last; ++i)
        AddLine(carrier, pass.points[static_cast<size_t>(i)].q, pass.points[static_cast<size_t>(i) + 1].q,
                &steps);
  for (const Gap& gap : plan.gaps)
    for (size_t i = 1; i < gap.joints.size(); ++i)
      steps.push_back({gap.joints[i - 1], gap.joints[i], Phase::kFree});
  return steps;
}

// How far from the axis of each joint the farthest point of anything beyond it can be at q, mm.
Joints Reach(const Cell& cell, const Joints& q) {
  const std::array<Pose, 7> X_BL = LinkFrames(cell.arm, q);
  Joints reach = Joints::Zero();
  for (const Body& body : cell.bodies) {
    const bool on_tool = body.mount == Mount::kTool;
    if (!on_tool && body.mount != Mount::kLink) continue;
    const size_t link = on_tool ? 6 : static_cast<size_t>(body.link);
    const Pose X_LG = on_tool ? cell.X_FT * body.X_MG : body.X_MG;
    const Eigen::Vector3d centre = X_BL[link] * X_LG.translation();
    for (size_t joint = 0; joint < link; ++joint) {
      const double distance = (centre - X_BL[joint + 1].translation()).norm() + Radius(body.shape);
      reach[static_cast<int>(joint)] = std::max(reach[static_cast<int>(joint)], distance);
    }
  }
  return reach;
}

// Poses on one motion that touch, no point of arm and tool moving by more than kTravel from one to the next.
long long CountInterferences(const World& world, const Step& step) {
  Checker checker(world);
  const Joints way = step.to - step.from;
  const int portions = std::max(1, static_cast<int>(std::ceil(way.cwiseAbs().maxCoeff() / kPortion)));
  long long found = 0;
  for (int portion = 0; portion < portions; ++portion) {
    const Joints begin = step.from + way * (static_cast<double>(portion) / portions);
    const double travel =
        way.cwiseAbs().dot(Reach(world.cell(), begin + way / (2.0 * portions))) * kReachGrowth / portions;
    const int count = std::max(1, static_cast<int>(std::ceil(travel / kTravel)));
    for (int i = portion == 0 ? 0 : 1; i <= count; ++i)
      if (checker.At(begin + way * (static_cast<double>(i) / count / portions), step.phase)) ++found;
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
