// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/sample.hpp"

#include <gtest/gtest.h>

namespace millpose {
namespace {

Toolpath PathOf(const std::vector<int>& lengths) {
  Toolpath path;
  for (size_t p = 0; p < lengths.size(); ++p) {
    Pass pass;
    for (int i = 0; i < lengths[p]; ++i) {
      MillingPoint point;
      point.position = {static_cast<double>(i), static_cast<double>(p), 0};
      pass.points.push_back(point);
    }
    path.passes.push_back(pass);
  }
  return path;
}

size_t Count(const Toolpath& path) {
  size_t count = 0;
  for (const Pass& pass : path.passes) count += pass.points.size();
  return count;
}

TEST(SampleOf, TakesAllWhereThereAreNoMore) { EXPECT_EQ(Count(SampleOf(PathOf({5, 1, 7}), 100)), 13U); }

TEST(SampleOf, TakesAboutAsManyAsAskedForWithTheEndsOfEveryPassItTakes) {
  for (const auto& [lengths, count] :
       std::vector<std::pair<std::vector<int>, size_t>>{{std::vector<int>(65, 40), 200},
                                                        {std::vector<int>(1000, 3), 200},
                                                        {{100, 10000}, 50},
                                                        {{4000}, 200},
                                                        {{500, 500}, 1}}) {
    const Toolpath path = PathOf(lengths), sample = SampleOf(path, count);
    EXPECT_GE(Count(sample) + 3, count);
    EXPECT_LE(Count(sample), count + 3 * sample.passes.size());
    if (count < 3) continue;
    for (const Pass& pass : sample.passes) {
      const auto number = static_cast<size_t>(pass.points.front().position.y());
      EXPECT_EQ(pass.points.front().position, path.passes[number].points.front().position);
      EXPECT_EQ(pass.points.back().position, path.passes[number].points.back().position);
    }
  }
}

TEST(SampleOf, LeavesOutWhatIsNotCut) {
  Toolpath path = PathOf({6});
  path.passes[0].points[0].kind = PointKind::kLeadIn;
  path.passes[0].points[5].kind = PointKind::kLeadOut;
  path.passes[0].points[2].gouge = 0.1;
  const Toolpath sample = SampleOf(path, 100);
  ASSERT_EQ(sample.passes.size(), 1U);
  EXPECT_EQ(sample.passes[0].points.size(), 3U);
}

}  // namespace
}  // namespace millpose
