// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/audit.hpp"

#include "base/parallel.hpp"
#include "compensation/compensate.hpp"
#include "judge/interference.hpp"
#include "motion/line.hpp"
#include "path/job_planner.hpp"
#include "pipeline/judge_setup.hpp"

namespace millpose {
namespace {

constexpr double kTravel = 0.2;    // mm between poses that are looked at for contact
constexpr double kNearTravel = 2;  // and for clearances

void AuditPoints(const PlanResult& plan, const Mesh& mesh, const AdmissibleBounds& bounds,
                 AuditFigures* figures) {
  const Pose X_PW = plan.X_WP.inverse();
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      if (point.point.kind == PointKind::kCut && mesh.face_count() > 0)
        figures->max_slice_distance_mm =
            std::max(figures->max_slice_distance_mm, mesh.Closest(X_PW * point.point.position).distance);
      if (point.skip != Obstacle::kNone) continue;
      const bool inside = (point.q.array() >= bounds.lower.array() - 1e-9).all() &&
                          (point.q.array() <= bounds.upper.array() + 1e-9).all();
      if (!inside) ++figures->limit_violations;
    }
}

constexpr int kLineParts = 8;  // joint motions for one straight motion of the tool

// One straight motion in joint space.
struct Step {
  Joints from, to;
  bool cutting;
  double share;  // of the clearances, with which it was planned
  std::string name;
};

// A straight motion of the tool as programs run it in cuts.
void AddLine(const Carrier& carrier, const Step& line, std::vector<Step>& steps) {
  Step part = line;
  for (int k = 1; k <= kLineParts; ++k) {
    // Where the arm leaves its branch the line is no motion; read-back says so.
    part.to =
        k == kLineParts
            ? line.to
            : OnLine(carrier, line.from, line.to, static_cast<double>(k) / kLineParts).value_or(part.from);
    steps.push_back(part);
    part.from = part.to;
  }
}

std::string NameOf(const GapEnd& end) {
  return end.pass < 0 ? "home" : fmt::format("pass {} piece {}", end.pass, end.piece);
}

void AddCuts(const Carrier& carrier, const PassResult& pass, size_t& first_number, std::vector<Step>& steps) {
  for (const Piece& piece : pass.pieces)
    for (int i = piece.first; i < piece.last; ++i) {
      const size_t at = static_cast<size_t>(i), number = first_number + at;
      AddLine(carrier,
              {pass.points[at].q, pass.points[at + 1].q, true, 1,
               fmt::format("point {} to {}", number, number + 1)},
              steps);
    }
  first_number += pass.points.size();
}

void AddGap(const Carrier& carrier, const Gap& gap, const std::pair<GapEnd, GapEnd>& ends,
            std::vector<Step>& steps) {
  if (!gap.planned || gap.joints.empty()) return;
  const auto& [from, to] = ends;
  const double share = gap.clearance_share;
  const std::string name = fmt::format("the way from {} to {}", NameOf(from), NameOf(to));
  if (from.pass >= 0) AddLine(carrier, {from.q, gap.joints.front(), true, share, name}, steps);
  for (size_t i = 1; i < gap.joints.size(); ++i)
    steps.push_back({gap.joints[i - 1], gap.joints[i], false, share, name});
  if (to.pass >= 0) AddLine(carrier, {gap.joints.back(), to.q, true, share, name}, steps);
}

std::vector<Step> StepsOf(const PlanResult& plan) {
  const Carrier carrier{plan.arm, plan.X_WB, plan.X_FT};
  std::vector<Step> steps;
  size_t number = 0;
  for (const PassResult& pass : plan.passes) AddCuts(carrier, pass, number, steps);
  const auto ends = GapEnds(plan.home, plan.passes);
  for (size_t i = 0; i < std::min(plan.gaps.size(), ends.size()); ++i)
    AddGap(carrier, plan.gaps[i], ends[i], steps);
  return steps;
}

// What the judge finds on one step.
struct Found {
  std::optional<audit::Contact> contact;
  std::vector<audit::Near> near;
};

// Every pair of bodies with what became of it, in the order of the steps.
void Collect(const std::vector<Step>& steps, const std::vector<Found>& found, AuditFigures* figures) {
  const auto entry = [&](const std::string& first, const std::string& second,
                         const std::string& where) -> AuditPair& {
    for (AuditPair& pair : figures->pairs)
      if (pair.first == first && pair.second == second) return pair;
    figures->pairs.push_back({first, second, 0, 0, std::numeric_limits<double>::infinity(), 0, where});
    return figures->pairs.back();
  };
  for (size_t i = 0; i < steps.size(); ++i) {
    if (const auto& contact = found[i].contact) {
      ++entry(contact->first, contact->second, steps[i].name).contacts;
      ++figures->interferences;
    }
    for (const audit::Near& near : found[i].near) {
      if (near.distance <= 0) continue;  // a contact
      AuditPair& pair = entry(near.first, near.second, steps[i].name);
      ++pair.too_near;
      ++figures->clearance_violations;
      if (near.distance >= pair.least_mm) continue;
      pair.least_mm = near.distance;
      pair.wanted_mm = near.wanted;
    }
  }
}

void AuditMotions(const PlanResult& plan, const Cell& cell, double resolution, int threads,
                  std::stop_token stop, AuditFigures* figures) {
  const audit::Setup setup = MakeJudgeSetup(cell);
  std::vector<Step> steps = StepsOf(plan);
  if (IsCompensated(plan)) std::ranges::move(StepsOf(Commanded(plan)), std::back_inserter(steps));
  std::vector<Found> found(steps.size());
  // A judge has a state of its own: one for each share of the steps.
  const auto parts = static_cast<size_t>(std::max(1, threads));
  ParallelFor(parts, threads, stop, [&](size_t part) {
    audit::Judge judge(setup);
    for (size_t i = part; i < steps.size(); i += parts) {
      CheckStop(stop);
      const Step& step = steps[i];
      const audit::Angles from = ToJudge(step.from), to = ToJudge(step.to);
      found[i].contact = judge.Between(from, to, step.cutting, kTravel);
      found[i].near = judge.TooNear(from, to, step.cutting, step.share, resolution, kNearTravel);
    }
  });
  Collect(steps, found, figures);
}

}  // namespace

AuditFigures Audit(const PlanResult& plan, const Mesh& mesh, const Cell& cell, const AdmissibleBounds& bounds,
                   double resolution, int threads, std::stop_token stop) {
  AuditFigures figures;
  AuditPoints(plan, mesh, bounds, &figures);
  AuditMotions(plan, cell, resolution, threads, std::move(stop), &figures);
  return figures;
}

std::vector<std::string> Findings(const AuditFigures& figures) {
  std::vector<std::string> findings;
  for (const AuditPair& pair : figures.pairs) {
    if (pair.contacts > 0)
      findings.push_back(fmt::format("audit: {} touches {} on {} motions, first on {}", pair.second,
                                     pair.first, pair.contacts, pair.where));
    if (pair.too_near > 0)
      findings.push_back(
          fmt::format("audit: {} comes within {:.2f} mm of {}, {:.2f} mm are to be kept, on {} motions, "
                      "first on {}",
                      pair.second, pair.least_mm, pair.first, pair.wanted_mm, pair.too_near, pair.where));
  }
  if (figures.limit_violations > 0)
    findings.push_back(fmt::format("audit: {} points beyond the limits", figures.limit_violations));
  return findings;
}

}  // namespace millpose
