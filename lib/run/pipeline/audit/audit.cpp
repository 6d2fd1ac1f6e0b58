// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/audit/audit.hpp"

#include "audit/interference.hpp"
#include "base/parallel.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/angles.hpp"
#include "planning/compensation/compensate.hpp"
#include "planning/links/job_planner.hpp"
#include "planning/result/station.hpp"
#include "run/pipeline/audit/judge_setup.hpp"
#include "toolpath/cutter.hpp"

namespace millpose {
namespace {

constexpr double kTravel = 0.2;    // mm between poses that are looked at for contact
constexpr double kNearTravel = 2;  // and for clearances

/// Where external axes move along a pass: points at which one is beyond its limits, and motions to a point on
/// which it would have to be faster than it can at the point's feed.
long long BeyondAxes(const PlanResult& plan, const PassResult& pass) {
  constexpr double kRounding = 1e-9;
  long long beyond = 0;
  for (size_t t = 0; t < pass.points.size(); ++t) {
    const PlannedPoint& point = pass.points[t];
    if (!point.external || point.skip != Infeasibility::kNone) continue;
    const bool goes = t > 0 && pass.points[t - 1].skip == Infeasibility::kNone &&
                      pass.points[t - 1].piece == point.piece && pass.points[t - 1].external;
    const double way =
        goes ? (OnPartAtZero(plan, *point.external, point.point.position) -
                OnPartAtZero(plan, *pass.points[t - 1].external, pass.points[t - 1].point.position))
                   .norm()
             : 0;
    for (size_t i = 0; i < plan.external_axes.size(); ++i) {
      const ExternalAxis& axis = plan.external_axes[i];
      const double value = (*point.external)[i];
      if (value < axis.lower - kRounding || value > axis.upper + kRounding) ++beyond;
      // A tip that stands still says nothing of how long the motion takes.
      if (way > kRounding && std::abs(value - (*pass.points[t - 1].external)[i]) * point.point.feed_rate >
                                 axis.speed * way * (1 + kRounding))
        ++beyond;
    }
  }
  return beyond;
}

/// Of the cut points from the part, in P; of a bent one before it is bent, where its faces are as given.
class SurfaceDistance {
 public:
  SurfaceDistance(const Mesh& mesh, const std::optional<PartBending>& bending)
      : mesh_(bending ? Mesh(UnbentTriangles(mesh.triangles(), *bending)) : mesh), bending_(bending) {}
  double operator()(const Eigen::Vector3d& p) const {
    if (mesh_.face_count() == 0) return 0;
    return mesh_.Closest(bending_ ? bending_->Unbent(p) : p).distance;
  }

 private:
  Mesh mesh_;
  const std::optional<PartBending>& bending_;
};

void AuditPoints(const PlanResult& plan, const Mesh& mesh, const AuditRules& rules, AuditFigures* figures) {
  const AdmissibleBounds& bounds = rules.bounds;
  const SurfaceDistance distance(mesh, rules.bending);
  // Of a leaning cutter not the tip lies on the surface.
  const auto on_surface = [&](const MillingPoint& point) {
    return ContactAtTip(rules.cutter, point.position, point.normal, point.tool_axis);
  };
  for (const PassResult& pass : plan.passes) {
    Pose X_PW = PartAt(plan, pass.external).inverse();
    for (const PlannedPoint& point : pass.points) {
      if (point.external) X_PW = PartAt(plan, *point.external).inverse();
      if (point.point.kind == PointKind::kCut)
        figures->max_slice_distance_mm =
            std::max(figures->max_slice_distance_mm, distance(X_PW * on_surface(point.point)));
      if (point.skip != Infeasibility::kNone) continue;
      if (!bounds.Hold(point.q, 1e-9)) ++figures->limit_violations;
    }
    figures->limit_violations += BeyondAxes(plan, pass);
  }
}

constexpr int kLineParts = 8;  // joint motions for one straight motion of the tool

// One straight motion in joint space.
struct Step {
  Joints from, to;
  bool cutting;
  double share;  // of the clearances, with which it was planned
  std::string name;
  ExternalPosition external;           // where the external axes stand
  const ExternalMove* move = nullptr;  // they move, the arm stands still
  ExternalPosition external_to = {};   // they move evenly there, with the arm
};

// A straight motion of the tool as programs run it in cuts: on the part, where external axes move with it.
void AddLine(const Carrier& carrier, const Step& line, std::vector<Step>& steps) {
  Step part = line;
  for (int k = 1; k <= kLineParts; ++k) {
    const double share = static_cast<double>(k) / kLineParts;
    // Where the arm leaves its branch the line is no motion; read-back says so.
    part.to = k == kLineParts ? line.to : OnLine(carrier, line.from, line.to, share).value_or(part.from);
    if (carrier.ride) part.external_to = carrier.ride->At(share);
    steps.push_back(part);
    part.from = part.to;
    if (carrier.ride) part.external = part.external_to;
  }
}

std::string NameOf(const LinkMoveEnd& end) {
  return end.pass < 0 ? "home" : fmt::format("pass {} piece {}", end.pass, end.piece);
}

void AddCuts(const PlanResult& plan, const PassResult& pass, size_t& first_number, std::vector<Step>& steps) {
  Carrier carrier{plan.arm, BaseAt(plan, pass.external), plan.X_FT};
  const auto add = [&](int from, int to) {
    const ExternalPosition &here = ExternalAt(pass, static_cast<size_t>(from)),
                           &there = ExternalAt(pass, static_cast<size_t>(to));
    if (pass.points[static_cast<size_t>(to)].external)
      carrier.ride = std::make_shared<CoordinatedMotion>(
          CoordinatedMotion{Mechanism(plan.external_axes), plan.X_WB, plan.X_WP, here, there});
    const Joints& start = pass.points[static_cast<size_t>(from)].q;
    // A ring's joints have turned by full revolutions when it comes by its first point again.
    const Joints end = NearestEquivalent(start, pass.points[static_cast<size_t>(to)].q);
    AddLine(carrier,
            {start, end, true, 1,
             fmt::format("point {} to {}", first_number + static_cast<size_t>(from),
                         first_number + static_cast<size_t>(to)),
             here},
            steps);
  };
  for (const Segment& piece : pass.pieces) {
    for (int i = piece.first; i < piece.last; ++i) add(i, i + 1);
    if (piece.closed) add(piece.last, piece.first);
  }
  first_number += pass.points.size();
}

void AddLinkMove(const PlanResult& plan, const LinkMove& gap, const std::pair<LinkMoveEnd, LinkMoveEnd>& ends,
                 std::vector<Step>& steps) {
  if (!gap.planned || gap.joints.empty()) return;
  const auto& [from, to] = ends;
  const double share = gap.clearance_share;
  const std::string name = fmt::format("the way from {} to {}", NameOf(from), NameOf(to));
  ExternalPosition here = gap.external ? gap.external->from : from.pass >= 0 ? from.external : to.external;
  const auto carrier = [&] { return Carrier{plan.arm, BaseAt(plan, here), plan.X_FT}; };
  const auto move = [&](size_t at) {
    if (!gap.external || static_cast<size_t>(gap.external->at) != at) return;
    steps.push_back({gap.joints[at], gap.joints[at], false, 1, name, here, &*gap.external});
    here = gap.external->to;
  };
  if (from.pass >= 0) AddLine(carrier(), {from.q, gap.joints.front(), true, share, name, here}, steps);
  move(0);
  for (size_t i = 1; i < gap.joints.size(); ++i) {
    steps.push_back({gap.joints[i - 1], gap.joints[i], false, share, name, here});
    move(i);
  }
  if (to.pass >= 0) AddLine(carrier(), {gap.joints.back(), to.q, true, share, name, here}, steps);
}

std::vector<Step> StepsOf(const PlanResult& plan) {
  std::vector<Step> steps;
  size_t number = 0;
  for (const PassResult& pass : plan.passes) AddCuts(plan, pass, number, steps);
  const auto ends = LinkMoveEnds(HomeOf(plan), plan.passes);
  for (size_t i = 0; i < std::min(plan.gaps.size(), ends.size()); ++i)
    AddLinkMove(plan, plan.gaps[i], ends[i], steps);
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
      if (near.distance <= 0 && !steps[i].move) continue;  // a contact
      AuditPair& pair = entry(near.first, near.second, steps[i].name);
      ++pair.too_near;
      ++figures->clearance_violations;
      if (near.distance >= pair.least_mm) continue;
      pair.least_mm = near.distance;
      pair.wanted_mm = near.wanted;
    }
  }
}

