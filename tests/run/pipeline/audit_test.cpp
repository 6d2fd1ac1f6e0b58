// SPDX-License-Identifier: GPL-3.0-or-later
// `plan --audit` on plans that are sound and on ones with a single thing wrong; what the optima are judged
// by.
#include "run/pipeline/audit/audit.hpp"

#include "job/assemble.hpp"
#include "machine/robot/kinematics.hpp"
#include "report/samples/judge_optima.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

/// Tip at p, tool axis against the arm's own x, in a pose near the middle of its range.
Joints PoseAt(const Cell& cell, const Eigen::Vector3d& p) {
  const Joints near = Degrees(0, -63.9, 103.3, 0, 50, 0);
  Pose X_WT = ForwardFlange(cell.arm, near) * cell.X_FT;
  X_WT.translation() = p;
  return InverseNear(cell.arm, X_WT * cell.X_FT.inverse(), Status(cell.arm, near), near).value();
}

/// A ring of three corners 300 mm apart, and a block on the way from the third back to the first.
struct Ring {
  Cell cell = SampleCell();
  PlanResult plan;

  explicit Ring(bool closed) {
    const Eigen::Vector3d middle =
        (ForwardFlange(cell.arm, Degrees(0, -63.9, 103.3, 0, 50, 0)) * cell.X_FT).translation();
    plan.arm = cell.arm;
    plan.X_FT = cell.X_FT;
    PassResult& pass = plan.passes.emplace_back();
    const std::array<Eigen::Vector3d, 3> corners{middle, middle + Eigen::Vector3d(0, 300, 0),
                                                 middle + Eigen::Vector3d(0, 150, 260)};
    for (const Eigen::Vector3d& corner : corners) {
      PlannedPoint& point = pass.points.emplace_back();
      point.q = PoseAt(cell, corner);
      point.point.position = corner;
    }
    pass.pieces = {{0, 0, 0, 2, closed}};
    const Eigen::Vector3d half = (corners[2] + corners[0]) / 2;
    cell.bodies.push_back({"block", BodyClass::kFixture, Mount::kWorld, 0, At(half.x(), half.y(), half.z()),
                           Box{{30, 30, 30}}});
  }

  AuditFigures Judged() const {
    AuditRules rules{.bounds = {}, .cutter = {}, .resolution = 0.5};
    rules.bounds.lower = cell.arm.lower;
    rules.bounds.upper = cell.arm.upper;
    return Audit(plan, Mesh(Triangles{}), cell, rules, {.threads = 2});
  }
};

TEST(Audit, OfARingTheWayBackToItsFirstPointCountsToo) {
  const AuditFigures open = Ring(false).Judged(), closed = Ring(true).Judged();
  EXPECT_EQ(open.interferences, 0);
  EXPECT_GT(closed.interferences, 0);
  ASSERT_FALSE(closed.pairs.empty());
  EXPECT_EQ(closed.pairs[0].where, "point 2 to 0");
  Ring turned(true);
  turned.plan.passes[0].points[0].q[5] += 2 * kPi;  // on the way round
  EXPECT_EQ(turned.Judged().interferences, closed.interferences);
}

AuditFigures JudgedSmall(const std::function<void(PlanResult&, Cell&, AdmissibleBounds&)>& change) {
  const PlannedJob& job = FreshPlan();
  PlanResult plan = job.plan;
  plan.gaps.clear();
  Cell cell = job.prepared.cell;
  AuditRules rules{.bounds = job.prepared.problem.bounds, .cutter = {}, .resolution = 0.5};
  change(plan, cell, rules.bounds);
  return Audit(plan, job.prepared.surface.mesh, cell, rules, {.threads = 2});
}

TEST(Audit, ASoundPlanHasNoFindings) {
  const AuditFigures figures = JudgedSmall([](PlanResult&, Cell&, AdmissibleBounds&) {});
  EXPECT_TRUE(Findings(figures).empty());
  EXPECT_LT(figures.max_slice_distance_mm, 1e-6);
}

