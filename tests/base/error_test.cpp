// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"

#include "base/random.hpp"
#include "base/shown.hpp"

namespace millpose {

TEST(Error, PlaceIsWrittenByWhatIsKnown) {
  EXPECT_EQ(ToString(SourceLocation{"a.yaml", 3, 7}), "a.yaml:3:7");
  EXPECT_EQ(ToString(SourceLocation{"a.yaml", 3}), "a.yaml:3");
  EXPECT_EQ(ToString(SourceLocation{"a.stl", 0, 0, 84}), "a.stl, byte 84");
  EXPECT_EQ(ToString(SourceLocation{"a.yaml"}), "a.yaml");
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
  EXPECT_EQ(NearestName("kr500", {"ur10e", "kr500_r2800_2", "kr500_r2830"}), "kr500_r2800_2");
  EXPECT_EQ(NearestName("tool", {"toolpath", "tools"}), "tools");
  EXPECT_EQ(NearestName("xyz", {"stepover_mm", "chord_tolerance_mm"}), "");
}

TEST(Error, APlaceThatIsNotKnownLeavesTheMessageAlone) {
  EXPECT_STREQ(InputError(SourceLocation{}, "no home").what(), "no home");
  EXPECT_STREQ(InputError(SourceLocation{"a"}, std::string("b\0c", 3)).what(), "a: b?c");
}

TEST(Error, OfManyProblemsTheFirstAreListedAndTheRestIsMentioned) {
  std::vector<Problem> many;
  for (int i = 1; i <= 60; ++i) many.push_back({{"a", i}, "bad"});
  const InputError error(many);
  EXPECT_EQ(error.problems().size(), kMostProblems + 1);
  EXPECT_EQ(error.problems()[kMostProblems - 1].place.line, static_cast<int>(kMostProblems));
  EXPECT_EQ(error.problems().back().message, "more problems follow that are not listed");
}

/// By its definition: an edit at either end, or both ends go on.
size_t SlowDistance(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const size_t step = a[0] == b[0] ? 0 : 1;
  return std::min({SlowDistance(a.substr(1), b) + 1, SlowDistance(a, b.substr(1)) + 1,
                   SlowDistance(a.substr(1), b.substr(1)) + step});
}

TEST(Error, NearestNameIsTheLeastDistanceOfAll) {
  RandomStream random(1, 0);
  const auto word = [&] {
    std::string text;
    for (int n = 1 + random.Below(5); n > 0; --n) text += static_cast<char>('a' + random.Below(3));
    return text;
  };
  for (int k = 0; k < 300; ++k) {
    const std::string given = word();
    const std::vector<std::string> known{word(), word(), word(), word()};
    const std::string nearest = NearestName(given, known);
    size_t least = 99;
    for (const std::string& name : known) least = std::min(least, SlowDistance(given, name));
    if (nearest.empty())
      EXPECT_GE(least, given.size() / 2 + 2) << given;
    else
      EXPECT_EQ(SlowDistance(given, nearest), least) << given;
  }
}

TEST(Error, AnUnknownNameSaysWhatThereIs) {
  EXPECT_EQ(UnknownName("objective", "chen2012", {"chen2021", "drilling"}),
            "no objective \"chen2012\"; known: chen2021, drilling; did you mean \"chen2021\"?");
  EXPECT_EQ(UnknownName("objective", "zzzzzzzz", {"chen2021"}), "no objective \"zzzzzzzz\"; known: chen2021");
  EXPECT_EQ(UnknownName("post", "krl", {}), "no post \"krl\"; there are none");
}

}  // namespace millpose
