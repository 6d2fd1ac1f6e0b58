// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/gzip.hpp"
#include "planning/result/write_plan.hpp"
#include "tests/planning/result/every_field.hpp"

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
    point.skip = Infeasibility::kStep;
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
  LinkMove gap;
  gap.joints = {Joints::Constant(0.1), Joints::Constant(1.0 / 3)};
  gap.detail = "blocked";
  plan.gaps = {gap};
  const std::string bytes = Serialise(plan);
  const PlanResult back = ParsePlanResult(bytes, "x");
  EXPECT_EQ(Serialise(back), bytes);
  EXPECT_EQ(back.seed, plan.seed);
  EXPECT_EQ(back.passes[1].points[3].q, plan.passes[1].points[3].q);
  EXPECT_EQ(back.passes[1].points[3].point.position, plan.passes[1].points[3].point.position);
  EXPECT_EQ(back.passes[0].points[0].skip, Infeasibility::kStep);
  EXPECT_EQ(back.passes[0].points[2].unsmoothed, plan.passes[0].points[2].unsmoothed);
  EXPECT_EQ(back.passes[0].points[2].free_optimum, plan.passes[0].points[2].free_optimum);
  EXPECT_EQ(back.passes[0].bound.worst_bound, plan.passes[0].bound.worst_bound);
  EXPECT_EQ(back.gaps[0].joints[1], plan.gaps[0].joints[1]);
  EXPECT_EQ(back.X_WP.matrix(), plan.X_WP.matrix());
}

PlanResult RandomPlan() {
  RandomStream random(5, 0);
  PlanResult plan;
  for (int i = 0; i < 40; ++i) plan.passes.push_back(RandomPass(random, i));
  plan.passes[3].points[2].compensation.emplace().normal.taken = 0.01;
  plan.gaps.resize(2);
  return plan;
}

TEST(Serialise, AnotherLibraryReadsItAndWritesTheSame) {
  const std::string bytes = Serialise(RandomPlan());
  const auto json = nlohmann::ordered_json::from_cbor(bytes);
  EXPECT_EQ(json.at("passes").size(), 40u);
  EXPECT_EQ(json.at("passes").at(3).at("points").at(2).at("compensation").at("normal").at("taken"), 0.01);
  std::string again;
  nlohmann::ordered_json::to_cbor(json, again);
  EXPECT_EQ(again, bytes);
}

TEST(Serialise, TheSameOnAnyNumberOfThreadsAndInParts) {
  const PlanResult plan = RandomPlan();
  size_t parts = 0;
  const std::string bytes = BytesOf([&](const ByteSink& sink) {
    WritePlan(plan, 4, [&](std::string_view part) {
      ++parts;
      sink(part);
    });
  });
  EXPECT_GE(parts, plan.passes.size());
  EXPECT_EQ(bytes, BytesOf([&](const ByteSink& sink) { WritePlan(plan, 1, sink); }));
  EXPECT_EQ(Gunzip(bytes), Serialise(plan));
  EXPECT_EQ(Serialise(ParsePlanFile(bytes, "x")), Serialise(plan));
  for (const std::string& damaged :
       {bytes.substr(0, bytes.size() - 1), bytes + "x", Serialise(plan), std::string()})
    EXPECT_THROW(ParsePlanFile(damaged, "plan"), InputError);
}

TEST(Serialise, FieldsThatAreNotThereOrTooManyAreRefused) {
  const std::string bytes = Serialise(RandomPlan());
  const auto json = nlohmann::ordered_json::from_cbor(bytes);
  const auto parse = [](const nlohmann::ordered_json& changed) {
    std::string text;
    nlohmann::ordered_json::to_cbor(changed, text);
    return ParsePlanResult(text, "x");
  };
  EXPECT_NO_THROW(parse(json));
  auto more = json, less = json;
  more["passes"][0]["later"] = 1;
  less["passes"][0].erase("grid_gap");
  EXPECT_THROW(parse(more), InputError);
  EXPECT_THROW(parse(less), InputError);
  EXPECT_THROW(ParsePlanResult(bytes + "x", "x"), InputError);
}

TEST(Serialise, DamagedBytesAreRefused) {
  const std::string bytes = Serialise(RandomPlan());
  for (size_t cut = 0; cut < bytes.size(); cut += 37)
    EXPECT_THROW(ParsePlanResult(std::string_view(bytes).substr(0, cut), "x"), InputError) << cut;
  std::string older = bytes;
  older[older.find("millpose 9") + 9] = '0';
  EXPECT_THROW(ParsePlanResult(older, "x"), InputError);
}

/// A plan with every field of everything in it set.
PlanResult FullPlan(uint64_t seed) {
  RandomStream random(seed, 0);
  PlanResult plan;
  every_field::Fill(plan, random);
  return plan;
}

// A field that is forgotten in serialise.cpp would be lost to whoever verifies a folder.
TEST(Serialise, NothingIsLost) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const PlanResult plan = FullPlan(seed);
    EXPECT_TRUE(every_field::Same(ParsePlanResult(Serialise(plan), "x"), plan));
    EXPECT_FALSE(every_field::Same(FullPlan(seed + 5), plan));
  }
}

TEST(Serialise, NumbersThatAreNoneReadBackAsThemselves) {
  PlanResult plan = FullPlan(1);
  plan.passes[0].points[0].paper[0].objective = std::numeric_limits<double>::infinity();
  plan.passes[0].points[1].objective = -0.0;
  plan.passes[0].points[1].clearance = std::numeric_limits<double>::denorm_min();
  EXPECT_TRUE(every_field::Same(ParsePlanResult(Serialise(plan), "x"), plan));
}

// Whatever happens to the bytes: a plan or an InputError that names the file, never anything else.
TEST(Serialise, ChangedBytesAreAPlanOrAnError) {
  const std::string bytes = Serialise(FullPlan(2));
  RandomStream random(6, 0);
  int refused = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string changed = bytes;
    for (int n = random.Below(3); n >= 0; --n)
      changed[static_cast<size_t>(random.Below(static_cast<int>(bytes.size())))] =
          static_cast<char>(random.Below(256));
    try {
      Serialise(ParsePlanResult(changed, "some.cbor"));
    } catch (const InputError& error) {
      ++refused;
      ASSERT_EQ(error.problems().at(0).place.file, "some.cbor");
      ASSERT_NE(std::string(error.what()).find("not a plan that this version wrote"), std::string::npos);
    }
  }
  EXPECT_GT(refused, 300);
}

TEST(Serialise, WhatIsNoPlanIsRefused) {
  for (const char* bytes : {"", "{}", "\xa0", "millpose 4"})
    EXPECT_THROW(ParsePlanResult(bytes, "x"), InputError) << bytes;
}

}  // namespace
}  // namespace millpose
