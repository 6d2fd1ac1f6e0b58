// SPDX-License-Identifier: GPL-3.0-or-later
// What passes leave standing that lean as they may: by taking material off a plane, pose by pose.
#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/units.hpp"
#include "planning/pose/freedoms/lean.hpp"
#include "planning/pose/lean_problem.hpp"
#include "tests/base/tier.hpp"
#include "tests/planning/pass/pass_problem.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kStepover = 5, kScallop = 0.05, kFront = 2000, kHeight = 1150;  // mm
const Vector3d kNormal = -Vector3d::UnitX();

/// A flat end whose leans are free in what fits the scallop, nominally leading by 1°.
PoseProblem FlatEnd() {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.freedoms.push_back(
      std::make_shared<Lead>(LeanRange{DegToRad(0.5), DegToRad(6.5), DegToRad(1), DegToRad(1)}));
  problem.freedoms.push_back(
      std::make_shared<Tilt>(LeanRange{DegToRad(-0.5), DegToRad(0.5), DegToRad(0.25), 0}));
  problem.lean = LeanRules{.cutter = {8, 0, 40},
                           .lead = DegToRad(1),
                           .back_and_forth = true,
                           .stepover = kStepover,
                           .scallop = kScallop,
                           .surface = nullptr};
  return problem;
}

Vector3d ContactOf(int pass, double along) { return {kFront, along, kHeight + pass * kStepover}; }
Vector3d FeedOf(int pass) { return (pass % 2 ? -1 : 1) * Vector3d::UnitY(); }

/// A cutter on its way: tip and axis, from the first place to the last.
struct Way {
  std::vector<Vector3d> tips, axes;
};

/// How high the plane stands between the first pass and the last, at `along`; below 0 it is cut into.
std::pair<double, double> Left(const CutterShape& cutter, const std::vector<Way>& ways, double along) {
  double least = 1e9, most = -1e9;
  for (double across = 0; across <= kStepover * static_cast<double>(ways.size() - 1); across += 0.125) {
    const Vector3d place(kFront, along, kHeight + across);
    double height = 1e9;
    for (const Way& way : ways)
      for (size_t i = 1; i < way.tips.size(); ++i) {
        const Vector3d step = way.tips[i] - way.tips[i - 1];
        if ((way.tips[i] - place).norm() > cutter.radius + step.norm() + 1) continue;
        const int parts = std::max(1, static_cast<int>(std::ceil(step.norm() / 0.05)));
        for (int k = 0; k <= parts; ++k) {
          const double share = static_cast<double>(k) / parts;
          const Vector3d tip = way.tips[i - 1] + share * step;
          const Vector3d axis = (way.axes[i - 1] + share * (way.axes[i] - way.axes[i - 1])).normalized();
          const double up = (tip - place).dot(axis) / kNormal.dot(axis);  // to the cutter's face
          if ((place + up * kNormal - tip).squaredNorm() <= cutter.radius * cutter.radius)
            height = std::min(height, up);
        }
      }
    least = std::min(least, height);
    most = std::max(most, height);
  }
  return {least, most};
}

TEST(LeanRemoval, PassesThatLeanAsTheyMayLeaveNoMoreThanTheScallop) {
  const PoseProblem problem = FlatEnd();
  const LeanRules& rules = *problem.lean;
  RandomStream random(31, 0);
  double highest = 0;
  for (int trial = 0; trial < OfTier(20, 200); ++trial) {
    std::vector<Way> ways;
    for (int pass = 0; pass < 3; ++pass) {
      const LeanBound bound(rules, ContactOf(pass, 0), kNormal, FeedOf(pass));
      Vector3d axis;
      do {
        axis = AxisOf({DegToRad(random.Uniform(0.5, 6.5)), DegToRad(random.Uniform(-0.5, 0.5))}, kNormal,
                      FeedOf(pass));
      } while (!bound.Admits(axis));
      Way& way = ways.emplace_back();
      for (const double along : {-12.0, 12.0}) {
        way.tips.push_back(TipAtContact(rules.cutter, ContactOf(pass, along), kNormal, axis));
        way.axes.push_back(axis);
      }
    }
    const auto [least, most] = Left(rules.cutter, ways, 0);
    EXPECT_GT(least, -1e-9);
    EXPECT_LT(most, kScallop + 1e-3) << trial;
    highest = std::max(highest, most);
  }
  EXPECT_GT(highest, 0.8 * kScallop) << "the bound is made use of";
}

TEST(LeanRemoval, APlanLeavesNoMoreThanTheScallopAndKeepsItsContacts) {
  const PoseProblem problem = FlatEnd();
  const LeanRules& rules = *problem.lean;
  std::vector<Way> ways;
  std::vector<Leans> chosen;
  for (int p = 0; p < 4; ++p) {
    Pass pass;
    for (int t = 0; t < 17; ++t) {
      MillingPoint point;
      const Vector3d contact = ContactOf(p, (p % 2 ? -1 : 1) * (-40.0 + 5 * t));
      point.normal = kNormal;
      point.feed = FeedOf(p);
      point.tool_axis = AxisOf({rules.lead, rules.tilt}, kNormal, point.feed);
      point.position = TipAtContact(rules.cutter, contact, kNormal, point.tool_axis);
      point.feed_rate = 10;
      point.arc_length = 5 * t;
      pass.points.push_back(point);
    }
    const PassResult plan =
        PlanPass(problem, World(EmptyCell(problem)), {pass, p, 0}, Options(), {.threads = 2});
    Way& way = ways.emplace_back();
    for (const PlannedPoint& planned : plan.points) {
      ASSERT_EQ(planned.skip, Infeasibility::kNone) << planned.detail;
      const MillingPoint& point = planned.point;
      const Pose X_WT = problem.X_WB * ForwardFlange(problem.arm, planned.q) * problem.X_FT;
      way.tips.push_back(X_WT.translation());
      way.axes.emplace_back(X_WT.linear().col(2));
      const size_t t = way.tips.size() - 1;
      const Vector3d contact = ContactAtTip(rules.cutter, way.tips[t], kNormal, way.axes[t]);
      EXPECT_LT((contact - ContactOf(p, (p % 2 ? -1 : 1) * (-40.0 + 5 * static_cast<double>(t)))).norm(),
                1e-3);
      chosen.push_back(LeansOf(point.tool_axis, kNormal, point.feed));
    }
  }
  const auto [least_tilt, most_tilt] = std::ranges::minmax(chosen, {}, &Leans::tilt);
  const auto [least_lead, most_lead] = std::ranges::minmax(chosen, {}, &Leans::lead);
  EXPECT_GT(std::max(most_tilt.tilt - least_tilt.tilt, most_lead.lead - least_lead.lead), DegToRad(0.2));
  for (const double along : {-20.0, -3.0, 11.0, 20.0}) {
    const auto [least, most] = Left(rules.cutter, ways, along);
    EXPECT_GT(least, -1e-3);
    EXPECT_LT(most, 1.02 * kScallop);
  }
}

}  // namespace
}  // namespace millpose