TEST(Audit, EachThingThatIsWrongShowsInItsOwnFigure) {
  AuditFigures figures = JudgedSmall([](PlanResult&, Cell&, AdmissibleBounds& bounds) {
    bounds.upper[0] = bounds.lower[0];  // no pose is within
  });
  EXPECT_EQ(figures.limit_violations, 6);
  EXPECT_EQ(Findings(figures), std::vector<std::string>{"audit: 6 points beyond the limits"});
  figures = JudgedSmall([](PlanResult& plan, Cell&, AdmissibleBounds&) {
    plan.X_WP.translation() += plan.X_WP.linear() * Eigen::Vector3d(0, 0, -3);
  });
  EXPECT_NEAR(figures.max_slice_distance_mm, 3, 1e-6);
  figures = JudgedSmall([](PlanResult& plan, Cell& cell, AdmissibleBounds&) {
    const Eigen::Vector3d at =
        plan.passes[1].points[1].point.position + 200 * plan.passes[1].points[1].point.tool_axis;
    cell.bodies.push_back(
        {"clamp", BodyClass::kFixture, Mount::kWorld, 0, At(at.x(), at.y(), at.z()), Box{{20, 20, 20}}});
  });
  EXPECT_GT(figures.interferences, 0);
  const std::vector<std::string> findings = Findings(figures);
  ASSERT_FALSE(findings.empty());
  EXPECT_TRUE(std::ranges::all_of(findings, [](const std::string& finding) {
    return finding.find("clamp") != std::string::npos && finding.find("point ") != std::string::npos;
  })) << findings[0];
}

TEST(Audit, FindingsNameThePairOnceForEachThing) {
  AuditFigures figures;
  figures.pairs.push_back({"base", "holder", 2, 5, -1, 10, "point 7 to 8"});
  figures.pairs.push_back({"base", "cutter", 0, 1, 8.5, 9.5, "the way from home to pass 0 piece 0"});
  EXPECT_EQ(Findings(figures),
            (std::vector<std::string>{"audit: holder touches base on 2 motions, first on point 7 to 8",
                                      "audit: holder comes within -1.00 mm of base, 10.00 mm are to be kept, "
                                      "on 5 motions, first on point 7 to 8",
                                      "audit: cutter comes within 8.50 mm of base, 9.50 mm are to be kept, "
                                      "on 1 motions, first on the way "
                                      "from home to pass 0 piece 0"}));
}

TEST(JudgeOptima, NoPointIsPlannedBelowTheJudgesOptimum) {
  PlanResult plan = FreshPlan().plan;
  AuditFigures figures;
  const JobInputs inputs = SmallInputs();
  JudgeOptima(FreshPlan().prepared.stations, inputs.job.path.genetic, DegToRad(0.25), {.threads = 2}, plan,
              figures);
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      EXPECT_GE(point.objective, point.exhaustive_optimum * (1 - 1e-9));
      EXPECT_EQ(point.exhaustive_optimum > 0, !point.point.engagement.force.isZero());
      if (point.point.engagement.force.isZero()) continue;
      EXPECT_NEAR(point.own_optimum / point.exhaustive_optimum, 1, 1e-6);
    }
  EXPECT_EQ(figures.ga_share_within_0p1_percent, 100);
  EXPECT_LT(figures.ga_worst_gap_percent, 0.1);
  ASSERT_TRUE(figures.ga_share_without_table_percent);
  EXPECT_GE(*figures.ga_share_without_table_percent, 0);
}

TEST(JudgeOptima, AGeneticOptimumThatIsMissedShows) {
  PlanResult plan = FreshPlan().plan;
  plan.passes[0].points[0].genetic_optimum *= 1.5;
  plan.passes[0].points[1].genetic_optimum = 0;  // it found none
  plan.passes[1].points[0].point.gouge = 1;      // not to be milled, so not judged
  AuditFigures figures;
  JudgeOptima(FreshPlan().prepared.stations, SmallInputs().job.path.genetic, DegToRad(1), {.threads = 2},
              plan, figures);
  EXPECT_EQ(plan.passes[1].points[0].exhaustive_optimum, 0);
  // The last point of each pass cuts nothing: there is nothing to judge by. One of three is left.
  EXPECT_NEAR(figures.ga_share_within_0p1_percent, 100.0 / 3, 1e-9);
  EXPECT_NEAR(figures.ga_worst_gap_percent, 100, 1e-9);
}

}  // namespace
}  // namespace millpose::test
