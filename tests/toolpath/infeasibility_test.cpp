// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/infeasibility.hpp"

#include <set>

namespace millpose {
namespace {

TEST(Infeasibility, OfPosesTheGreatestCameNearest) {
  int passed = -1;
  for (const Infeasibility obstacle :
       {Infeasibility::kUnreachable, Infeasibility::kLimit, Infeasibility::kSingular, Infeasibility::kNone}) {
    EXPECT_GT(TestsPassed(obstacle), passed);
    passed = TestsPassed(obstacle);
    EXPECT_LT(obstacle, Infeasibility::kInterference);
  }
}

TEST(Infeasibility, EachHasAWordOfItsOwn) {
  std::set<std::string> words;
  for (int i = 0; i <= static_cast<int>(Infeasibility::kStock); ++i)
    words.insert(ToString(static_cast<Infeasibility>(i)));
  EXPECT_EQ(words.size(), static_cast<size_t>(Infeasibility::kStock) + 1);
  EXPECT_FALSE(words.contains("unknown"));
}

}  // namespace
}  // namespace millpose
