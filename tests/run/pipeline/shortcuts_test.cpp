// SPDX-License-Identifier: GPL-3.0-or-later
// A plan is a function of what its poses and motions are, whatever is tried before FCL is asked for a
// distance.
#include <nlohmann/json.hpp>

#include "job/assemble.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/links/job_planner.hpp"
#include "planning/pass/revolutions.hpp"
#include "run/pipeline/stages/plan_link_moves.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

using Json = nlohmann::json;

/// The passes and gaps of the small job in a world, without what was counted. A gap's least clearance is of
/// all its poses, where a distance may be proven that FCL has 10⁻¹² mm less: it is rounded.
Json PlanIn(const World& world, int threads) {
  const PreparedJob& prepared = FreshPlan().prepared;
  const JobInputs inputs = SmallInputs();
  const Stations stations(world, prepared.problem);
  const Execution execution{.threads = threads};
  std::vector<PassResult> passes =
      PlanPasses(stations, {prepared.toolpath, prepared.external, [](size_t) { return true; }},
                 MakePathOptions(inputs.job), NoCheckpoints(), execution)
          .passes;
  const AdmissibleBounds& bounds = prepared.problem.bounds;
  ChooseRevolutions(passes, {prepared.cell.home, bounds.lower, bounds.upper, false});
  const PlannedLinkMoves gaps =
      PlanAllLinkMoves(stations, passes, MakeLinkMoveOptions(inputs.job), NoCheckpoints(), execution);
  PlanResult plan;
  plan.passes = std::move(passes);
  plan.gaps = gaps.gaps;
  for (PassResult& pass : plan.passes) pass.pairs_checked = pass.pairs_saved = 0;
  for (LinkMove& gap : plan.gaps) gap.clearance = std::round(1e6 * gap.clearance);
  const Json whole = Json::from_cbor(Serialise(plan));
  Json parts = whole.at("passes");
  for (const Json& gap : whole.at("gaps")) parts.push_back(gap);
  return parts;
}

// A post where the elbow would be, and a clamp beside the part.
World NarrowWorld() {
  Cell cell = FreshPlan().prepared.cell;
  const Joints& q = FreshPlan().plan.passes[0].points[1].q;
  const Pose X_WL = cell.X_WB * LinkFrames(cell.arm, q)[3];
  cell.bodies.push_back({"post", BodyClass::kFixture, Mount::kWorld, 0,
                         At(X_WL.translation().x(), X_WL.translation().y() + 420, X_WL.translation().z()),
                         Sphere{80}});
  const Eigen::Vector3d clamp = cell.X_WP * Eigen::Vector3d(0, 95, 30);
  cell.bodies.push_back({"clamp", BodyClass::kFixture, Mount::kWorld, 0, At(clamp.x(), clamp.y(), clamp.z()),
                         Box{{30, 30, 30}}});
  return World(std::move(cell));
}

TEST(Shortcuts, ChangeNothingOfAPlan) {
  const World world = NarrowWorld();
  const Json plan = PlanIn(world, 1), same = Json::array();
  EXPECT_NE(plan, PlanIn(FreshPlan().prepared.world, 1)) << "nothing was in the way";
  EXPECT_EQ(Json::diff(plan, PlanIn(world, 2)), same);
  EXPECT_EQ(Json::diff(plan, PlanIn(world, 4)), same);
  EXPECT_EQ(Json::diff(plan, PlanIn(world.MeasuringAll(), 2)), same);
}

}  // namespace
}  // namespace millpose::test
