// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/expression.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <numbers>

#include "base/error.hpp"
#include "base/random.hpp"

namespace millpose {
namespace {

struct SpelledPoint {
  ComplianceBlock block;
  ObjectiveContext context;
};

// Compliances of three springs per lane in random directions.
SpelledPoint RandomPoint(RandomStream& stream) {
  const auto unit = [&] {
    return Eigen::Vector3d(stream.Uniform(-1, 1), stream.Uniform(-1, 1), stream.Uniform(0.1, 1)).normalized();
  };
  SpelledPoint point;
  point.context.normal = unit();
  point.context.feed = point.context.normal.cross(unit()).normalized();
  point.context.tool_axis = unit();
  point.context.force = 80 * unit();
  for (int l = 0; l < kLanes; ++l) {
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d column = stream.Uniform(0.001, 0.01) * unit();
      c += column * column.transpose();
    }
    point.block.xx.v[l] = c(0, 0), point.block.xy.v[l] = c(0, 1), point.block.xz.v[l] = c(0, 2);
    point.block.yy.v[l] = c(1, 1), point.block.yz.v[l] = c(1, 2), point.block.zz.v[l] = c(2, 2);
  }
  return point;
}

Lanes ValueOf(const std::string& objective, const SpelledPoint& point) {
  Lanes out;
  MakeObjective(objective, {})->Evaluate(point.block, point.context, out);
  return out;
}

TEST(Expression, GivesTheBitsOfTheObjectiveThatItSpells) {
  RandomStream stream(31, 0);
  const std::pair<const char*, const char*> pairs[] = {{"chen2021", "0.5*lambda_t2_mm_N + 0.5*lambda_n_mm_N"},
                                                       {"isotropy", "1 / mu"},
                                                       {"drilling", "axis_deflection_mm_N"},
                                                       {"normal_deflection", "normal_deflection_mm_N"},
                                                       {"worst_in_plane", "worst_in_plane_mm_N"},
                                                       {"process_force", "force_deflection_mm"}};
  for (int round = 0; round < 100; ++round) {
    const SpelledPoint point = RandomPoint(stream);
    for (const auto& [name, spelled] : pairs) {
      const Lanes one = ValueOf(name, point), other = ValueOf(spelled, point);
      for (int l = 0; l < kLanes; ++l)
        EXPECT_EQ(std::bit_cast<uint64_t>(one.v[l]), std::bit_cast<uint64_t>(other.v[l])) << name;
    }
  }
  for (const auto& [name, spelled] : pairs) {
    const auto one = MakeObjective(name, {}), other = MakeObjective(spelled, {});
    EXPECT_EQ(one->Unit(), other->Unit()) << name;
    EXPECT_EQ(one->DependsOnFeed(), other->DependsOnFeed()) << name;
    EXPECT_EQ(one->NeedsForce(), other->NeedsForce()) << name;
    EXPECT_EQ(one->ReadsToolAxis(), other->ReadsToolAxis()) << name;
    EXPECT_EQ(other->Name(), spelled);
  }
}

// Each added to mu - mu, so that an index is named.
TEST(Expression, ComputesAsSchoolDoes) {
  RandomStream stream(32, 0);
  const SpelledPoint point = RandomPoint(stream);
  const std::pair<const char*, double> cases[] = {{"1 + 2*3", 7},
                                                  {"(1 + 2)*3", 9},
                                                  {"20 - 5 - 3", 12},
                                                  {"24 / 4 / 2", 3},
                                                  {"2 - -3", 5},
                                                  {"- 2*-3", 6},
                                                  {"1.5e1 + .5", 15.5},
                                                  {"min(4, 3, 5) + max(1, 2)", 5},
                                                  {"sqrt(16) + abs(-2)", 6},
                                                  {"sin(0) + cos(0)", 1},
                                                  {"asin(1)", std::numbers::pi / 2},
                                                  {"acos(-1)", std::numbers::pi},
                                                  {"atan2(1, 0)", std::numbers::pi / 2}};
  for (const auto& [text, value] : cases)
    EXPECT_NEAR(ValueOf(std::string("mu - mu + (") + text + ")", point).v[3], value, 1e-12) << text;
}

TEST(Expression, WhatIsNotDefinedIsInfinite) {
  RandomStream stream(33, 0);
  SpelledPoint point = RandomPoint(stream);
  for (const char* text : {"0*mu - 1", "mu/0", "sqrt(-mu)", "acos(2 + mu)", "min(sqrt(-mu), 1)",
                           "max(1, sqrt(-mu))", "sin(1e6*(1 + mu))", "mu*1e308*1e308"})
    EXPECT_EQ(ValueOf(text, point).v[0], std::numeric_limits<double>::infinity()) << text;
  // A singular compliance is not made harmless by a minimum or by a division.
  point.block = {};
  for (const char* text : {"min(lambda_n_mm_N, 1)", "1/lambda_n_mm_N", "0*lambda_n_mm_N"})
    EXPECT_EQ(ValueOf(text, point).v[0], std::numeric_limits<double>::infinity()) << text;
}

TEST(Expression, KnowsItsUnit) {
  const std::pair<const char*, const char*> cases[] = {
      {"2*lambda_n_mm_N + max(lambda_t1_mm_N, lambda_t2_mm_N)", "mm/N"},
      {"lambda_n_mm_N/lambda_t1_mm_N + mu", "1"},
      {"lambda_n_mm_N + mu", "mixed"},
      {"sqrt(lambda_n_mm_N*lambda_t1_mm_N)", "mm/N"},
      {"lambda_n_mm_N*lambda_t1_mm_N", "mm^2/N^2"},
      {"1/lambda_n_mm_N", "N/mm"},
      {"force_deflection_mm/lambda_n_mm_N", "N"}};
  for (const auto& [text, unit] : cases) EXPECT_EQ(MakeObjective(text, {})->Unit(), unit) << text;
}

TEST(Expression, SaysWhereAndWhatIsWrong) {
  const std::pair<std::string, std::vector<std::string>> cases[] = {
      {"lambda_n + pow(mu, 2)",
       {"at character 1: no index or function \"lambda_n\"; known: lambda_t1_mm_N,",
        "at character 12: no index or function \"pow\""}},
      {"2*lambda_n_mm", {"did you mean \"lambda_n_mm_N\"?"}},
      {"mu + ", {"at character 6: given \"the end\"; allowed: a number, a name, ( or -"}},
      {"mu ^ 2", {"at character 4: given \"^\"; allowed: an operator (+ - * /) or the end"}},
      {"mu × 2", {"at character 4: given \"×\""}},
      {"(mu", {"at character 4: given \"the end\"; allowed: an operator (+ - * /) or )"}},
      {"1.2.3*mu", {"at character 1: given \"1.2.3\"; allowed: a number"}},
      {"0x10*mu", {"given \"0x10\""}},
      {"min(mu) + sqrt(mu, 1) + mu(2) + sin",
       {"at character 1: min is given 1 arguments; allowed: 2 to 16",
        "at character 11: sqrt is given 2 arguments; allowed: 1",
        "at character 25: mu is given 1 arguments; allowed: none, it is an index",
        "at character 33: sin is given 0 arguments; allowed: 1"}},
      {"1 + 2", {"at character 1: names no index"}},
      {"", {"given \"the end\""}},
      {std::string(99, '(') + "mu", {"nested too deep; allowed: 32 levels"}},
      {std::string(99, '-') + "mu", {"nested too deep; allowed: 32 levels"}}};
  for (const auto& [text, messages] : cases) {
    try {
      Expression{text};
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      for (const std::string& message : messages)
        EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << text << "\n" << error.what();
      EXPECT_EQ(error.problems().size(), messages.size()) << text << "\n" << error.what();
    }
  }
  std::string longest = "mu";
  for (int i = 0; i < 200; ++i) longest += "+mu";
  EXPECT_THROW(Expression{longest}, InputError);
  EXPECT_THROW(MakeObjective("mu + 1", {{"w1", 1}}), InputError);
}

}  // namespace
}  // namespace millpose
