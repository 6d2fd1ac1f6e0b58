// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "base/random.hpp"
#include "plan/plan_result.hpp"

namespace millpose {
namespace {

Eigen::Vector3d Vector(RandomStream& random) {
  return {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
}

PassResult RandomPass(RandomStream& random, int number) {
  PassResult pass;
  pass.pass = number;
  pass.rotation_reference = Vector(random);
  for (int i = 0; i < 7; ++i) {
    PlannedPoint point;
    point.point.position = 1000 * Vector(random);
    point.point.normal = Vector(random);
    point.point.feed = Vector(random);
    point.point.tool_axis = Vector(random);
    point.point.kind = PointKind::kLeadIn;
    point.skip = Obstacle::kStep;
    point.detail = "a \"quoted\" detail";
    point.freedoms = {random.Uniform()};
    point.q = Joints::Constant(random.Uniform());
    point.indices.lambda_n = random.Uniform() * 1e-4;
    point.from_genetic = true;
    point.unsmoothed = random.Uniform();
    point.free_optimum = random.Uniform();
    pass.points.push_back(point);
  }
  pass.pieces.push_back({number, 1, 2, 5, true});
  pass.grid_gap = random.Uniform();
  pass.bound = {random.Uniform(), random.Uniform(), random.Uniform(), random.Uniform()};
  return pass;
}

TEST(Serialise, APlanReadsBackToTheSameBytes) {
  RandomStream random(3, 0);
  PlanResult plan;
  plan.job = "job";
  plan.seed = 0xfedcba9876543210u;
  plan.arm.stiffness = Joints::Constant(8.9e9);
  plan.X_WP.translation() = Vector(random);
  plan.passes = {RandomPass(random, 0), RandomPass(random, 1)};
  Gap gap;
  gap.joints = {Joints::Constant(0.1), Joints::Constant(1.0 / 3)};
  gap.detail = "blocked";
  plan.gaps = {gap};
  const std::string bytes = Serialise(plan);
  const PlanResult back = ParsePlanResult(bytes, "x");
  EXPECT_EQ(Serialise(back), bytes);
  EXPECT_EQ(back.seed, plan.seed);
  EXPECT_EQ(back.passes[1].points[3].q, plan.passes[1].points[3].q);
  EXPECT_EQ(back.passes[1].points[3].point.position, plan.passes[1].points[3].point.position);
  EXPECT_EQ(back.passes[0].points[0].skip, Obstacle::kStep);
  EXPECT_EQ(back.passes[0].points[2].unsmoothed, plan.passes[0].points[2].unsmoothed);
  EXPECT_EQ(back.passes[0].points[2].free_optimum, plan.passes[0].points[2].free_optimum);
  EXPECT_EQ(back.passes[0].bound.worst_bound, plan.passes[0].bound.worst_bound);
  EXPECT_EQ(back.gaps[0].joints[1], plan.gaps[0].joints[1]);
  EXPECT_EQ(back.X_WP.matrix(), plan.X_WP.matrix());
}

TEST(Serialise, DamagedBytesAreRefused) {
  RandomStream random(4, 0);
  const std::string bytes = Serialise(RandomPass(random, 0));
  for (size_t cut = 0; cut < bytes.size(); cut += 37)
    EXPECT_THROW(ParsePassResult(std::string_view(bytes).substr(0, cut), "x"), InputError) << cut;
  EXPECT_THROW(ParsePlanResult(bytes, "x"), InputError);
  std::string older = bytes;
  older[older.find("millpose 4") + 9] = '0';
  EXPECT_THROW(ParsePassResult(older, "x"), InputError);
}

}  // namespace
}  // namespace millpose
