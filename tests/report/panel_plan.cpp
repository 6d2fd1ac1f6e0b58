// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/report/panel_plan.hpp"

#include "planning/pass/tell_nearest.hpp"
#include "planning/result/point_clearance.hpp"
#include "planning/result/verdict_map.hpp"
#include "program/make_timeline.hpp"
#include "report/samples/axis_map.hpp"
#include "report/samples/sample_curves.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {
namespace {

Triangles PanelMesh(const PanelSize& size) {
  constexpr int kAcross = 40, kUp = 20;
  Triangles mesh;
  for (int u = 0; u <= kAcross; ++u)
    for (int v = 0; v <= kUp; ++v)
      mesh.vertices.push_back(PanelPoint((double(u) / kAcross - 0.5) * (size.width + 60),
                                         (double(v) / kUp - 0.5) * (size.height + 60))
                                  .position);
  for (int u = 0; u < kAcross; ++u) {
    for (int v = 0; v < kUp; ++v) {
      const int at = u * (kUp + 1) + v, next = at + kUp + 1;
      mesh.faces.push_back({at, at + 1, next});
      mesh.faces.push_back({next, at + 1, next + 1});
    }
  }
  return mesh;
}

/// The admissible candidate with the least objective among those whose joints are nearest to `last`: within
/// 10° when there is one.
void ChoosePose(const PointScorer& scorer, const RotationGrid& grid, std::optional<Joints>& last,
                PlannedPoint& point) {
  std::vector<FreedomValues> rotations;
  for (int i = 0; i < grid.count; ++i) rotations.push_back({grid.first + i * grid.step});
  std::vector<Candidate> candidates(8 * rotations.size());
  scorer.Score(rotations, candidates);
  double least = std::numeric_limits<double>::infinity(), best = least;
  size_t chosen = candidates.size(), own = 0;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    if (c.obstacle != Infeasibility::kNone) continue;
    if (c.objective < least) least = c.objective, own = i;
    const double jump = last ? (c.q - *last).cwiseAbs().maxCoeff() : 0;
    const double cost = c.objective * (1 + 20 * std::max(0.0, jump - DegToRad(10)));
    if (cost < best) best = cost, chosen = i;
  }
  if (chosen == candidates.size()) {
    point.skip = Infeasibility::kLimit;
    point.detail = "no admissible pose on any branch";
    return;
  }
  point.freedoms = rotations[chosen / 8];
  point.branch = static_cast<int>(chosen % 8);
  point.q = candidates[chosen].q;
  point.objective = candidates[chosen].objective;
  point.own_optimum = point.genetic_optimum = point.free_optimum = least;
  point.own_rotation = point.free_rotation = rotations[own / 8][0];
  point.own_branch = point.free_branch = static_cast<int>(own % 8);
  point.unsmoothed = point.objective;
  last = point.q;
}

/// A stripe of two pairs that interfere, slanting through the map, and a free one beside it.
void FillVerdicts(double along, PlannedPoint& point) {
  AxisVerdicts verdicts(8 * kAxisRotations, kVerdictUnknown);
  const int middle = 40 + static_cast<int>(0.03 * along);
  for (int branch = 0; branch < 8; ++branch)
    for (int i = middle - 8; i < middle + 16; ++i)
      verdicts[static_cast<size_t>(branch * kAxisRotations + i)] = i < middle       ? kVerdictPair
                                                                   : i < middle + 8 ? kVerdictPair + 1
                                                                                    : kVerdictFree;
  point.verdicts = PackVerdicts(verdicts);
}

void FillIndices(const PoseProblem& problem, PlannedPoint& point) {
  const Matrix6 J = Jacobian(problem.arm, point.q, problem.X_FT.translation());
  const Eigen::Matrix3d c = Compliance(J, problem.arm.stiffness).topLeftCorner<3, 3>();
  point.indices = *IndicesInPlane(c, problem.X_WB.linear().transpose() * point.point.normal);
  point.dexterity = Dexterity(J, problem.characteristic_length);
}

