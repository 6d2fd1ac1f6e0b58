// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/pass_value.hpp"

#include <gtest/gtest.h>

namespace millpose {
namespace {

/// A straight pass of 60 mm whose objective is 1 + s/60, its points `spacing` mm apart.
PassResult Straight(double spacing) {
  PassResult pass;
  for (int i = 0; i * spacing <= 60; ++i) {
    PlannedPoint& point = pass.points.emplace_back();
    point.point.position.x() = i * spacing;
    point.objective = 1 + i * spacing / 60;
  }
  pass.pieces.push_back({0, 0, 0, static_cast<int>(pass.points.size()) - 1});
  return pass;
}

TEST(PassValue, DoesNotDependOnHowDenselyThePointsLie) {
  PassResult coarse = Straight(10), fine = Straight(10);
  fine.points.insert(fine.points.begin() + 1, coarse.points[0]);
  fine.points[1].point.position.x() = 5;
  fine.points[1].objective = 1 + 5.0 / 60;
  EXPECT_DOUBLE_EQ(ValueOf(coarse).mean, 1.5);
  EXPECT_DOUBLE_EQ(ValueOf(fine).mean, 1.5);
  EXPECT_EQ(ValueOf(fine).worst, 2);
}

TEST(PassValue, LessSkippedBeatsFewerPiecesBeatTheObjective) {
  const PassValue plain{0, 1, 2, 1};
  EXPECT_TRUE(IsBetter({0, 3, 9, 9}, {5, 1, 2, 1}, true, 0.01));
  EXPECT_TRUE(IsBetter({0, 1, 9, 9}, {0, 2, 2, 1}, true, 0.01));
  EXPECT_TRUE(IsBetter({0, 1, 1.9, 1.5}, plain, true, 0.01));    // the worst first
  EXPECT_FALSE(IsBetter({0, 1, 1.9, 1.5}, plain, false, 0.01));  // the mean alone
  EXPECT_TRUE(IsBetter({0, 1, 2.01, 0.9}, plain, true, 0.01));
  EXPECT_FALSE(IsBetter({0, 1, 2.1, 0.9}, plain, true, 0.01));
  EXPECT_TRUE(IsBetter({0, 1, 2.1, 0.9}, plain, false, 0.01));
  EXPECT_FALSE(IsBetter(plain, plain, true, 0));
}

TEST(PassValue, PointsAreFoundBetweenOthersAndFromWhereARingBegins) {
  Pass pass;
  for (int i = 0; i < 5; ++i) pass.points.emplace_back().position.x() = i;
  PassResult plan;
  for (const double x : {2.0, 2.5, 3.0, 4.0, 0.0, 1.0, 2.0})
    plan.points.emplace_back().point.position.x() = x;
  plan.opened_at = 2;
  EXPECT_EQ(PlacesOf(plan, pass), (std::vector<size_t>{0, 2, 3, 4, 5}));
  plan.points.pop_back();
  plan.points.pop_back();
  EXPECT_EQ(PlacesOf(plan, pass).size(), 4u);
}

}  // namespace
}  // namespace millpose
