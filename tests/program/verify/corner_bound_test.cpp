// SPDX-License-Identifier: GPL-3.0-or-later
// Corners that the maker does not document: the bound holds for every path of the hull, and decides.
#include "program/verify/corner_bound.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/units.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

Pose At(double x, double y, double turn = 0) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector3d(x, y, 0);
  pose.linear() = FromRotationVector(Vector3d(0, 0, turn));
  return pose;
}

double DistanceFrom(const std::vector<Vector3d>& path, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k + 1 < path.size(); ++k) {
    const Vector3d way = path[k + 1] - path[k];
    const double share = std::clamp((p - path[k]).dot(way) / way.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - path[k] - share * way).norm());
  }
  return least;
}

/// A place of a path that turns about z: tip, turn (rad), mm along it.
struct OnPath {
  Vector3d tip;
  double turn, along;
};

OnPath Mixed(const OnPath& a, const OnPath& b, double share) {
  return {a.tip + share * (b.tip - a.tip), a.turn + share * (b.turn - a.turn),
          a.along + share * (b.along - a.along)};
}

/// The corners of the path within `reach` of the one at `corner`, and where it is that far away.
std::vector<OnPath> CutOff(const std::vector<OnPath>& path, size_t corner, double reach) {
  std::vector<OnPath> within;
  const double begin = std::max(path[corner].along - reach, path.front().along),
               end = std::min(path[corner].along + reach, path.back().along);
  for (size_t k = 0; k + 1 < path.size(); ++k)
    for (const double at : {begin, path[k].along, end})
      if (at >= begin && at <= end && at >= path[k].along && at <= path[k + 1].along)
        within.push_back(
            Mixed(path[k], path[k + 1], (at - path[k].along) / (path[k + 1].along - path[k].along)));
  return within;
}

double TurnAt(const std::vector<OnPath>& path, double along) {
  size_t k = 0;
  while (k + 2 < path.size() && path[k + 1].along < along) ++k;
  return Mixed(path[k], path[k + 1], (along - path[k].along) / (path[k + 1].along - path[k].along)).turn;
}

TEST(CornerBound, OfARightAngleIsTheDistanceFromItsChord) {
  const CornerRounding bound = WithinReach({At(-10, 0), At(0, 0), At(0, 10)}, 1, 2);
  EXPECT_NEAR(bound.position, std::sqrt(2.0), 1e-12);
  EXPECT_EQ(bound.angle, 0);
}

TEST(CornerBound, OfAStraightPathIsNothing) {
  EXPECT_NEAR(WithinReach({At(-10, 0), At(0, 0), At(7, 0), At(9, 0)}, 1, 8).position, 0, 1e-12);
}

TEST(CornerBound, CountsTheTurnOfTheTool) {
  // It turns on the way there alone: half of what lies within reach may be late. A way to and fro: all of it.
  EXPECT_NEAR(WithinReach({At(-10, 0, -0.1), At(0, 0, 0), At(10, 0, 0)}, 1, 2).angle, 0.01, 1e-9);
  EXPECT_NEAR(WithinReach({At(-10, 0, -0.1), At(0, 0, 0), At(10, 0, -0.1)}, 1, 2).angle, 0.02, 1e-9);
}

