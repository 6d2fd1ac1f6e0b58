// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/tool_axis.hpp"

#include "base/error.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/gouge.hpp"

namespace millpose {
namespace {

// A round cavity of radius 20, 40 deep, whose wall leans outwards by 2 mm in 20.
Mesh Cavity() { return SoundMesh(LatheShape({{60, 0}, {20, 0}, {16, -40}, {0, -40}}, 90)); }

ToolpathOptions RingsAlong(const ToolAxisOptions& axis) {
  ToolpathOptions options = WallRings();
  options.region = {};
  options.region.box = RegionBox{{-45, -45, -34}, {45, 45, -1}};
  options.stepover = 6;
  options.spacing = 5;
  options.cutter = {5, 5, 60};
  options.tool_axis = axis;
  return options;
}

size_t Gouged(const Mesh& mesh, Toolpath toolpath, const CutterShape& cutter) {
  return CheckGouges(mesh, cutter, {}, {.threads = 1}, toolpath).points;
}

TEST(ToolAxis, IsTheOneOfItsRuleWhereverTheSurfaceLeans) {
  const Eigen::Vector3d above(0, 0, 200), along = Eigen::Vector3d(0, 0.6, 0.8);
  const std::vector<ToolAxisOptions> rules{{AxisRule::kFixed, {}, along},
                                           {AxisRule::kToward, above, Eigen::Vector3d::Zero()},
                                           {AxisRule::kToward, above, Eigen::Vector3d::UnitY()},
                                           {AxisRule::kAway, -above, Eigen::Vector3d::Zero()}};
  for (const ToolAxisOptions& rule : rules) {
    ToolpathOptions options = RingsAlong(rule);
    const Toolpath toolpath = MakeToolpath(Cavity(), options, {});
    for (const Pass& pass : toolpath.passes)
      for (const MillingPoint& point : pass.points) {
        // A ball's middle lies its radius over the contact, whatever its axis.
        const Eigen::Vector3d contact = point.position + 5 * point.tool_axis - 5 * point.normal;
        EXPECT_LT(Cavity().Closest(contact).distance, 1e-6);
        if (rule.rule == AxisRule::kFixed) {
          ASSERT_LT((point.tool_axis - along).norm(), 1e-12);
          continue;
        }
        Eigen::Vector3d way = rule.point - contact;
        way -= way.dot(rule.direction) * rule.direction;
        ASSERT_LT((point.tool_axis - (rule.rule == AxisRule::kAway ? -1 : 1) * way.normalized()).norm(),
                  1e-9);
      }
  }
}

TEST(ToolAxis, OfACavityThatNormalsDoNotReachMakesItsWallReachable) {
  // Along the normals the holder's side of a long cutter runs into the wall opposite.
  const CutterShape cutter{5, 5, 60};
  const Toolpath normal = MakeToolpath(Cavity(), RingsAlong({}), {});
  const Toolpath upright =
      MakeToolpath(Cavity(), RingsAlong({AxisRule::kFixed, {}, Eigen::Vector3d::UnitZ()}), {});
  EXPECT_GT(Gouged(Cavity(), normal, cutter), PointsOf(normal) / 2);
  EXPECT_EQ(Gouged(Cavity(), upright, cutter), 0);
}

TEST(ToolAxis, WhatItWouldReachFromUnderTheSurfaceIsNotMilled) {
  ToolpathOptions options = RingsAlong({AxisRule::kFixed, {}, -Eigen::Vector3d::UnitZ()});
  Toolpath toolpath = MakeToolpath(Cavity(), options, {});
  ASSERT_FALSE(toolpath.notes.empty());
  EXPECT_NE(toolpath.notes.back().find("under the surface"), std::string::npos);
  CheckGouges(Cavity(), options.cutter, {}, {.threads = 1}, toolpath);
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points) EXPECT_GT(point.gouge, 0);
}

TEST(ToolAxis, LeadAndTiltLeanFromIt) {
  ToolpathOptions options = RingsAlong({AxisRule::kFixed, {}, Eigen::Vector3d::UnitZ()});
  options.lead = DegToRad(10);
  for (const Pass& pass : MakeToolpath(Cavity(), options, {}).passes)
    for (const MillingPoint& point : pass.points) {
      EXPECT_NEAR(point.tool_axis.z(), std::cos(DegToRad(10)), 1e-9);
      EXPECT_GT(point.tool_axis.dot(point.feed), 0);
    }
}

// A bore whose wall leans by `lean` times its height.
Mesh Bore(double lean) {
  return SoundMesh(LatheShape({{70, 0}, {30 + 40 * lean, 0}, {30, -40}, {0, -40}}, 90));
}

TEST(ToolAxis, AlongAWallItFollowsItsLean) {
  for (const double lean : {0.05, 0.3, 0.8}) {
    ToolpathOptions options = RingsAlong({AxisRule::kWall, {}, Eigen::Vector3d::UnitZ()});
    options.cutter = {5, 0, 60};
    options.region.box = RegionBox{{-69, -69, -34}, {69, 69, -4}};
    const Mesh bore = Bore(lean);
    const Toolpath toolpath = MakeToolpath(bore, options, {});
    ASSERT_GT(PointsOf(toolpath), 100);
    for (const Pass& pass : toolpath.passes)
      for (const MillingPoint& point : pass.points) {
        ASSERT_NEAR(point.tool_axis.dot(point.normal), 0, 1e-9);
        // The steepest direction of the surface: nothing along it is nearer to the rule's.
        ASSERT_NEAR(point.tool_axis.z(), std::sqrt(1 - point.normal.z() * point.normal.z()), 1e-9);
        ASSERT_NEAR(point.tool_axis.z(), std::cos(std::atan(lean)), 2e-3);
        // Its side touches the wall.
        ASSERT_LT(bore.Closest(point.position - 5 * point.normal).distance, 1e-6);
      }
    EXPECT_EQ(Gouged(bore, toolpath, options.cutter), 0);
    options.tool_axis = {};
    const Toolpath normal = MakeToolpath(bore, options, {});
    if (lean < 0.5) {
      EXPECT_GT(Gouged(bore, normal, options.cutter), PointsOf(normal) * 9 / 10);
    }
  }
}

TEST(ToolAxis, AFloorIsNoWall) {
  const ToolAxisOptions axis{AxisRule::kWall, {}, Eigen::Vector3d::UnitZ()};
  EXPECT_THROW(ToolAxisAt(axis, {1, 2, 3}, Eigen::Vector3d::UnitZ()), InputError);
  EXPECT_THROW(ToolAxisAt(axis, {1, 2, 3}, -Eigen::Vector3d::UnitZ()), InputError);
  EXPECT_NO_THROW(ToolAxisAt(axis, {1, 2, 3}, Eigen::Vector3d(0.1, 0, 1).normalized()));
}

TEST(ToolAxis, APathThroughItsPointHasNone) {
  const ToolAxisOptions axis{AxisRule::kToward, {0, 0, 0}, Eigen::Vector3d::UnitZ()};
  EXPECT_THROW(ToolAxisAt(axis, {0, 0, 5}, Eigen::Vector3d::UnitZ()), InputError);
  EXPECT_NO_THROW(ToolAxisAt(axis, {1, 0, 5}, Eigen::Vector3d::UnitZ()));
}

}  // namespace
}  // namespace millpose
