// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/objective.hpp"

#include "base/error.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/stiffness/compliance.hpp"

namespace millpose {
namespace {

void Put(const Eigen::Matrix3d& c, int lane, ComplianceBlock& block) {
  block.xx.v[lane] = c(0, 0), block.yy.v[lane] = c(1, 1), block.zz.v[lane] = c(2, 2);
  block.xy.v[lane] = c(0, 1), block.xz.v[lane] = c(0, 2), block.yz.v[lane] = c(1, 2);
}

Eigen::Vector3d RandomUnit(RandomStream& stream) {
  return Eigen::Vector3d(stream.Normal(), stream.Normal(), stream.Normal()).normalized();
}

TEST(Objectives, OneIsTakenWithAForceAndOneIsThePapers) {
  const auto& all = Objectives().entries();
  EXPECT_EQ(std::ranges::count(all, true, &ObjectiveEntry::with_force), 1);
  EXPECT_EQ(std::ranges::count(all, true, &ObjectiveEntry::of_paper), 1);
  EXPECT_EQ(TheObjective(&ObjectiveEntry::with_force).name, "surface_error");
  EXPECT_EQ(TheObjective(&ObjectiveEntry::of_paper).name, "chen2021");
  EXPECT_TRUE(Objectives().At("surface_error").worst_first);
  EXPECT_FALSE(Objectives().At("chen2021").worst_first);
}

TEST(Chen2021, EqualsTheIndicesInThePlane) {
  RandomStream stream(7, 0);
  const double w1 = 0.3, w2 = 0.9;
  const auto objective = MakeObjective("chen2021", {{"w1", w1}, {"w2", w2}});
  for (int round = 0; round < 500; ++round) {
    const Eigen::Vector3d n = RandomUnit(stream);
    ComplianceBlock block;
    std::array<double, kLanes> expected;
    for (int l = 0; l < kLanes; ++l) {
      Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
      for (int i = 0; i < 6; ++i) {
        const Eigen::Vector3d column = stream.Uniform(0, 0.01) * RandomUnit(stream);
        c += column * column.transpose();
      }
      Put(c, l, block);
      const auto indices = IndicesInPlane(c, n);
      ASSERT_TRUE(indices.has_value());
      expected[l] = w1 * indices->lambda_t2 + w2 * indices->lambda_n;
    }
    Lanes out;
    objective->Evaluate(block, {n, n.unitOrthogonal(), n}, out);
    for (int l = 0; l < kLanes; ++l) EXPECT_NEAR(out.v[l] / expected[l], 1, 1e-9);
  }
}

TEST(Chen2021, SingularComplianceIsInfiniteNeverNan) {
  const auto objective = MakeObjective("chen2021", {});
  ComplianceBlock block = {};
  Put(Eigen::Vector3d(1e-4, 2e-4, 0).asDiagonal(), 1, block);
  Put(Eigen::Vector3d(1e-4, 0, 0).asDiagonal(), 2, block);
  Put(Eigen::Vector3d(1e-4, 2e-4, 3e-4).asDiagonal(), 3, block);
  Lanes out;
  objective->Evaluate(block, {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()},
                      out);
  for (const int l : {0, 1, 2, 4, 7}) EXPECT_EQ(out.v[l], std::numeric_limits<double>::infinity()) << l;
  EXPECT_NEAR(out.v[3], 0.5 * 1e-4 + 0.5 * 3e-4, 1e-18);
}

TEST(MakeObjective, NamesEveryProblemOfItsParameters) {
  try {
    MakeObjective("chen2021", {{"w1", -1}, {"w3", 0.5}});
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 2u);
    EXPECT_EQ(error.problems()[0].message, "objective chen2021: w1 is -1; allowed: at least 0");
    EXPECT_EQ(
        error.problems()[1].message,
        "objective chen2021: no parameter \"w3\"; known: w1, w2, reference_t2, reference_n; did you mean "
        "\"w1\"?");
  }
  EXPECT_THROW(MakeObjective("chen2021", {{"w1", 0}, {"w2", 0}}), InputError);
  EXPECT_THROW(MakeObjective("chen2012", {}), InputError);
}

TEST(Objectives, AreWhatTheirPagesSay) {
  RandomStream stream(8, 0);
  for (int round = 0; round < 300; ++round) {
    ObjectiveContext context;
    context.normal = RandomUnit(stream);
    context.feed = context.normal.cross(RandomUnit(stream)).normalized();
    context.tool_axis = (context.normal + 0.2 * RandomUnit(stream)).normalized();
    ComplianceBlock block;
    std::array<Eigen::Matrix3d, kLanes> all;
    for (int l = 0; l < kLanes; ++l) {
      all[l].setZero();
      for (int i = 0; i < 6; ++i) {
        const Eigen::Vector3d column = stream.Uniform(0, 0.01) * RandomUnit(stream);
        all[l] += column * column.transpose();
      }
      Put(all[l], l, block);
    }
    const auto evaluate = [&](const std::string& name, const ObjectiveParameters& parameters) {
      Lanes out;
      MakeObjective(name, parameters)->Evaluate(block, context, out);
      return out;
    };
    const Lanes isotropy = evaluate("isotropy", {}), drilling = evaluate("drilling", {});
    const Lanes normal = evaluate("normal_deflection", {}), worst = evaluate("worst_in_plane", {});
    const Lanes process = evaluate("process_force", {{"feed_N", -30}, {"across_N", 50}, {"axial_N", 7}});
    const Lanes shares = evaluate("chen2021", {{"reference_t2", 2e-4}, {"reference_n", 3e-4}});
    const Eigen::Vector3d a = context.tool_axis;
    const Eigen::Vector3d feed = (context.feed - a.dot(context.feed) * a).normalized();
    const Eigen::Vector3d force = -30 * feed + 50 * a.cross(feed) + 7 * a;
    for (int l = 0; l < kLanes; ++l) {
      const Eigen::Matrix3d& c = all[l];
      const auto indices = IndicesInPlane(c, context.normal);
      ASSERT_TRUE(indices.has_value());
      EXPECT_NEAR(isotropy.v[l] * indices->mu, 1, 1e-9);
      EXPECT_NEAR(drilling.v[l] / a.dot(c * a), 1, 1e-12);
      EXPECT_NEAR(normal.v[l] / context.normal.dot(c * context.normal), 1, 1e-12);
      EXPECT_NEAR(worst.v[l] / DeflectionsInPlane(c, context.normal).largest, 1, 1e-12);
      EXPECT_NEAR(process.v[l] / (c * force).norm(), 1, 1e-12);
      EXPECT_NEAR(shares.v[l] / (0.5 * indices->lambda_t2 / 2e-4 + 0.5 * indices->lambda_n / 3e-4), 1, 1e-9);
    }
  }
}

// Which part of the displacement surface_error counts: the side of a wall by hand, and the longest
// displacement against forces drawn within the cone, and against what it comes to where the cone is a line or
// holds all.
TEST(SurfaceError, CountsTheWallOrTheLongestDisplacement) {
  RandomStream stream(19, 0);
  for (int round = 0; round < 60; ++round) {
    ObjectiveContext context;
    context.normal = RandomUnit(stream);
    context.feed = context.normal.cross(RandomUnit(stream)).normalized();
    context.tool_axis = context.normal;
    context.force = 100 * RandomUnit(stream);
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d column = stream.Uniform(0, 0.01) * RandomUnit(stream);
      c += column * column.transpose();
    }
    if (round % 5 == 0) c = Eigen::Vector3d(2e-4, 2e-4, round % 2 ? 1e-4 : 3e-4).asDiagonal();
    ComplianceBlock block;
    for (int l = 0; l < kLanes; ++l) Put(c, l, block);
    const auto value = [&](double direction, double off, double uncertainty = 0) {
      Lanes out;
      MakeObjective("surface_error", {{"direction", direction},
                                      {"force_direction_deg", off},
                                      {"force_uncertainty_percent", uncertainty}})
          ->Evaluate(block, context, out);
      return out.v[3];
    };
    const Eigen::Vector3d wall = context.tool_axis.cross(context.feed), displacement = c * context.force;
    EXPECT_NEAR(value(1, 0), std::abs(wall.dot(displacement)), 1e-12 * displacement.norm());
    EXPECT_NEAR(value(0, 0), std::abs(context.normal.dot(displacement)), 1e-12 * displacement.norm());
    EXPECT_NEAR(value(2, 0) / displacement.norm(), 1, 1e-12);
    const double largest = c.operatorNorm();
    EXPECT_NEAR(value(2, 90, 30) / (130 * largest), 1, 1e-7);
    const double any = value(2, 20);
    double drawn = 0;
    const Eigen::Vector3d axis = context.force.normalized(), across = axis.unitOrthogonal();
    for (int i = 0; i < 4000; ++i) {
      // Every other on the rim.
      const double off = DegToRad(20) * (i % 2 ? 1 : std::sqrt(stream.Uniform(0, 1)));
      const double turn = stream.Uniform(0, 2 * EIGEN_PI);
      const Eigen::Vector3d side = std::cos(turn) * across + std::sin(turn) * axis.cross(across);
      drawn = std::max(drawn, 100 * (c * (std::cos(off) * axis + std::sin(off) * side)).norm());
    }
    EXPECT_GE(any, drawn * (1 - 1e-9));
    EXPECT_LE(any, drawn * (1 + 1e-4));
  }
}

