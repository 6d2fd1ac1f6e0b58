// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/obstacle.hpp"

#include <set>

namespace millpose {
namespace {

TEST(Obstacle, OfPosesTheGreatestCameNearest) {
  int passed = -1;
  for (const Obstacle obstacle :
       {Obstacle::kUnreachable, Obstacle::kLimit, Obstacle::kSingular, Obstacle::kNone}) {
    EXPECT_GT(TestsPassed(obstacle), passed);
    passed = TestsPassed(obstacle);
    EXPECT_LT(obstacle, Obstacle::kInterference);
  }
}

TEST(Obstacle, EachHasAWordOfItsOwn) {
  std::set<std::string> words;
  for (int i = 0; i <= static_cast<int>(Obstacle::kIncomplete); ++i)
    words.insert(ToString(static_cast<Obstacle>(i)));
  EXPECT_EQ(words.size(), static_cast<size_t>(Obstacle::kIncomplete) + 1);
  EXPECT_FALSE(words.contains("unknown"));
}

}  // namespace
}  // namespace millpose
