// SPDX-License-Identifier: GPL-3.0-or-later
// What holds for every strategy alike: where the part lies and in what unit it comes changes nothing.
#include "geometry/import/mesh_import.hpp"
#include "tests/base/tier.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/gouge.hpp"
#include "toolpath/pass_variants.hpp"

namespace millpose {
namespace {

struct Given {
  std::string name;
  Triangles part;
  ToolpathOptions options;
};

// Every strategy on a part that suits it; with the ways of milling it that are laid by code of their own.
std::vector<Given> Everything() {
  const Triangles cylinder = CylinderShape(60, 40, 72, 2);
  const Triangles plate = PlateShape(10, 10, 10, {{{{40, 40}, {60, 60}}}});
  ToolpathOptions planes;
  With<ParallelPlanes>(planes).normal = Eigen::Vector3d(0, 0.6, 0.8);
  planes.stepover = 7;
  planes.region.facing = Eigen::Vector3d::UnitX();
  planes.region.rim_distance = 3;
  ToolpathOptions scallops = planes;
  scallops.scallop = 0.05;
  scallops.cutter = {6, 0, 30};
  ToolpathOptions closed;
  With<ParallelPlanes>(closed).normal = Eigen::Vector3d::UnitZ();
  closed.stepover = 9;
  ToolpathOptions walls = WallRings(), wall_spiral = WallRings(), faces = WallRings();
  With<Rings>(wall_spiral).path = RingPath::kSpiral;
  wall_spiral.direction = Direction::kClimb;
  faces.region.connected.reset();
  faces.region.facing = Eigen::Vector3d::UnitZ();
  faces.region.facing_within = DegToRad(1);
  ToolpathOptions face_spiral = faces;
  With<Rings>(face_spiral).path = RingPath::kSpiral;
  ToolpathOptions zigzag;
  With<Pad>(zigzag);
  zigzag.cutter = {6, 0, 30};
  zigzag.stepover = 5;
  With<Pad>(zigzag).along = Eigen::Vector3d(1, 0.2, 0).normalized();
  ToolpathOptions pad_spiral = zigzag;
  With<Pad>(pad_spiral).spiral = true;
  ToolpathOptions contours = zigzag;
  Choose(contours, "contours");
  contours.region.rim_distance = 2;
  ToolpathOptions curve;
  With<CurveStrategy>(curve).points = {{10, 12, 5}, {80, 17, 5}, {90, 90, 5}};
  return {{"planes", cylinder, planes},
          {"scallops", cylinder, scallops},
          {"closed slices", cylinder, closed},
          {"rings on a wall", cylinder, walls},
          {"wall spiral", cylinder, wall_spiral},
          {"rings on a face", cylinder, faces},
          {"face spiral", cylinder, face_spiral},
          {"pad zigzag", plate, zigzag},
          {"pad spiral", plate, pad_spiral},
          {"contours", plate, contours},
          {"curve", plate, curve}};
}

void ExpectSame(const Toolpath& a, const Toolpath& b, double within) {
  ASSERT_EQ(a.passes.size(), b.passes.size());
  for (size_t i = 0; i < a.passes.size(); ++i) {
    EXPECT_EQ(a.passes[i].closed, b.passes[i].closed);
    ASSERT_EQ(a.passes[i].points.size(), b.passes[i].points.size()) << i;
    for (size_t k = 0; k < a.passes[i].points.size(); ++k) {
      const MillingPoint &p = a.passes[i].points[k], &q = b.passes[i].points[k];
      ASSERT_LE((p.position - q.position).norm(), within) << i << " " << k;
      ASSERT_LE((p.normal - q.normal).norm(), within) << i << " " << k;
      ASSERT_LE((p.feed - q.feed).norm(), 1e3 * within) << i << " " << k;
    }
  }
}

TEST(StrategyLaws, FarFromTheOriginIsTheSame) {
  const Eigen::Vector3d d(1e5, -2e5, 3e4);
  const Eigen::Isometry3d X(Eigen::Translation3d{d});
  for (const Given& given : Everything()) {
    SCOPED_TRACE(given.name);
    ToolpathOptions options = given.options;
    if (options.strategy->Name() == "rings") With<Rings>(options).axis_point += d;
    if (options.region.connected) options.region.connected->seed += d;
    if (options.strategy->Name() == "curve")
      for (Eigen::Vector3d& p : With<CurveStrategy>(options).points) p += d;
    ExpectSame(Transformed(MakeToolpath(SoundMesh(given.part), given.options, {}), X),
               MakeToolpath(SoundMesh(Moved(given.part, X)), options, {}), 1e-6);
  }
}

TEST(StrategyLaws, FromMetresIsTheSame) {
  for (const Given& given : Everything()) {
    SCOPED_TRACE(given.name);
    RawMesh millimetres, metres;
    millimetres.triangles = metres.triangles = given.part;
    for (Eigen::Vector3d& p : metres.triangles.vertices) p /= 1000;
    ImportOptions scale;
    scale.unit = 1000;
    ExpectSame(MakeToolpath(ImportMesh(millimetres, {}, "a").mesh, given.options, {}),
               MakeToolpath(ImportMesh(metres, scale, "b").mesh, given.options, {}), 1e-6);
  }
}

double LengthOf(const Toolpath& toolpath) {
  double length = 0;
  for (const Pass& pass : toolpath.passes)
    for (size_t k = pass.closed ? 0 : 1; k < pass.points.size(); ++k)
      length +=
          (pass.points[k].position - pass.points[k == 0 ? pass.points.size() - 1 : k - 1].position).norm();
  return length;
}

/// The whole path in three shares across a direction.
std::vector<Toolpath> InThree(const Mesh& mesh, ToolpathOptions options, const Toolpath& whole,
                              double overlap) {
  const Eigen::Vector3d direction = Eigen::Vector3d(0.5, 0.7, -0.3).normalized();
  double least = 1e9, most = -1e9;
  for (const Pass& pass : whole.passes)
    for (const MillingPoint& point : pass.points) {
      least = std::min(least, direction.dot(point.position));
      most = std::max(most, direction.dot(point.position));
    }
  const double first = least + 0.3 * (most - least), second = least + 0.65 * (most - least);
  PathSection share{direction, -std::numeric_limits<double>::infinity(), first, overlap};
  std::vector<Toolpath> shares;
  for (const double next : {second, std::numeric_limits<double>::infinity(), 0.0}) {
    options.share = share;
    shares.push_back(MakeToolpath(mesh, options, {}));
    ExpectSound(mesh, shares.back(), options);
    for (const Pass& pass : shares.back().passes)
      for (const MillingPoint& point : pass.points) {
        EXPECT_GE(direction.dot(point.position), share.Least() - 1e-6);
        EXPECT_LE(direction.dot(point.position), share.Most() + 1e-6);
      }
    // Nothing of the path between the planes is missing.
    for (const Pass& pass : whole.passes)
      for (const MillingPoint& point : pass.points) {
        const double at = direction.dot(point.position);
        if (at >= share.Least() + 0.1 && at <= share.Most() - 0.1) {
          EXPECT_LE(DistanceFromPath(shares.back(), point.position), options.chord_tolerance + 1e-6);
        }
      }
    share.from = share.to;
    share.to = next;
  }
  return shares;
}

TEST(StrategyLaws, SharesTogetherAreTheWholePath) {
  for (Given& given : Everything()) {
    SCOPED_TRACE(given.name);
    given.options.spacing = 8;
    const Mesh mesh = SoundMesh(given.part);
    const Toolpath whole = MakeToolpath(mesh, given.options, {});
    double length = 0, overlapping = 0;
    for (const Toolpath& share : InThree(mesh, given.options, whole, 0)) length += LengthOf(share);
    EXPECT_NEAR(length, LengthOf(whole), 1e-3 * LengthOf(whole));
    const std::vector<Toolpath> shares = InThree(mesh, given.options, whole, 6);
    for (const Toolpath& share : shares) overlapping += LengthOf(share);
    EXPECT_GT(overlapping, length + 6);
    for (const Pass& pass : whole.passes)
      for (const MillingPoint& point : pass.points)
        EXPECT_TRUE(std::ranges::any_of(shares, [&](const Toolpath& share) {
          return DistanceFromPath(share, point.position) <= given.options.chord_tolerance + 1e-6;
        }));
  }
}

// What is planned again with more points holds the points as laid, cut where they are.
TEST(StrategyLaws, SharesInPartsHoldTheirPoints) {
  for (Given& given : Everything()) {
    SCOPED_TRACE(given.name);
    given.options.share = PathSection{Eigen::Vector3d(0.5, 0.7, -0.3).normalized(), 5, 60, 0};
    const Mesh mesh = SoundMesh(given.part);
    const Toolpath laid = MakeToolpath(mesh, given.options, {});
    given.options.parts = 2;
    const Toolpath finer = MakeToolpath(mesh, given.options, {});
    ASSERT_EQ(laid.passes.size(), finer.passes.size());
    for (size_t i = 0; i < laid.passes.size(); ++i) {
      const Pass& pass = laid.passes[i];
      const std::vector<char> all(pass.points.size(), 1);
      EXPECT_GE(WithPointsBetween(pass, finer.passes[i], all).points.size(), 2 * pass.points.size() - 1);
    }
  }
}

// The gouge check included: the only stage that shares its work.
TEST(StrategyLaws, SameForAnyNumberOfThreads) {
  for (Given& given : Everything()) {
    if (given.name != "planes" && given.name != "wall spiral" && given.name != "pad zigzag") continue;
    SCOPED_TRACE(given.name);
    given.options.spacing = OfTier(40, 8);
    given.options.stepover *= OfTier(3, 1);
    given.options.chord_tolerance *= OfTier(20, 1);
    const Mesh mesh = SoundMesh(given.part);
    for (const GougeAction action : {GougeAction::kSkip, GougeAction::kLift}) {
      std::vector<Toolpath> toolpaths;
      std::vector<GougeReport> reports;
      for (const int threads : {1, 3}) {
        Toolpath toolpath = MakeToolpath(mesh, given.options, {});
        for (Pass& pass : toolpath.passes)  // into the part on purpose
          for (MillingPoint& point : pass.points) point.position -= 0.3 * point.normal;
        reports.push_back(CheckGouges(mesh, {6, 0, 30}, {action, 0.05}, {.threads = threads}, toolpath));
        toolpaths.push_back(std::move(toolpath));
      }
      EXPECT_GT(reports[0].points, 0);
      for (size_t i = 1; i < toolpaths.size(); ++i) {
        ExpectSame(toolpaths[0], toolpaths[i], 0);
        EXPECT_EQ(reports[0].points, reports[i].points);
        EXPECT_EQ(reports[0].deepest.depth, reports[i].deepest.depth);
        EXPECT_EQ(reports[0].deepest.place, reports[i].deepest.place);
        EXPECT_EQ(reports[0].largest_lift, reports[i].largest_lift);
        for (size_t k = 0; k < toolpaths[0].passes.size(); ++k)
          for (size_t p = 0; p < toolpaths[0].passes[k].points.size(); ++p)
            ASSERT_EQ(toolpaths[0].passes[k].points[p].gouge, toolpaths[i].passes[k].points[p].gouge);
      }
    }
  }
}

}  // namespace
}  // namespace millpose