TEST(Objectives, RefuseWhatMakesNoSense) {
  EXPECT_THROW(MakeObjective("surface_error", {{"force_direction_deg", 91}}), InputError);
  for (const double index : {-1.0, 0.5, 3.0})
    EXPECT_THROW(MakeObjective("surface_error", {{"direction", index}}), InputError) << index;
  EXPECT_THROW(MakeObjective("chen2021", {{"reference_n", 1e-4}}), InputError);
  EXPECT_THROW(MakeObjective("drilling", {{"w1", 1}}), InputError);
}

// One that forgot to say so would be milled backwards where it was planned forwards.
TEST(Objectives, SayWhenTheyDependOnTheFeedsDirection) {
  RandomStream stream(9, 0);
  for (const std::string& name : Objectives().Names()) {
    const auto objective =
        MakeObjective(name, name == "process_force" ? ObjectiveParameters{{"across_N", 50}, {"axial_N", 7}}
                                                    : ObjectiveParameters{});
    bool depends = false;
    for (int round = 0; round < 20; ++round) {
      ObjectiveContext context;
      context.normal = RandomUnit(stream);
      context.feed = context.normal.cross(RandomUnit(stream)).normalized();
      context.tool_axis = (context.normal + 0.2 * RandomUnit(stream)).normalized();
      ComplianceBlock block;
      for (int l = 0; l < kLanes; ++l)
        Put(Eigen::Matrix3d(Eigen::Vector3d(1e-4, 2e-4, 3e-4).asDiagonal()) +
                1e-4 * RandomUnit(stream) * Eigen::RowVector3d(0.1, 0.2, 0.3),
            l, block);
      // A point's own force turns with the feed.
      const auto force = [&] { return Eigen::Vector3d(30 * context.feed + 20 * context.normal); };
      Lanes there, back;
      context.force = force();
      objective->Evaluate(block, context, there);
      context.feed = -context.feed;
      context.force = force();
      objective->Evaluate(block, context, back);
      for (int l = 0; l < kLanes; ++l)
        depends = depends || std::abs(there.v[l] - back.v[l]) > 1e-9 * there.v[l];
    }
    EXPECT_EQ(objective->DependsOnFeed(), depends) << name;
  }
}

