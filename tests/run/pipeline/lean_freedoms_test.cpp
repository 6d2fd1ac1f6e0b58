// SPDX-License-Identifier: GPL-3.0-or-later
// From lead_deg and tilt_deg to the freedoms of the pose search: docs/lean.md.
#include "job/lean_freedoms.hpp"

#include "job/assemble.hpp"
#include "job/workpiece.hpp"
#include "planning/pose/lean_problem.hpp"
#include "store/checkpoint_key.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

const Override kLead{"toolpath.lead_deg", "{from: 0.5, to: 3, step: 0.5}"};
const Override kTilt{"toolpath.tilt_deg", "{from: -2, to: 2, step: 1}"};
const Override kScallop{"toolpath.scallop_mm", "0.02"};

PoseProblem ProblemOf(const JobInputs& inputs, const PreparedJob& prepared) {
  PoseProblem problem = MakePoseProblem(inputs.job, inputs.cell, prepared.cell);
  BoundLeans(inputs, prepared.surface.mesh, prepared.cell.X_WP, &problem);
  return problem;
}

TEST(BoundLeans, AddsThoseThatAreRangesInTheirOrder) {
  const PreparedJob& prepared = FreshPlan().prepared;
  EXPECT_FALSE(ProblemOf(SmallInputs(), prepared).lean);
  EXPECT_EQ(ProblemOf(SmallInputs(), prepared).freedoms.size(), 1u);
  const JobInputs both = SmallInputs({kTilt, kLead, kScallop});
  const PoseProblem problem = ProblemOf(both, prepared);
  ASSERT_EQ(problem.freedoms.size(), 3u);
  EXPECT_EQ(problem.freedoms[0]->Name(), "rotation");
  EXPECT_EQ(problem.freedoms[1]->Name(), "lead");
  EXPECT_EQ(problem.freedoms[2]->Name(), "tilt");
  EXPECT_DOUBLE_EQ(problem.freedoms[1]->Lower(), DegToRad(0.5));
  EXPECT_DOUBLE_EQ(problem.freedoms[1]->Nominal(), DegToRad(0.5)) << "nearest to 0";
  EXPECT_DOUBLE_EQ(problem.freedoms[2]->Upper(), DegToRad(2));
  ASSERT_TRUE(problem.lean);
  EXPECT_TRUE(problem.lean->lead_free && problem.lean->tilt_free && problem.lean->back_and_forth);
  EXPECT_TRUE(problem.lean->by_scallop) << "parallel planes are as near as the scallop asks for";
  EXPECT_EQ(problem.lean->scallop, 0.02);
  EXPECT_EQ(problem.lean->stepover, 40);
  const PoseProblem one = ProblemOf(SmallInputs({kLead, kScallop, {"toolpath.tilt_deg", "1"}}), prepared);
  ASSERT_EQ(one.freedoms.size(), 2u);
  EXPECT_FALSE(one.lean->tilt_free);
  EXPECT_DOUBLE_EQ(one.lean->tilt, DegToRad(1));
}

TEST(BoundLeans, GougesThatAreOnlyReportedBarNoLean) {
  const PreparedJob& prepared = FreshPlan().prepared;
  const auto tolerance = [&](const std::string& action) {
    const JobInputs inputs =
        SmallInputs({kLead, kScallop, {"toolpath.gouges", "{action: " + action + ", tolerance_mm: 0.07}"}});
    return ProblemOf(inputs, prepared).lean->surface->tolerance();
  };
  EXPECT_EQ(tolerance("skip"), 0.07);
  EXPECT_EQ(tolerance("lift"), 0.07);
  EXPECT_TRUE(std::isinf(tolerance("report")));
}

