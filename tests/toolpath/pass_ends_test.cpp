// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/pass_ends.hpp"

#include "base/error.hpp"

namespace millpose {
namespace {

Toolpath Straight(bool closed = false) {
  Pass pass;
  pass.closed = closed;
  for (int i = 0; i < 5; ++i) {
    MillingPoint point;
    point.position = {10.0 * i, 0, 0};
    point.normal = point.tool_axis = Eigen::Vector3d::UnitZ();
    point.feed = Eigen::Vector3d::UnitX();
    point.feed_rate = 7;
    point.arc_length = 10.0 * i;
    pass.points.push_back(point);
  }
  Toolpath toolpath;
  toolpath.passes = {pass};
  return toolpath;
}

void ExpectCutBetweenLeads(const Pass& pass, size_t leads) {
  ASSERT_EQ(pass.points.size(), 5 + 2 * leads);
  for (size_t i = 0; i < pass.points.size(); ++i) {
    const PointKind expected = i < leads       ? PointKind::kLeadIn
                               : i < leads + 5 ? PointKind::kCut
                                               : PointKind::kLeadOut;
    EXPECT_EQ(pass.points[i].kind, expected);
    EXPECT_EQ(pass.points[i].feed_rate, 7);
    if (i > 0) {
      EXPECT_NEAR(pass.points[i].arc_length - pass.points[i - 1].arc_length,
                  (pass.points[i].position - pass.points[i - 1].position).norm(), 1e-12);
    }
  }
}

TEST(PassEnds, OverrunGoesStraightOn) {
  Toolpath toolpath = Straight();
  AddPassEnds({12, LeadShape::kNone, 0, 0}, 5, toolpath);
  const Pass& pass = toolpath.passes[0];
  ExpectCutBetweenLeads(pass, 3);
  EXPECT_LT((pass.points.front().position - Eigen::Vector3d(-12, 0, 0)).norm(), 1e-12);
  EXPECT_LT((pass.points.back().position - Eigen::Vector3d(52, 0, 0)).norm(), 1e-12);
}

TEST(PassEnds, LeadsHaveTheirShape) {
  Toolpath normal = Straight(), ramp = Straight(), arc = Straight();
  AddPassEnds({2, LeadShape::kNormal, 6, 0}, 100, normal);
  ExpectCutBetweenLeads(normal.passes[0], 2);
  EXPECT_LT((normal.passes[0].points.front().position - Eigen::Vector3d(-2, 0, 6)).norm(), 1e-12);
  AddPassEnds({0, LeadShape::kRamp, 6, DegToRad(30)}, 100, ramp);
  ExpectCutBetweenLeads(ramp.passes[0], 1);
  EXPECT_LT(
      (ramp.passes[0].points.back().position - Eigen::Vector3d(40 + 6 * std::cos(DegToRad(30)), 0, 3)).norm(),
      1e-12);
  AddPassEnds({0, LeadShape::kArc, 8, 0}, 100, arc);
  ExpectCutBetweenLeads(arc.passes[0], 12);
  for (int i = 0; i < 12; ++i)
    EXPECT_NEAR((arc.passes[0].points[i].position - Eigen::Vector3d(0, 0, 8)).norm(), 8, 1e-12);
  EXPECT_LT((arc.passes[0].points.front().position - Eigen::Vector3d(-8, 0, 8)).norm(), 1e-12);
}

TEST(PassEnds, ClosedPassesAreOpenedForALeadAlone) {
  Toolpath toolpath = Straight(true);
  AddPassEnds({12, LeadShape::kNone, 8, 0}, 5, toolpath);
  EXPECT_EQ(toolpath.passes[0].points.size(), 5);
  EXPECT_TRUE(toolpath.passes[0].closed);
  // Round to the start and 12 mm on over it: the points at 0, 10 and 20 mm again.
  AddPassEnds({12, LeadShape::kNormal, 8, 0}, 100, toolpath);
  const Pass& pass = toolpath.passes[0];
  EXPECT_FALSE(pass.closed);
  ASSERT_EQ(pass.points.size(), 1 + 5 + 3 + 1);
  EXPECT_EQ(pass.points[8].position, Eigen::Vector3d(20, 0, 0));
  EXPECT_EQ(pass.points[9].position, Eigen::Vector3d(20, 0, 8));
  EXPECT_EQ(pass.points[9].kind, PointKind::kLeadOut);
}

/// Height of a point above the line y = z = 0, and how far it lies from there sideways.
void ExpectRampAlong(const Pass& pass, double height, double angle, double first) {
  ASSERT_EQ(pass.points.front().kind, PointKind::kLeadIn);
  EXPECT_NEAR(pass.points.front().position.z(), height, 1e-9);
  size_t i = 1;
  for (; pass.points[i].kind == PointKind::kLeadIn; ++i) {
    const Eigen::Vector3d step = pass.points[i].position - pass.points[i - 1].position;
    EXPECT_NEAR(-step.z(), std::tan(angle) * std::abs(step.x()), 1e-9) << i;  // never straight down
    EXPECT_GT(std::abs(step.x()), 0);
    EXPECT_EQ(pass.points[i].position.y(), 0);
    EXPECT_GE(pass.points[i].position.x(), first);
    EXPECT_LE(pass.points[i].position.x(), 40);
    // It looks the way it runs, but for where it turns.
    if (pass.points[i].position.x() > first && pass.points[i].position.x() < 40) {
      EXPECT_GT(pass.points[i].feed.dot(step), 0) << i;
    }
  }
  // Down where the pass begins, and from there all of it once more.
  const Eigen::Vector3d last = pass.points[i - 1].position - pass.points[i].position;
  EXPECT_NEAR(last.z(), std::tan(angle) * std::abs(last.x()), 1e-9);
  EXPECT_EQ(pass.points[i].kind, PointKind::kCut);
  EXPECT_NEAR(pass.points[i].position.z(), 0, 1e-12);
}

TEST(PassEnds, AlongThePassItselfTheCutterGoesDownByARamp) {
  for (const double height : {0.5, 1.5, 4.0, 10.0}) {  // from a part of the pass to five times to and fro
    for (const double degrees : {3.0, 10.0}) {
      Toolpath toolpath = Straight();
      toolpath.passes[0].reversible = true;
      AddPassEnds({0, LeadShape::kAlong, height, DegToRad(degrees)}, 100, toolpath, 20);
      const Pass& pass = toolpath.passes[0];
      EXPECT_FALSE(pass.reversible);
      ExpectRampAlong(pass, height, DegToRad(degrees), 0);
      EXPECT_NEAR((pass.points.back().position - Eigen::Vector3d(40, 0, height)).norm(), 0, 1e-12);
    }
  }
}

TEST(PassEnds, AlongItAnOverrunBelongsToThePass) {
  Toolpath toolpath = Straight();
  AddPassEnds({12, LeadShape::kAlong, 6, DegToRad(3)}, 5, toolpath);
  const Pass& pass = toolpath.passes[0];
  double least = 0;
  for (const MillingPoint& point : pass.points) least = std::min(least, point.position.x());
  EXPECT_NEAR(least, -12, 1e-12);
  EXPECT_NEAR((pass.points.back().position - Eigen::Vector3d(52, 0, 6)).norm(), 0, 1e-12);
}

TEST(PassEnds, AClosedPassIsEnteredAlongItself) {
  Toolpath toolpath = Straight(true);
  toolpath.passes[0].opening = RingOpening::kAnywhere;
  AddPassEnds({5, LeadShape::kAlong, 2, DegToRad(3)}, 100, toolpath);
  EXPECT_FALSE(toolpath.passes[0].closed);
  EXPECT_EQ(toolpath.passes[0].opening, RingOpening::kNone);
  EXPECT_EQ(toolpath.passes[0].points.front().kind, PointKind::kLeadIn);
}

TEST(PassEnds, APassTooShortForItIsAnError) {
  Toolpath toolpath = Straight();
  EXPECT_NO_THROW(AddPassEnds({0, LeadShape::kAlong, 1, DegToRad(3)}, 100, toolpath, 40));
  toolpath = Straight();
  EXPECT_THROW(AddPassEnds({0, LeadShape::kAlong, 1, DegToRad(3)}, 100, toolpath, 40.1), InputError);
}

TEST(PassEnds, TheFinishingLayerHasItsOwnDepth) {
  const Toolpath layered = Layered(Straight(), {2.5, 1, 0.1, 0.4});
  ASSERT_EQ(layered.passes.size(), 4);
  const std::array<double, 4> heights{0.5 + 1.4, 0.5 + 0.7, 0.5, 0.1};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(layered.passes[i].points[0].position.z(), heights[i], 1e-12);
  EXPECT_EQ(Layered(Straight(), {2.5, 1, 0, 2.5}).passes.size(), 1);
}

TEST(PassEnds, LayersComeFromOutsideInEvenSteps) {
  const Toolpath layered = Layered(Straight(), {2.5, 1, 0.1, 0});
  ASSERT_EQ(layered.passes.size(), 3);
  const std::array<double, 3> heights{0.1 + 2.5 * 2 / 3, 0.1 + 2.5 / 3, 0.1};
  for (int i = 0; i < 3; ++i)
    for (const MillingPoint& point : layered.passes[i].points)
      EXPECT_NEAR(point.position.z(), heights[i], 1e-12);
  EXPECT_EQ(Layered(Straight(), {}).passes.size(), 1);
}

}  // namespace
}  // namespace millpose