// One that forgot to say so would be planned with no force at all.
TEST(Objectives, SayWhenTheyNeedAForce) {
  const auto value = [](const Objective& objective, double force) {
    ComplianceBlock block;
    for (int l = 0; l < kLanes; ++l) Put(Eigen::Vector3d(1e-4, 2e-4, 3e-4).asDiagonal(), l, block);
    Lanes out;
    objective.Evaluate(block,
                       {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(),
                        force * Eigen::Vector3d(1, 2, 3)},
                       out);
    return out.v[0];
  };
  for (const std::string& name : Objectives().Names()) {
    const auto objective = MakeObjective(name, {});
    EXPECT_EQ(objective->NeedsForce(), value(*objective, 1) != value(*objective, 2)) << name;
  }
  EXPECT_FALSE(MakeObjective("process_force", {{"feed_N", 5}})->NeedsForce());
}

/// c·F and nᵀcF′ over forces near the point's own.
TEST(SurfaceError, IsTheLargestOverAllForcesThatTheUncertaintyAllows) {
  RandomStream stream(9, 0);
  for (int round = 0; round < 40; ++round) {
    ObjectiveContext context;
    context.normal = RandomUnit(stream);
    context.feed = context.normal.unitOrthogonal();
    context.tool_axis = context.normal;
    context.force = 40 * RandomUnit(stream);
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d column = stream.Uniform(0, 0.01) * RandomUnit(stream);
      c += column * column.transpose();
    }
    ComplianceBlock block;
    for (int l = 0; l < kLanes; ++l) Put(c, l, block);
    const double direction = 5.0 + round, uncertainty = 10.0 + round;
    Lanes out, whole;
    MakeObjective("surface_error",
                  {{"force_direction_deg", direction}, {"force_uncertainty_percent", uncertainty}})
        ->Evaluate(block, context, out);
    MakeObjective("process_force", {})->Evaluate(block, context, whole);
    EXPECT_NEAR(whole.v[3], (c * context.force).norm(), 1e-15);
    // Forces on the rim of the cone, and F itself.
    const Eigen::Vector3d F = context.force, u = F.unitOrthogonal(), v = F.normalized().cross(u);
    const double delta = DegToRad(direction), longer = 1 + 0.01 * uncertainty;
    double largest = 0;
    for (int i = 0; i <= 2000; ++i) {
      for (const double off : {0.0, 0.25 * delta, 0.5 * delta, 0.75 * delta, delta}) {
        const double around = 2 * kPi * i / 2000;
        const Eigen::Vector3d other =
            longer * F.norm() *
            (std::cos(off) * F.normalized() + std::sin(off) * (std::cos(around) * u + std::sin(around) * v));
        largest = std::max(largest, std::abs(context.normal.dot(c * other)));
      }
    }
    EXPECT_LE(largest, out.v[0] * (1 + 1e-12));
    EXPECT_GT(largest, out.v[0] * 0.99);
  }
}

TEST(Objectives, OfASingularComplianceAreNeverNan) {
  const ComplianceBlock block = {};
  for (const std::string& name : Objectives().Names()) {
    Lanes out;
    const ObjectiveParameters parameters = name == "process_force" ? ObjectiveParameters{{"feed_N", 1}}
                                           : name == "chen2021"    ? ObjectiveParameters{{"w1", 0}}
                                                                   : ObjectiveParameters{};
    MakeObjective(name, parameters)
        ->Evaluate(block, {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()},
                   out);
    for (const double value : out.v) EXPECT_FALSE(std::isnan(value)) << name;
  }
}

}  // namespace
}  // namespace millpose