TEST(CheckJobGouges, LeavesToLeansWhatGougesAtTheNominalOne) {
  const auto check = [](const std::vector<Override>& more) {
    JobToolpath made = FreshPlan().prepared.made;
    MillingPoint& sunk = made.toolpath.passes[0].points[1];
    sunk.position -= sunk.normal;  // 1 mm below the surface, and the ways to it
    CheckJobGouges(SmallInputs(more), FreshPlan().prepared.surface.mesh, {.threads = 2}, made);
    return made;
  };
  const JobToolpath upright = check({});
  EXPECT_NEAR(upright.toolpath.passes[0].points[1].gouge, 1, 0.05);
  ASSERT_EQ(upright.warnings.size(), FreshPlan().prepared.made.warnings.size() + 1);
  EXPECT_NE(upright.warnings.back().find("; 3 points are skipped"), std::string::npos);
  const JobToolpath leaning = check({kLead, kScallop});
  EXPECT_EQ(leaning.toolpath.passes[0].points[1].gouge, 0);
  EXPECT_NE(leaning.warnings.back().find("; 3 points are planned at another lean or skipped"),
            std::string::npos);
}

TEST(BoundLeans, EveryPartOfARangeIsPartOfCheckpoints) {
  const PreparedJob& prepared = FreshPlan().prepared;
  const auto key = [&](const std::string& range) {
    return PassContext(ProblemOf(SmallInputs({{"toolpath.lead_deg", range}, kScallop}), prepared),
                       prepared.world, {});
  };
  const std::string one = key("{from: 0.5, to: 3, step: 0.5}");
  EXPECT_EQ(key("{from: 0.5, to: 3, step: 0.5, nominal: 0.5}"), one);
  for (const char* other : {"{from: 0.4, to: 3, step: 0.5, nominal: 0.5}", "{from: 0.5, to: 3.1, step: 0.5}",
                            "{from: 0.5, to: 3, step: 0.25}", "{from: 0.5, to: 3, step: 0.5, nominal: 1}"})
    EXPECT_NE(key(other), one) << other;
}

TEST(CheckLeanRanges, RefusesWhatACutterWithAFlatCannotFollow) {
  const auto refusal = [](const std::vector<Override>& more) {
    return RefusalOf([&] { SmallInputs(more); });
  };
  EXPECT_EQ(refusal({kLead, kScallop}), "accepted");
  EXPECT_NE(
      refusal({kLead}).find("toolpath.lead_deg: what a leaning cutter with a flat leaves between passes "
                            "must be bounded; give toolpath.scallop_mm"),
      std::string::npos);
  const Override through{"toolpath.lead_deg", "{from: -1, to: 3, step: 0.5}"};
  EXPECT_NE(refusal({through, kScallop}).find("toolpath.lead_deg: the range holds the upright axis"),
            std::string::npos);
  EXPECT_EQ(refusal({through, kScallop, {"toolpath.tilt_deg", "0.1"}}), "accepted") << "never upright";
  EXPECT_NE(refusal({kTilt, kScallop}).find("toolpath.tilt_deg: the range holds the upright axis"),
            std::string::npos);
}

// A planned point leans as it was planned; what it cuts is worked out where the path was laid.
TEST(AsLaid, TakesALeanedPointBackToTheToolPath) {
  const JobInputs inputs = SmallInputs({kLead, kTilt, kScallop, {"toolpath.stepover_mm", "5"}});
  const PreparedJob prepared = PrepareJob(inputs, NoCheckpoints(), {.threads = 2});
  RandomStream random(5, 0);
  for (const Pass& pass : prepared.toolpath.passes)
    for (const MillingPoint& point : pass.points) {
      const FreedomValues leans{random.Uniform(-3, 3), DegToRad(random.Uniform(0.5, 3)),
                                DegToRad(random.Uniform(-2, 2))};
      const MillingPoint leaned = AtLean(prepared.problem, point, leans), back = AsLaid(inputs, leaned);
      EXPECT_GT((leaned.tool_axis - point.tool_axis).norm(), 1e-4);
      EXPECT_LT((back.position - point.position).norm(), 1e-9);
      EXPECT_LT((back.tool_axis - point.tool_axis).norm(), 1e-12);
      EXPECT_EQ(back.normal, point.normal);
    }
  const JobInputs upright = SmallInputs();
  const MillingPoint& point = FreshPlan().plan.passes[0].points[0].point;
  EXPECT_EQ(AsLaid(upright, point).position, point.position);
}

}  // namespace
}  // namespace millpose::test
