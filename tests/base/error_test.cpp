// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"

namespace millpose {

TEST(Error, PlaceIsWrittenByWhatIsKnown) {
  EXPECT_EQ(ToString(Place{"a.yaml", 3, 7}), "a.yaml:3:7");
  EXPECT_EQ(ToString(Place{"a.yaml", 3}), "a.yaml:3");
  EXPECT_EQ(ToString(Place{"a.stl", 0, 0, 84}), "a.stl, byte 84");
  EXPECT_EQ(ToString(Place{"a.yaml"}), "a.yaml");
}

TEST(Error, AllProblemsAreInTheText) {
  const InputError error({{{"a", 1, 2}, "first"}, {{"a", 3, 4}, "second"}});
  EXPECT_STREQ(error.what(), "a:1:2: first\na:3:4: second");
  EXPECT_EQ(error.problems().size(), 2u);
}

TEST(Error, NeitherManyProblemsNorLongOnesFillTheLog) {
  const std::vector<Problem> many(1000, {{"a", 1}, std::string(10000, 'x')});
  EXPECT_LT(std::string(InputError(many).what()).size(), 500000u);
}

TEST(Error, NearestNameFindsSlipsAndLeavesStrangersAlone) {
  EXPECT_EQ(NearestName("stepver_mm", {"stepover_mm", "spacing_mm"}), "stepover_mm");
  EXPECT_EQ(NearestName("Seed", {"name", "seed"}), "seed");
  EXPECT_EQ(NearestName("xyz", {"stepover_mm", "chord_tolerance_mm"}), "");
}

}  // namespace millpose
