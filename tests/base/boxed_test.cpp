// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/boxed.hpp"

#include <gtest/gtest.h>

#include <string>

namespace millpose {
namespace {

TEST(Boxed, IsAnOptionalInTheRoomOfAPointer) {
  static_assert(sizeof(Boxed<std::array<double, 16>>) == sizeof(void*));
  const Boxed<std::string> none, none_too = std::nullopt, of_none = std::optional<std::string>();
  EXPECT_FALSE(none || none_too || of_none);
  EXPECT_FALSE(none.has_value());
  EXPECT_EQ(none, none_too);
  EXPECT_EQ(none.AsOptional(), std::nullopt);
  Boxed<std::string> a = std::string("part"), b = a;
  EXPECT_EQ(a, b);
  EXPECT_EQ(a.AsOptional(), "part");
  EXPECT_EQ(Boxed<std::string>(std::optional<std::string>("part")), a);
  b->push_back('s');
  EXPECT_EQ(*a, "part") << "copies are deep";
  EXPECT_EQ(*b, "parts");
  EXPECT_FALSE(a == b);
  EXPECT_FALSE(a == none);
  a = b;
  EXPECT_EQ(*a, "parts");
  const Boxed<std::string>& same = a;
  a = same;
  EXPECT_EQ(*a, "parts");
  b = none;
  EXPECT_FALSE(b);
  Boxed<std::string> made;
  made.emplace() = "parts";
  EXPECT_EQ(made, a);
  Boxed<std::string> moved = std::move(a);
  EXPECT_EQ(*moved, "parts");
  moved.reset();
  EXPECT_FALSE(moved.has_value());
}

}  // namespace
}  // namespace millpose