PassResult MakePass(const PoseProblem& problem, const PanelSize& size, int number,
                    std::optional<Joints>& last) {
  PassResult pass;
  pass.pass = number;
  const double z = size.height * (size.passes > 1 ? double(number) / (size.passes - 1) - 0.5 : 0);
  for (int i = 0; i < size.points; ++i) {
    const double along = size.width * (size.points > 1 ? double(i) / (size.points - 1) : 0);
    PlannedPoint point;
    point.point = PanelPoint(number % 2 ? size.width / 2 - along : along - size.width / 2, z);
    if (number % 2) point.point.feed *= -1;
    point.point.arc_length = along;
    if (i == 0) point.point.kind = PointKind::kLeadIn;
    if (i + 1 == size.points) point.point.kind = PointKind::kLeadOut;
    const PointScorer scorer(problem, point.point, pass.rotation_reference);
    ChoosePose(scorer, CurveGrid(), last, point);
    if (number + 1 == size.passes && i % 10 == 9) {
      point.skip = Infeasibility::kInterference;
      point.detail = "spindle against workpiece </script><b>";
    }
    if (point.skip == Infeasibility::kNone) FillIndices(problem, point);
    FillVerdicts(along, point);
    pass.points.push_back(std::move(point));
  }
  pass.pairs = {"link4 and panel", "spindle and platform"};
  pass.points[0].barred = 0;
  pass.pieces = {{number, 0, 0, size.points - 1, false}};
  return pass;
}

/// From home over all passes and back, straight in joint space between places 50 mm off the panel.
void AddLinkMoves(PlanResult& plan) {
  const auto away = [&](const PlannedPoint& point) {
    const Pose X_BF = plan.X_WB.inverse() * ForwardFlange(plan.arm, point.q) * plan.X_FT *
                      Eigen::Translation3d(0, 0, 50) * plan.X_FT.inverse();
    return InverseNear(plan.arm, X_BF, Status(plan.arm, point.q), point.q).value_or(point.q);
  };
  const auto planned = [](const PlannedPoint& point) { return point.skip == Infeasibility::kNone; };
  const int count = static_cast<int>(plan.passes.size());
  for (int i = 0; i <= count; ++i) {
    LinkMove& gap = plan.gaps.emplace_back();
    gap.planned = true;
    gap.from_pass = i - 1, gap.to_pass = i < count ? i : -1;
    gap.from_piece = gap.from_pass < 0 ? -1 : 0, gap.to_piece = gap.to_pass < 0 ? -1 : 0;
    gap.joints.push_back(i > 0 ? away(*std::find_if(plan.passes[i - 1].points.rbegin(),
                                                    plan.passes[i - 1].points.rend(), planned))
                               : plan.home);
    gap.joints.push_back(i < count ? away(*std::ranges::find_if(plan.passes[i].points, planned)) : plan.home);
  }
  plan.gaps[1].planned = false;
  plan.gaps[1].joints.clear();
  plan.gaps[1].detail = "link3 against platform";
  plan.gaps.back().detail = "clearances reduced to 90 %";
}

}  // namespace

HtmlInput Panel::Input() const {
  HtmlInput input{plan, cell, CurveGrid(), Packed(curves), settings};
  input.map = &map;
  input.timeline = &timeline;
  return input;
}

Panel MakePanel(const PanelSize& size, const std::string& job) {
  Panel panel;
  panel.cell = test::SampleCell();
  panel.cell.bodies.push_back(
      {"panel", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, Pose::Identity(), PanelMesh(size)});
  panel.problem = MakeProblem(Kr500R2830());
  panel.problem.arm.speed = panel.cell.arm.speed;
  panel.problem.arm.acceleration = panel.cell.arm.acceleration;
  PlanResult& plan = panel.plan;
  plan.job = job;
  plan.cell = panel.cell.name;
  plan.seed = 7;
  plan.arm = panel.problem.arm;
  plan.X_FT = panel.problem.X_FT;
  plan.home = panel.cell.home;
  plan.objective_name = panel.problem.objective->Name();
  plan.objective_unit = panel.problem.objective->Unit();
  plan.stiffness_origin = StiffnessOrigin::kToolTip;
  std::optional<Joints> last;
  for (int p = 0; p < size.passes; ++p) plan.passes.push_back(MakePass(panel.problem, size, p, last));
  AddLinkMoves(plan);
  const World world(panel.cell);
  Checker checker(world);
  // Some points are as if nothing were near them.
  for (PassResult& pass : plan.passes)
    for (PlannedPoint& point : pass.points)
      TellNearest(point.point.arc_length > 0.8 * size.width
                      ? std::nullopt
                      : checker.Nearest(point.q, Phase::kCutting, kPointClearanceBound),
                  point, pass);
  panel.timeline = MakeTimeline(plan, {}, {});
  const Stations stations(world, panel.problem);
  panel.curves = SampleCurves(plan, stations, {}, 4000, {.threads = 2});
  panel.map = MakeAxisMap(plan, stations, panel.curves, false, {.threads = 2});
  panel.settings = "job: |\n  " + job + "\ntoolpath: {stepover_mm: 8}\n";
  return panel;
}

}  // namespace millpose
