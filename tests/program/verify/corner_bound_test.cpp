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

/// The places that lie within `reach` of the corner along the path, ends included.
std::vector<Vector3d> CutOff(const std::vector<Pose>& tools, size_t corner, double reach) {
  std::vector<Vector3d> places;
  for (int step : {-1, 1}) {
    std::vector<Vector3d> side;
    double left = reach;
    for (size_t k = corner; left > 0 && (step > 0 ? k + 1 < tools.size() : k > 0);
         k += static_cast<size_t>(step)) {
      const Vector3d way =
          tools[k + static_cast<size_t>(step)].translation() - Vector3d(tools[k].translation());
      side.push_back(tools[k].translation() + std::min(1.0, left / way.norm()) * way);
      left -= way.norm();
    }
    places.insert(places.end(), side.begin(), side.end());
  }
  places.push_back(tools[corner].translation());
  return places;
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
  // It turns on the way there alone: half of it may be early or late.
  EXPECT_NEAR(WithinReach({At(-10, 0, -0.1), At(0, 0, 0), At(10, 0, 0)}, 1, 2).angle, 0, 1e-9);
  EXPECT_NEAR(WithinReach({At(-10, 0, -0.1), At(0, 0, 0), At(10, 0, -0.1)}, 1, 2).angle, 0.02, 1e-9);
}

TEST(CornerBound, HoldsForEveryPlaceOfTheHull) {
  std::mt19937 random(7);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  double tightest = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Pose> tools;
    std::vector<Vector3d> path;
    for (int k = 0; k < 7; ++k) {
      tools.push_back(At(uniform(0, 4) + 2 * k, uniform(-1, 1)));
      path.push_back(tools.back().translation());
    }
    const double reach = uniform(0.1, 6);
    const double bound = WithinReach(tools, 3, reach).position;
    const std::vector<Vector3d> hull = CutOff(tools, 3, reach);
    for (int sample = 0; sample < 30; ++sample) {
      Vector3d place = Vector3d::Zero();
      double sum = 0;
      for (const Vector3d& vertex : hull) {
        const double weight = -std::log(uniform(1e-9, 1));
        place += weight * vertex;
        sum += weight;
      }
      const double off = DistanceFrom(path, place / sum);
      EXPECT_LE(off, bound + 1e-9) << "reach " << reach;
      tightest = std::max(tightest, off / std::max(bound, 1e-9));
    }
  }
  EXPECT_GT(tightest, 0.5);  // a bound, and no idle one
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

TEST(CornerBound, IsNoneWhereTheMakerDocumentsTheCorner) {
  Undocumented sample;
  MotionProgram read = sample.Read();
  read.corner_assumption.clear();
  EXPECT_FALSE(FindCornerBound(read, sample.world.cell()));
  EXPECT_TRUE(sample.Findings(read, &sample.program).empty());
}

}  // namespace
}  // namespace millpose
