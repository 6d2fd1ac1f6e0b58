// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/removal.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kDepth = 4;  // mm that the cuts below reach under the top at 10

/// A block of 60 × 40 × 10 mm, and random cuts of a bull-nose cutter through its upper side, one a second.
struct MilledBlock {
  Triangles blank = BoxShape({0, 0, 0}, {60, 40, 10}), part = BoxShape({0, 0, 0}, {60, 40, 10 - kDepth});
  CutterShape cutter{5, 1, 30};
  std::vector<TimedMotion> motions;

  MilledBlock() {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> x(-5, 65), y(-5, 45), z(10 - kDepth, 10);
    const auto place = [&] { return CutterPlace{{x(random), y(random), z(random)}, Vector3d::UnitZ()}; };
    for (CutterPlace at = place(); motions.size() < 90;) {
      const CutterPlace next = place();
      motions.push_back({{at, next, 0}, static_cast<double>(motions.size() + 1)});
      at = next;
    }
  }

  Removal Watched(size_t frames, int threads = 1) const {
    return WatchRemoval(StandingStock(blank, 0.5), part, cutter, motions, frames, threads);
  }
};

/// What the frames up to one leave on every line.
std::vector<Span> After(const Removal& removal, size_t frames) {
  std::vector<Span> ends = removal.blank;
  size_t at = 0;
  for (size_t f = 0; f < frames; ++f)
    for (size_t k = 0; k < removal.frames[f].changed; ++k, ++at) ends[removal.lines[at]] = removal.ends[at];
  return ends;
}

double Farthest(const std::vector<Span>& a, const std::vector<Span>& b) {
  double farthest = 0;
  EXPECT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].high < a[i].low, b[i].high < b[i].low) << i;
    if (a[i].high >= a[i].low)
      farthest = std::max({farthest, std::abs(a[i].low - b[i].low), std::abs(a[i].high - b[i].high)});
  }
  return farthest;
}

// Every frame is what the stock itself is after so many motions, but for what is too little to be told.
TEST(Removal, FramesAreTheStockOfTheirTime) {
  const MilledBlock block;
  const Removal removal = block.Watched(30);
  ASSERT_EQ(removal.frames.size(), 30u);
  StandingStock stock(block.blank, 0.5);
  EXPECT_NEAR(removal.volume, stock.Volume(), 1e-9);
  for (size_t f = 0; f < removal.frames.size(); ++f) {
    std::vector<CutterMotion> cuts;
    for (size_t i = 3 * f; i < 3 * f + 3; ++i) cuts.push_back(block.motions[i].motion);
    stock.Remove(block.cutter, cuts, 1);
    EXPECT_EQ(removal.frames[f].time, 3.0 * static_cast<double>(f + 1));
    EXPECT_NEAR(removal.frames[f].volume, stock.Volume(), 1e-9);
    const double off = Farthest(After(removal, f + 1), stock.Ends());
    EXPECT_LE(off, f + 1 < removal.frames.size() ? 10.0 / 500 : 0) << f;
  }
  EXPECT_LT(removal.frames.back().volume, 0.9 * removal.volume);
}

TEST(Removal, ThePartLiesOnTheSameLines) {
  const Removal removal = MilledBlock().Watched(10);
  size_t on_part = 0;
  for (size_t line = 0; line < removal.part.size(); ++line) {
    const Span &part = removal.part[line], &blank = removal.blank[line];
    EXPECT_EQ(part.high < part.low, blank.high < blank.low);
    if (part.high < part.low) continue;
    ++on_part;
    EXPECT_NEAR(part.high, 10 - kDepth, 1e-9);
    EXPECT_NEAR(blank.high, 10, 1e-9);
  }
  EXPECT_NEAR(static_cast<double>(on_part) * removal.spacing * removal.spacing, 60 * 40, 0.02 * 2400);
}

TEST(Removal, IsTheSameForAnyNumberOfThreads) {
  const MilledBlock block;
  const Removal one = block.Watched(20), four = block.Watched(20, 4);
  EXPECT_EQ(one.lines, four.lines);
  EXPECT_EQ(Farthest(one.ends, four.ends), 0);
}

// The lines follow the tool, not the blank's shortest side: a slot into the side of a plate is seen from
// there.
TEST(Removal, LinesRunAlongTheTool) {
  const std::vector<TimedMotion> motions{
      {{{{0, 10, 5}, -Vector3d::UnitY()}, {{60, 10, 5}, -Vector3d::UnitY()}, 0}, 1}};
  EXPECT_EQ(AxisOfLines(motions), 1);
  const Triangles plate = BoxShape({0, 0, 0}, {60, 40, 10});
  const Removal removal = WatchRemoval(StandingStock(plate, 0.5, 4'000'000, AxisOfLines(motions)), plate,
                                       {2, 0, 50}, motions, 10, 1);
  EXPECT_EQ(removal.along, 1);
  const std::vector<Span> ends = After(removal, 1);
  const auto lowest = std::ranges::max_element(ends, {}, &Span::low);
  EXPECT_NEAR(lowest->low, 10, 1e-9);
  EXPECT_NEAR(removal.volume - removal.frames[0].volume, 60 * 4 * 10, 0.05 * 2400);
}

}  // namespace
}  // namespace millpose
