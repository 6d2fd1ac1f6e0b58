// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/price.hpp"

#include <gtest/gtest.h>

namespace millpose {
namespace {

/// Levels of one point: own optimum, best free, before smoothing, on the path.
PlannedPoint Point(double own, double free, double unsmoothed, double on_path) {
  PlannedPoint point;
  point.own_optimum = own;
  point.free_optimum = free;
  point.unsmoothed = unsmoothed;
  point.objective = on_path;
  return point;
}

PlanResult Plan(const std::string& unit) {
  PlanResult plan;
  plan.objective_unit = unit;
  PassResult first, second;
  first.points = {Point(1, 1, 2, 2.5), Point(2, 3, 4, 3.5)};
  first.bound = {7, 6.5, 4, 3.9};
  second.points = {Point(1, 2, 2, 2)};
  second.bound = {3, 3, 2, 2};
  plan.passes = {first, second};
  return plan;
}

TEST(Price, RatiosMultiplyToTheTotal) {
  const std::optional<Price> price = PriceOf(Plan("mm/N"));
  ASSERT_TRUE(price);
  EXPECT_FALSE(price->is_length);
  EXPECT_EQ(price->points, 3u);
  EXPECT_DOUBLE_EQ(price->ratio.interference, 6.0 / 4);
  EXPECT_DOUBLE_EQ(price->ratio.continuity, 8.0 / 6);
  EXPECT_DOUBLE_EQ(price->ratio.smoothing, 8.0 / 8);
  EXPECT_EQ(price->ratio.total, price->ratio.interference * price->ratio.continuity * price->ratio.smoothing);
  EXPECT_DOUBLE_EQ(price->ratio.total, 2);
}

TEST(Price, DifferencesOfALengthAddUpToTheTotal) {
  const std::optional<Price> price = PriceOf(Plan("mm"));
  ASSERT_TRUE(price && price->is_length);
  EXPECT_DOUBLE_EQ(price->mean.interference, 2.0 / 3);
  EXPECT_DOUBLE_EQ(price->mean.continuity, 2.0 / 3);
  EXPECT_DOUBLE_EQ(price->mean.smoothing, 0);
  EXPECT_DOUBLE_EQ(price->mean.total, 4.0 / 3);
  EXPECT_EQ(price->worst.interference, 1);  // 2 -> 3
  EXPECT_EQ(price->worst.continuity, 1);    // 3 -> 4
  EXPECT_EQ(price->worst.smoothing, -0.5);  // 4 -> 3.5
  EXPECT_EQ(price->worst.total, 1.5);
}

TEST(Price, LinkMovesAreThoseOfTheWholeJob) {
  PlanResult plan = Plan("mm");
  EXPECT_DOUBLE_EQ(*PriceOf(plan)->sum_gap, 10 / 9.5 - 1);
  EXPECT_DOUBLE_EQ(*PriceOf(plan)->worst_gap, 4 / 3.9 - 1);
  for (PassResult& pass : plan.passes) pass.bound.worst_bound = 0;  // the sum alone was sought
  EXPECT_FALSE(PriceOf(plan)->worst_gap);
}

TEST(Price, WhatIsNotCutDoesNotCount) {
  PlanResult plan = Plan("mm");
  PlannedPoint lead = Point(1, 50, 60, 70), skipped = Point(1, 50, 60, 70);
  lead.point.kind = PointKind::kLeadIn;
  skipped.skip = Infeasibility::kLimit;
  plan.passes[1].points.insert(plan.passes[1].points.end(), {lead, skipped});
  EXPECT_EQ(PriceOf(plan)->points, 3u);
  EXPECT_EQ(PriceOf(plan)->worst.total, 1.5);
  plan.passes.clear();
  EXPECT_FALSE(PriceOf(plan));
}

TEST(Price, ABetterPoseFoundLaterCountsForTheSearchesBefore) {
  PlanResult plan;
  plan.objective_unit = "mm";
  PassResult pass;
  pass.points = {Point(2, 1.9, 1.9, 1.95)};
  plan.passes = {pass};
  const std::optional<Price> price = PriceOf(plan);
  EXPECT_EQ(price->mean.interference, 0);
  EXPECT_NEAR(price->mean.total, 0.05, 1e-12);
}

}  // namespace
}  // namespace millpose