void AuditMotions(const PlanResult& plan, const Cell& cell, const AuditRules& rules,
                  const Execution& execution, AuditFigures* figures) {
  const double resolution = rules.resolution;
  audit::Setup setup = MakeJudgeSetup(cell);
  for (size_t i = 0; rules.deviations && i < setup.deviations.size(); ++i)
    setup.deviations[i] = DeviationOf(*rules.deviations, i).matrix().cast<audit::Real>();
  if (rules.deviations) {
    for (const JointHarmonic& wave : rules.deviations->law.harmonics)
      setup.waves.push_back({static_cast<size_t>(wave.joint) - 1, wave.harmonic, wave.amplitude, wave.phase});
    for (const JointCoupling& pair : rules.deviations->law.couplings)
      setup.followers.push_back(
          {static_cast<size_t>(pair.joint) - 1, static_cast<size_t>(pair.follows) - 1, pair.factor});
  }
  std::vector<Step> steps;
  if (!rules.deviations) steps = StepsOf(plan);
  const PlanResult commanded = Commanded(plan);  // whose moves its steps point at
  if (HasCommanded(plan)) std::ranges::move(StepsOf(commanded), std::back_inserter(steps));
  std::vector<Found> found(steps.size());
  // A judge has a state of its own: one for each share of the steps.
  const auto parts = static_cast<size_t>(std::max(1, execution.Threads()));
  ParallelFor(parts, execution.Threads(), execution.stop, [&](size_t part) {
    audit::Judge judge(setup);
    ExternalPosition stands;
    for (size_t i = part; i < steps.size(); i += parts) {
      CheckStop(execution.stop);
      const Step& step = steps[i];
      const audit::Angles from = ToJudge(step.from), to = ToJudge(step.to);
      if (step.move) {
        found[i].near =
            judge.Moving(ToJudge(step.move->from), ToJudge(step.move->to), from, resolution, kNearTravel);
        stands = step.move->to;
        continue;
      }
      audit::Motion motion{from, to, step.cutting};
      if (!step.external_to.empty()) {
        motion.external_from = ToJudge(step.external), motion.external_to = ToJudge(step.external_to);
        stands = step.external_to;
      } else if (stands != step.external) {
        judge.Stand(ToJudge(stands = step.external));
      }
      found[i].contact = judge.Between(motion, kTravel);
      found[i].near = judge.TooNear(motion, step.share, resolution, kNearTravel);
    }
  });
  Collect(steps, found, figures);
}

}  // namespace

AuditFigures Audit(const PlanResult& plan, const Mesh& mesh, const Cell& cell, const AuditRules& rules,
                   const Execution& execution) {
  AuditFigures figures;
  AuditPoints(plan, mesh, rules, &figures);
  AuditMotions(plan, cell, rules, execution, &figures);
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
