// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/registry.hpp"

#include <gtest/gtest.h>

namespace millpose {
namespace {

struct Entry {
  std::string name;
  int value = 0;
};

Registry<Entry> Three() { return {"colour", {{"red", 1}, {"green", 2}, {"blue", 3}}}; }

TEST(Registry, KeepsTheOrderAndFindsByName) {
  const Registry<Entry> registry = Three();
  EXPECT_EQ(registry.Names(), (std::vector<std::string>{"red", "green", "blue"}));
  EXPECT_EQ(registry.At("green").value, 2);
}

TEST(Registry, AnUnknownNameIsToldWithTheKnownAndTheNearest) {
  try {
    Three().At("gren");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "no colour \"gren\"; known: red, green, blue; did you mean \"green\"?");
  }
}

TEST(Registry, TakesFurtherEntriesUntilItIsLookedAt) {
  Registry<Entry> registry = Three();
  registry.Add({"white", 4});
  EXPECT_EQ(registry.At("white").value, 4);
  EXPECT_THROW(registry.Add({"white", 5}), std::logic_error);
  EXPECT_EQ(registry.Names().size(), 4u);
  EXPECT_THROW(registry.Add({"black", 6}), std::logic_error);
}

}  // namespace
}  // namespace millpose
