// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/pass_variants.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"

namespace millpose {
namespace {

bool IsSame(const MillingPoint& a, const MillingPoint& b) {
  return IsSamePlace(a, b) && a.feed == b.feed && a.arc_length == b.arc_length && a.kind == b.kind;
}

Pass Arc(int points, bool closed) {
  Pass pass;
  pass.closed = closed;
  for (int i = 0; i < points; ++i) {
    MillingPoint point;
    const double angle = 2 * kPi * i / (closed ? points : 2.0 * points);
    point.position = {100 * std::cos(angle), 100 * std::sin(angle), 0};
    point.feed = {-std::sin(angle), std::cos(angle), 0};
    point.arc_length =
        i == 0 ? 0 : pass.points.back().arc_length + (point.position - pass.points.back().position).norm();
    pass.points.push_back(point);
  }
  return pass;
}

/// Every `stride`-th point.
Pass Thinned(const Pass& pass, size_t stride) {
  Pass thin = pass;
  thin.points.clear();
  for (size_t t = 0; t < pass.points.size(); t += stride) thin.points.push_back(pass.points[t]);
  return thin;
}

TEST(PassVariants, PointsGoWhereTheyAreAskedForAndNowhereElse) {
  for (const bool closed : {false, true}) {
    const Pass finer = Arc(closed ? 40 : 41, closed), laid = Thinned(finer, 4);
    std::vector<char> between(laid.points.size(), 0);
    between[2] = 1;
    if (closed) between.back() = 1;
    const Pass with = WithPointsBetween(laid, finer, between);
    ASSERT_EQ(with.points.size(), laid.points.size() + (closed ? 6 : 3));
    for (size_t i = 0; i < 3; ++i) EXPECT_TRUE(IsSame(with.points[i], laid.points[i]));
    for (size_t i = 0; i < 3; ++i) EXPECT_TRUE(IsSamePlace(with.points[3 + i], finer.points[9 + i]));
    for (size_t i = 3; i < laid.points.size(); ++i) EXPECT_TRUE(IsSame(with.points[i + 3], laid.points[i]));
    for (size_t i = 1; i < with.points.size(); ++i)
      EXPECT_GT(with.points[i].arc_length, with.points[i - 1].arc_length);
    if (closed) {
      EXPECT_TRUE(IsSamePlace(with.points.back(), finer.points.back()));
    }
  }
}

TEST(PassVariants, APointThatWouldGougeIsNotInserted) {
  Pass finer = Arc(41, false);
  const Pass laid = Thinned(finer, 4);
  finer.points[9].gouge = 0.5;
  EXPECT_EQ(WithPointsBetween(laid, finer, std::vector<char>(laid.points.size(), 1)).points.size(), 40u);
}

TEST(PassVariants, AFinerPassThatLacksAPointChangesNothing) {
  Pass finer = Arc(41, false);
  const Pass laid = Thinned(finer, 4);
  finer.points.erase(finer.points.begin() + 20);
  const Pass with = WithPointsBetween(laid, finer, std::vector<char>(laid.points.size(), 1));
  ASSERT_EQ(with.points.size(), laid.points.size());
  for (size_t i = 0; i < laid.points.size(); ++i) EXPECT_TRUE(IsSame(with.points[i], laid.points[i]));
}

TEST(PassVariants, RunTwiceFromItsEndAPassIsWhatItWas) {
  Pass pass = Arc(12, false);
  pass.points.front().kind = PointKind::kLeadIn;
  const Pass turned = RunFromEnd(pass);
  EXPECT_EQ(turned.points.back().kind, PointKind::kLeadOut);
  EXPECT_EQ(turned.points.front().arc_length, 0);
  EXPECT_TRUE(turned.points.front().feed == -pass.points.back().feed);
  const Pass again = RunFromEnd(turned);
  for (size_t i = 0; i < pass.points.size(); ++i) {
    EXPECT_TRUE(IsSamePlace(again.points[i], pass.points[i]));
    EXPECT_NEAR(again.points[i].arc_length, pass.points[i].arc_length, 1e-12);
    EXPECT_EQ(again.points[i].kind, pass.points[i].kind);
  }
}

}  // namespace
}  // namespace millpose
