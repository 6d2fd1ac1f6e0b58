// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/toolpath/toolpath_laws.hpp"

#include <gtest/gtest.h>

#include "tests/base/refusal.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/with.hpp"

namespace millpose {

std::string PathRefusal(const Mesh& mesh, const ToolpathOptions& options) {
  return RefusalOf([&] { MakeToolpath(mesh, options, {}); });
}

size_t PointsOf(const Toolpath& toolpath) {
  size_t points = 0;
  for (const Pass& pass : toolpath.passes) points += pass.points.size();
  return points;
}

void ExpectSound(const Mesh& mesh, const Toolpath& toolpath, const ToolpathOptions& options) {
  for (const Pass& pass : toolpath.passes) {
    ASSERT_GE(pass.points.size(), 2);
    for (size_t i = 0; i < pass.points.size(); ++i) {
      const MillingPoint& point = pass.points[i];
      ASSERT_LT(mesh.Closest(point.position).distance, 1e-6);
      ASSERT_NEAR(point.normal.norm(), 1, 1e-9);
      ASSERT_NEAR(point.feed.norm(), 1, 1e-9);
      ASSERT_NEAR(point.tool_axis.norm(), 1, 1e-9);
      ASSERT_NEAR(point.feed.dot(point.normal), 0, 1e-9);
      if (i == 0) continue;
      const Eigen::Vector3d step = point.position - pass.points[i - 1].position;
      ASSERT_LE(step.norm(), options.spacing + 1e-9);
      ASSERT_GT(step.dot(point.feed), 0);
      ASSERT_NEAR(point.arc_length - pass.points[i - 1].arc_length, step.norm(), options.chord_tolerance * 4);
    }
  }
}

ToolpathOptions PadOptions() {
  ToolpathOptions options;
  With<ParallelPlanes>(options).normal = Eigen::Vector3d::UnitY();
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(1);
  options.stepover = 8;
  options.spacing = 4;
  return options;
}

ToolpathOptions WallRings() {
  ToolpathOptions options;
  With<Rings>(options);
  options.region.connected = {{60, 0, 20}, DegToRad(20)};
  options.rotation_reference = Eigen::Vector3d::UnitX();
  options.stepover = 10;
  return options;
}

Mesh Plate() { return SoundMesh(PlateShape(10, 10, 10, {{{{40, 40}, {60, 60}}}})); }

double DistanceFromPath(const Toolpath& toolpath, const Eigen::Vector3d& p) {
  double least = 1e9;
  for (const Pass& pass : toolpath.passes)
    for (size_t i = pass.closed ? 0 : 1; i < pass.points.size(); ++i) {
      const Eigen::Vector3d& a = pass.points[i > 0 ? i - 1 : pass.points.size() - 1].position;
      const Eigen::Vector3d way = pass.points[i].position - a;
      const double t = std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (a + t * way - p).norm());
    }
  return least;
}

double ClimbShare(const Toolpath& toolpath, double aside) {
  std::vector<Eigen::Vector3d> milled;
  int climb = 0, decided = 0;
  for (const Pass& pass : toolpath.passes) {
    size_t behind = 0;  // points of this pass that are not too near to be another way
    for (const MillingPoint& point : pass.points) {
      for (; pass.points[behind].arc_length < point.arc_length - 3 * aside; ++behind)
        milled.push_back(pass.points[behind].position);
      const Eigen::Vector3d right = aside * point.feed.cross(point.normal);
      double at_right = 1e9, at_left = 1e9;
      for (const Eigen::Vector3d& p : milled) {
        at_right = std::min(at_right, (p - point.position - right).norm());
        at_left = std::min(at_left, (p - point.position + right).norm());
      }
      if (std::min(at_right, at_left) < aside && std::abs(at_right - at_left) > aside / 2) {
        ++decided;
        climb += at_right > at_left ? 1 : 0;
      }
    }
    for (; behind < pass.points.size(); ++behind) milled.push_back(pass.points[behind].position);
  }
  EXPECT_GT(decided, 50);
  return static_cast<double>(climb) / std::max(1, decided);
}

}  // namespace millpose