TEST(CornerBound, HoldsForEveryPlaceOfTheHull) {
  std::mt19937 random(7);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  double tightest = 0, tightest_turn = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Pose> tools;
    std::vector<OnPath> path;
    std::vector<Vector3d> tips;
    for (int k = 0; k < 7; ++k) {
      const double turn = uniform(-0.1, 0.1);
      tools.push_back(At(uniform(0, 4) + 2 * k, uniform(-1, 1), turn));
      tips.push_back(tools.back().translation());
      path.push_back({tips.back(), turn, 0});
      if (k > 0)
        path.back().along = path[path.size() - 2].along + (tips.back() - tips[tips.size() - 2]).norm();
    }
    const double reach = uniform(0.1, 6);
    const CornerRounding bound = WithinReach(tools, 3, reach);
    const std::vector<OnPath> hull = CutOff(path, 3, reach);
    ASSERT_GE(hull.size(), 3u);
    for (int sample = 0; sample < 30; ++sample) {
      OnPath place{Vector3d::Zero(), 0, 0};
      double sum = 0;
      for (const OnPath& vertex : hull) {
        const double weight = -std::log(uniform(1e-9, 1));
        place.tip += weight * vertex.tip;
        place.turn += weight * vertex.turn;
        place.along += weight * vertex.along;
        sum += weight;
      }
      const double off = DistanceFrom(tips, place.tip / sum),
                   turned = std::abs(place.turn / sum - TurnAt(path, place.along / sum));
      EXPECT_LE(off, bound.position + 1e-9) << "reach " << reach;
      EXPECT_LE(turned, bound.angle + 1e-9) << "reach " << reach;
      tightest = std::max(tightest, off / std::max(bound.position, 1e-9));
      tightest_turn = std::max(tightest_turn, turned / std::max(bound.angle, 1e-9));
    }
  }
  EXPECT_GT(tightest, 0.5);  // bounds, and no idle ones
  EXPECT_GT(tightest_turn, 0.5);
}

/// The sample's program as read back, its corners being nobody's.
struct Undocumented {
  PlanResult plan = SamplePlan();
  MotionProgram program = MakeMotionProgram(plan);
  World world{SampleCell(plan)};
  VerifyOptions options = SampleOptions(plan);

  MotionProgram Read() const {
    const PostSettings settings = SampleSettings("krl");
    const auto post = SamplePost("krl");
    MotionProgram read = post->Read(post->Write(program, plan.arm, settings), plan.arm, settings);
    read.corner_assumption = "it stays in the triangle";
    return read;
  }
  std::vector<Finding> Findings(const MotionProgram& read, const MotionProgram* wanted) const {
    return Verify(read, world, wanted, options, {.threads = 1});
  }
};

TEST(CornerBound, DecidesWithAPlanAndWithout) {
  Undocumented sample;
  const MotionProgram read = sample.Read();
  const std::optional<CornerBound> widest = FindCornerBound(read, sample.world.cell());
  ASSERT_TRUE(widest);
  EXPECT_GT(widest->position, 1e-4);
  EXPECT_EQ(widest->assumption, "it stays in the triangle");
  sample.options.angle_tolerance = 1.01 * widest->angle;  // KRL's own rounding is half of the bound
  for (const MotionProgram* plan :
       {static_cast<const MotionProgram*>(&sample.program), static_cast<const MotionProgram*>(nullptr)}) {
    sample.options.max_corner = widest->position * 1.0001;
    EXPECT_TRUE(sample.Findings(read, plan).empty());
    sample.options.max_corner = widest->position * 0.9999;
    const std::vector<Finding> findings = sample.Findings(read, plan);
    ASSERT_FALSE(findings.empty());
    EXPECT_NE(findings.front().message.find("max_corner_mm"), std::string::npos) << findings.front().message;
  }
}

TEST(CornerBound, ACellThatSaysNothingAllowsNone) {
  Undocumented sample;
  const MotionProgram read = sample.Read();
  sample.options.angle_tolerance = 1;
  sample.options.max_corner = 0;  // not even those of a straight path
  EXPECT_EQ(sample.Findings(read, nullptr).size(),
            static_cast<size_t>(std::ranges::count_if(
                read.motions, [](const Motion& motion) { return !motion.exact && motion.blend > 0; })));
  sample.options.max_corner = 1;
  EXPECT_TRUE(sample.Findings(read, nullptr).empty());
}

TEST(CornerBound, IsNoneWhereTheMakerDocumentsTheCorner) {
  Undocumented sample;
  MotionProgram read = sample.Read();
  read.corner_assumption.clear();
  EXPECT_FALSE(FindCornerBound(read, sample.world.cell()));
  EXPECT_TRUE(sample.Findings(read, &sample.program).empty());
}

}  // namespace
}  // namespace millpose
