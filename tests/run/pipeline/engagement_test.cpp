// SPDX-License-Identifier: GPL-3.0-or-later
// What the cutter takes off along a job's path, and what follows where points before it are skipped.
#include "job/assemble.hpp"
#include "job/job_engagement.hpp"
#include "planning/result/skipped.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

/// Ten passes of five points side by side.
JobInputs WideInputs(std::vector<Override> more = {}) {
  std::vector<Override> overrides{{"toolpath.stepover_mm", "8"}, {"toolpath.spacing_mm", "20"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return SmallInputs(overrides);
}

struct Laid {
  JobInputs inputs;
  PreparedJob prepared;
  explicit Laid(const std::vector<Override>& more = {})
      : inputs(WideInputs(more)), prepared(PrepareJob(inputs, NoCheckpoints(), {.threads = 2})) {}
  const Mesh& mesh() const { return prepared.surface.mesh; }

  /// A plan of the path as laid, every point of it milled; poses do not matter here.
  PlanResult AsPlanned() const {
    PlanResult plan;
    plan.X_WP = prepared.cell.X_WP;
    plan.X_WB = prepared.cell.X_WB;
    plan.arm = prepared.cell.arm;
    for (const Pass& pass : prepared.toolpath.passes) {
      PassResult& planned = plan.passes.emplace_back();
      planned.pass = static_cast<int>(plan.passes.size()) - 1;
      for (const MillingPoint& point : pass.points) planned.points.emplace_back().point = point;
      planned.pieces.push_back({planned.pass, 0, 0, static_cast<int>(pass.points.size()) - 1});
    }
    return plan;
  }
};

const Laid& Wide() {
  static const Laid laid;
  return laid;
}

void Skip(PassResult& pass, Infeasibility why = Infeasibility::kInterference) {
  for (PlannedPoint& point : pass.points) point.skip = why;
  pass.pieces.clear();
}

std::vector<double> ForcesOfPass(const PassResult& pass) {
  std::vector<double> forces;
  for (const PlannedPoint& point : pass.points) forces.push_back(point.point.engagement.force.norm());
  return forces;
}

std::vector<std::vector<char>> PointsOf(const Toolpath& path, const auto& wanted) {
  std::vector<std::vector<char>> of;
  for (size_t p = 0; p < path.passes.size(); ++p) {
    of.emplace_back(path.passes[p].points.size());
    for (size_t i = 0; i < of[p].size(); ++i) of[p][i] = wanted(p, i);
  }
  return of;
}

TEST(SetJobEngagement, DoesNothingWithoutAWordOnWhatIsCut) {
  JobInputs inputs = Wide().inputs;
  inputs.job.cutting.reset();
  Toolpath path = Wide().prepared.made.toolpath;
  for (Pass& pass : path.passes)
    for (MillingPoint& point : pass.points) point.engagement = {{1, 2, 3}, 4, 5, CutSide::kUp};
  EXPECT_FALSE(SetJobEngagement(inputs, Wide().mesh(), {.threads = 2}, path));
  SetEngagementOf(PointsOf(path, [](size_t, size_t) { return true; }), inputs, Wide().mesh(), {.threads = 2},
                  path);
  for (const Pass& pass : path.passes)
    for (const MillingPoint& point : pass.points) EXPECT_EQ(point.engagement.width, 4);
  PlanResult plan = Wide().AsPlanned();
  Skip(plan.passes[0]);
  EXPECT_EQ(MissingCuts(inputs, Wide().mesh(), {.threads = 2}).Count(plan), "");
  EXPECT_EQ(MissingCuts(inputs, Wide().mesh(), {.threads = 2}).LeaveOut(plan), 0u);
  EXPECT_EQ(EntriesOnMaterial(inputs, Wide().mesh(), plan), "");
}

TEST(SetJobEngagement, OfSomePointsIsThatOfAll) {
  const Toolpath& whole = Wide().prepared.made.toolpath;
  Toolpath cleared = whole;
  for (Pass& pass : cleared.passes)
    for (MillingPoint& point : pass.points) point.engagement = {};
  const std::vector<std::vector<char>> of =
      PointsOf(whole, [](size_t p, size_t i) { return p == 1 || (p == 4 && i % 3 == 1); });
  SetEngagementOf(of, Wide().inputs, Wide().mesh(), {.threads = 2}, cleared);
  for (size_t p = 0; p < whole.passes.size(); ++p)
    for (size_t i = 0; i < whole.passes[p].points.size(); ++i) {
      const Engagement &now = cleared.passes[p].points[i].engagement,
                       &before = whole.passes[p].points[i].engagement;
      EXPECT_EQ(now.force, of[p][i] != 0 ? before.force : Eigen::Vector3d(Eigen::Vector3d::Zero()));
      EXPECT_EQ(now.width, of[p][i] != 0 ? before.width : 0);
    }
}

// Passes 8 mm apart cut as wide as that but for the first, which stands in full material up to its outer
// edge.
TEST(SetJobEngagement, PassesBesideOneAnotherAreCutAsWideAsTheyAreApart) {
  const auto& passes = Wide().prepared.made.toolpath.passes;
  ASSERT_EQ(passes.size(), 10u);
  for (size_t p = 1; p < passes.size(); ++p) {
    const Engagement& middle = passes[p].points[2].engagement;
    EXPECT_NEAR(middle.width, p < 9 ? 8 : 2, 0.3)
        << p;  // the last one, 4 mm from the edge, takes what is left
    EXPECT_NEAR(middle.depth, 1, 1e-6);
    EXPECT_EQ(middle.side,
              p % 2 == 1 ? passes[1].points[2].engagement.side : passes[2].points[2].engagement.side);
  }
  EXPECT_NE(passes[1].points[2].engagement.side, passes[2].points[2].engagement.side) << "a zigzag";
  EXPECT_GT(passes[0].points[2].engagement.width, 12);
}

TEST(SetJobEngagement, AStatedSideHoldsEverywhere) {
  const Laid slot(std::vector<Override>{{"process.cutting.side", "slot"}});
  const double force = slot.prepared.made.toolpath.passes[0].points[0].engagement.force.norm();
  EXPECT_GT(force, 1);
  for (const Pass& pass : slot.prepared.made.toolpath.passes)
    for (const MillingPoint& point : pass.points) {
      EXPECT_EQ(point.engagement.side, CutSide::kSlot);
      EXPECT_NEAR(point.engagement.force.norm(), force, 1e-9);
    }
  PlanResult plan = slot.AsPlanned();
  Skip(plan.passes[0]);
  EXPECT_EQ(MissingCuts(slot.inputs, slot.mesh(), {.threads = 2}).LeaveOut(plan), 0u)
      << "nothing is taken from the stock";
}

// With a raw part what stands of it is cut, however deep the job says its layer is; without, or on request,
// the layer.
TEST(SetJobEngagement, CutsWhatStandsOfTheRawPart) {
  const auto cut = [](std::vector<Override> more) {
    return Laid(more).prepared.made.toolpath.passes[4].points[2].engagement;
  };
  const Override raw{"workpiece.stock", "{box: {lower_mm: [-40, -40, -20], upper_mm: [40, 40, 3]}}"};
  const Engagement layer = cut({}), three = cut({raw}), asked = cut({raw, {"process.stock", "region"}});
  EXPECT_NEAR(layer.depth, 1, 1e-6);
  EXPECT_NEAR(three.depth, 3, 1e-6);
  EXPECT_NEAR(three.force.norm(), 3 * layer.force.norm(), 0.03 * three.force.norm());
  EXPECT_EQ(asked.force, layer.force);
}

TEST(SetJobEngagement, WhatCannotBeOrContradictsThePathIsNamed) {
  const auto refusal = [](std::vector<Override> more) { return RefusalOf([&] { const Laid laid(more); }); };
  const auto expect = [&](std::vector<Override> more, const std::string& words) {
    const std::string told = refusal(std::move(more));
    EXPECT_NE(told.find(words), std::string::npos) << told;
  };
  expect({{"toolpath.depth", "{total_mm: 3, per_layer_mm: 1}"}, {"process.cutting.depth_mm", "2"}},
         "process.cutting.depth_mm: given 2, but the layers of toolpath.depth are 1 mm deep");
  EXPECT_EQ(
      refusal({{"toolpath.depth", "{total_mm: 3, per_layer_mm: 1}"}, {"process.cutting.depth_mm", "1"}}),
      "accepted");
  expect({{"process.cutting", "{material: 5A06, teeth: 4}"}},
         "process.cutting.depth_mm: missing; required where toolpath.depth gives no layers");
  expect({{"process.cutting.width_mm", "21"}}, "allowed: at most the cutter's diameter, 20 mm");
  expect({{"process.cutting.width_mm", "5"}}, "given 5, but passes are 8 mm apart (toolpath.stepover_mm)");
  EXPECT_EQ(refusal({{"process.cutting.width_mm", "8"}}), "accepted");
  expect({{"process.cutting.width_mm", "8"}, {"toolpath.scallop_mm", "0.01"}},
         "width_mm: is taken from path and stock where no side is given");
  expect({{"process.cutting.side", "up"}, {"toolpath.scallop_mm", "0.01"}},
         "process.cutting.width_mm: missing; required with side up");
  expect({{"process.stock", "mesh"}}, "process.stock: given mesh; the job needs workpiece.stock");
}

TEST(MissingCuts, SaysNothingWhereNothingIsSkippedAndChangesNothing) {
  PlanResult plan = Wide().AsPlanned();
  const std::string before = Serialise(plan);
  EXPECT_EQ(MissingCuts(Wide().inputs, Wide().mesh(), {.threads = 2}).Count(plan), "");
  EXPECT_EQ(MissingCuts(Wide().inputs, Wide().mesh(), {.threads = 2}).LeaveOut(plan), 0u);
  EXPECT_EQ(Serialise(plan), before);
}

// What a pass leaves standing the one after it has to take: its forces rise, those before it stay.
TEST(MissingCuts, TheNeighbourOfASkippedPassCutsMore) {
  PlanResult plan = Wide().AsPlanned();
  Skip(plan.passes[3]);
  const PlanResult before = plan;
  const std::string told = MissingCuts(Wide().inputs, Wide().mesh(), {.threads = 2}).Count(plan);
  EXPECT_TRUE(told.starts_with("5 points are skipped, and the material that they leave is cut at ")) << told;
  for (const size_t same : {0u, 1u, 2u, 6u, 9u}) {
    const auto was = ForcesOfPass(before.passes[same]), is = ForcesOfPass(plan.passes[same]);
    for (size_t i = 0; i < was.size(); ++i) EXPECT_NEAR(is[i], was[i], 0.05) << same;  // slices of the edge
  }
  EXPECT_GT(ForcesOfPass(plan.passes[4])[2], 1.2 * ForcesOfPass(before.passes[4])[2]);
  EXPECT_GT(plan.passes[4].points[2].point.engagement.width, 12);
  EXPECT_EQ(plan.passes[4].points[2].point.position, before.passes[4].points[2].point.position);
  // Whatever number of threads works it out.
  PlanResult alone = before;
  EXPECT_EQ(MissingCuts(Wide().inputs, Wide().mesh(), {.threads = 1}).Count(alone), told);
  EXPECT_EQ(Serialise(alone), Serialise(plan));
}

TEST(MissingCuts, LeavesOutWhatWouldCutMuchWiderThanTheJobsOwnCuts) {
  PlanResult plan = Wide().AsPlanned();
  for (const size_t p : {3u, 4u}) Skip(plan.passes[p]);
  const double own = plan.passes[0].points[2].point.engagement.width;
  PlanResult cut = plan;
  JobInputs inputs = Wide().inputs;
  inputs.job.over_missing = OverMissing::kCut;
  EXPECT_EQ(MissingCuts(inputs, Wide().mesh(), {.threads = 2}).LeaveOut(cut), 0u);
  EXPECT_EQ(Serialise(cut), Serialise(plan));
  const size_t left_out = MissingCuts(Wide().inputs, Wide().mesh(), {.threads = 2}).LeaveOut(plan);
  // Until every cut that is left is no more than a fifth wider than the job's widest.
  MissingCuts(Wide().inputs, Wide().mesh(), {.threads = 2}).Count(plan);
  size_t pieces = 0, next_to_skipped = 0;
  for (const PassResult& pass : plan.passes) {
    pieces += pass.pieces.size();
    for (const PlannedPoint& point : pass.points) {
      if (point.skip == Infeasibility::kNone) {
        EXPECT_LE(point.point.engagement.width, 1.2 * own + 1e-6);
      }
      if (point.skip == Infeasibility::kOverMissing) {
        EXPECT_NE(point.detail.find("next to the material that point "), std::string::npos) << point.detail;
        next_to_skipped += point.detail.find(", interference) leaves; ") != std::string::npos ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(pieces + left_out, 8u);
  EXPECT_EQ(next_to_skipped, 5u) << "one pass, and those over it in turn";
}

TEST(EntriesOnMaterial, AreToldOfAToolThatDoesNotCutAtItsCentre) {
  JobInputs inputs = Wide().inputs;
  const PlanResult plan = Wide().AsPlanned();
  inputs.cell.tool.centre_cutting = true;
  EXPECT_EQ(EntriesOnMaterial(inputs, Wide().mesh(), plan), "");
  inputs.cell.tool.centre_cutting = false;
  const std::string told = EntriesOnMaterial(inputs, Wide().mesh(), plan);
  EXPECT_NE(told.find(" of 10 entries, first at point 0 (pass 0)"), std::string::npos) << told;
  // An entry that is skipped is made where the pass begins then.
  PlanResult later = plan;
  later.passes[0].points[0].skip = Infeasibility::kInterference;
  EXPECT_NE(EntriesOnMaterial(inputs, Wide().mesh(), later).find("first at point 1 (pass 0)"),
            std::string::npos);
}

TEST(ChipExponent, IsTheMaterialsUnlessTheJobGivesItsOwn) {
  JobSettings job = Wide().inputs.job;
  EXPECT_GT(ChipExponent(job), 0.1);
  job.cutting->kc11 = 700;
  job.cutting->mc = 0.31;
  EXPECT_EQ(ChipExponent(job), 0.31);
  job.cutting->kc11 = 0;
  job.cutting->material = "no such alloy";
  EXPECT_NE(RefusalOf([&] { ChipExponent(job); }).find("process.cutting.material: "), std::string::npos);
}

}  // namespace
}  // namespace millpose::test
