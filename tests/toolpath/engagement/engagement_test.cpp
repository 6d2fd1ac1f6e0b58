// SPDX-License-Identifier: GPL-3.0-or-later
// Engagement against a fine simulated removal: a plane of dexels that the cutter is moved over in small
// steps.
#include "toolpath/engagement/engagement.hpp"

#include <gtest/gtest.h>

#include <ctime>

#include "base/trig.hpp"
#include "base/units.hpp"
#include "toolpath/engagement/entries.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRadius = 5, kDepth = 1;
constexpr double kWide = 60, kHigh = 45;  // mm, of the stock

EngagementOptions Flat() {
  EngagementOptions options;
  options.edge.material = {"made up", 700, 0.25, ""};
  options.edge.cutter = {kRadius, 0, 20};
  options.edge.teeth = 4;
  options.spindle_speed = 100;
  options.depth = kDepth;
  options.stock = [](const Vector3d& p) {
    return p.x() > 0 && p.x() < kWide && p.y() > 0 && p.y() < kHigh && p.z() > -1e-6 && p.z() < kDepth;
  };
  return options;
}

Pass PassAlong(const std::vector<Vector2d>& way, bool closed = false, double height = 0) {
  Pass pass;
  pass.closed = closed;
  for (size_t i = 0; i < way.size(); ++i) {
    const size_t last = way.size() - 1;
    const Vector2d before = i > 0 ? way[i - 1] : closed ? way[last] : way[0];
    const Vector2d after = i < last ? way[i + 1] : closed ? way[0] : way[last];
    MillingPoint point;
    point.position = {way[i].x(), way[i].y(), height};
    const Vector2d feed = (after - before).normalized();
    point.feed = {feed.x(), feed.y(), 0};
    point.feed_rate = 20;
    pass.points.push_back(point);
  }
  return pass;
}

std::vector<Vector2d> Line(const Vector2d& from, const Vector2d& to, double spacing = 2) {
  const int count = static_cast<int>((to - from).norm() / spacing);
  std::vector<Vector2d> way;
  for (int i = 0; i <= count; ++i) way.emplace_back(from + (to - from) * i / count);
  return way;
}

/// Columns of 0.2 mm: true where the material still stands.
class Dexels {
 public:
  bool& At(int i, int j) { return stands_[static_cast<size_t>(j * kColumns + i)]; }
  /// Clears the disc about `centre`; `taken(left)` for each column that stood, with its place to the left.
  template <typename Taken>
  void Clear(const Vector2d& centre, const Vector2d& feed, const Taken& taken) {
    const int i0 = Index(centre.x() - kRadius), i1 = Index(centre.x() + kRadius) + 1;
    const int j0 = Index(centre.y() - kRadius), j1 = Index(centre.y() + kRadius) + 1;
    for (int j = std::max(0, j0); j <= std::min(kRows - 1, j1); ++j)
      for (int i = std::max(0, i0); i <= std::min(kColumns - 1, i1); ++i) {
        const Vector2d away = Vector2d((i + 0.5) * kCell, (j + 0.5) * kCell) - centre;
        if (away.norm() > kRadius || !At(i, j)) continue;
        At(i, j) = false;
        taken(feed.x() * away.y() - feed.y() * away.x());
      }
  }

 private:
  static constexpr double kCell = 0.2;
  static constexpr int kColumns = static_cast<int>(kWide / kCell), kRows = static_cast<int>(kHigh / kCell);
  static int Index(double x) { return static_cast<int>(std::floor(x / kCell)); }
  struct Bit {
    bool value = true;
    operator bool&() { return value; }
  };
  std::vector<Bit> stands_ = std::vector<Bit>(static_cast<size_t>(kColumns * kRows));
};

struct Removal {
  double left = 0, right = 0;  ///< mm across the feed
  double Width() const { return left + right; }
};

/// What is taken off on the first half millimetre beyond each point.
std::vector<Removal> Simulate(const Toolpath& toolpath) {
  constexpr double kBin = 0.25, kStep = 0.05, kLook = 0.5;
  Dexels dexels;
  std::vector<Removal> removals;
  for (const Pass& pass : toolpath.passes) {
    const size_t count = pass.points.size();
    for (size_t t = 0; t < count; ++t) {
      std::vector<char> bins(static_cast<size_t>(2 * kRadius / kBin) + 1, 0);
      const Vector2d from = pass.points[t].position.head<2>(), feed = pass.points[t].feed.head<2>();
      dexels.Clear(from, feed, [](double) {});
      const bool last = t + 1 == count;
      const Vector2d to = last && !pass.closed ? Vector2d(from + kLook * feed)
                                               : Vector2d(pass.points[(t + 1) % count].position.head<2>());
      Dexels kept = dexels;  // beyond a pass's end nothing is cut
      const double way = (to - from).norm();
      for (double at = kStep; at < way + kStep; at += kStep)
        dexels.Clear(from + (to - from) * std::min(1.0, at / way), feed, [&](double left) {
          if (at <= kLook) bins[static_cast<size_t>((left + kRadius) / kBin)] = 1;
        });
      if (last && !pass.closed) dexels = kept;
      Removal removal;
      for (size_t b = 0; b < bins.size(); ++b)
        if (bins[b]) (b * kBin < kRadius ? removal.right : removal.left) += kBin;
      removals.push_back(removal);
    }
  }
  return removals;
}

/// Points farther than the radius from where the cut begins or ends and from corners, whose feed they are.
bool Steady(const Pass& pass, size_t t) {
  const MillingPoint& here = pass.points[t];
  if (!pass.closed) {
    if ((here.position - pass.points.front().position).norm() <= kRadius) return false;
    if ((here.position - pass.points.back().position).norm() <= kRadius) return false;
  }
  if (here.position.x() < kRadius || here.position.x() > kWide - kRadius) return false;
  if (here.position.y() < kRadius || here.position.y() > kHigh - kRadius) return false;
  for (const MillingPoint& other : pass.points)
    if ((other.position - here.position).norm() <= kRadius && other.feed.dot(here.feed) < 0.6) return false;
  return true;
}

/// Compares with the simulation; the number of points compared and of those that mill up and down.
struct Compared {
  int points = 0, up = 0, down = 0, slot = 0;
};
Compared Compare(Toolpath toolpath) {
  SetEngagement(Flat(), 2, {}, toolpath);
  const std::vector<Removal> expected = Simulate(toolpath);
  Compared compared;
  size_t number = 0;
  for (const Pass& pass : toolpath.passes) {
    for (size_t t = 0; t < pass.points.size(); ++t, ++number) {
      if (!Steady(pass, t)) continue;
      const Removal& removal = expected[number];
      const Engagement& found = pass.points[t].engagement;
      const Vector3d& at = pass.points[t].position;
      ++compared.points;
      // 5 % of the diameter, and a bin of the simulation to either side.
      EXPECT_NEAR(found.width, removal.Width(), 0.05 * 2 * kRadius + 0.25) << at.transpose();
      if (removal.Width() < 0.05 * 2 * kRadius + 0.25 || removal.Width() > 0.93 * 2 * kRadius) {
        compared.slot += found.side == CutSide::kSlot;
        continue;
      }
      if (std::abs(removal.left - removal.right) < 0.6) continue;
      EXPECT_EQ(Name(found.side), Name(removal.left > removal.right ? CutSide::kUp : CutSide::kDown))
          << at.transpose();
      (removal.left > removal.right ? compared.up : compared.down) += 1;
    }
  }
  return compared;
}

TEST(Engagement, OfAZigzagIsASlotFirstThenUpAndDownInTurns) {
  Toolpath zigzag;
  for (int k = 0; k < 8; ++k) {
    const double y = 8 + 4 * k;
    zigzag.passes.push_back(PassAlong(k % 2 == 0 ? Line({-8, y}, {68, y}) : Line({68, y}, {-8, y})));
  }
  const Compared compared = Compare(zigzag);
  EXPECT_GT(compared.slot, 15);
  EXPECT_GT(compared.up, 50);
  EXPECT_GT(compared.down, 50);
  Toolpath cut = zigzag;
  SetEngagement(Flat(), 1, {}, cut);
  for (size_t k = 1; k < 8; ++k) {
    const Engagement& middle = cut.passes[k].points[19].engagement;
    EXPECT_EQ(Name(middle.side), Name(k % 2 == 0 ? CutSide::kUp : CutSide::kDown)) << k;
    EXPECT_NEAR(middle.width, 4, 0.05);
    EXPECT_NEAR(middle.depth, kDepth, 1e-9);
  }
}

// The stock's frame is anywhere in space; rounding then tilts feed and axis against each other by 1e-16.
TEST(Engagement, OfAPartThatLiesOtherwiseIsTheSame) {
  Toolpath zigzag;
  for (int k = 0; k < 4; ++k) {
    const double y = 8 + 4 * k;
    zigzag.passes.push_back(PassAlong(k % 2 == 0 ? Line({-8, y}, {68, y}) : Line({68, y}, {-8, y})));
  }
  Toolpath upright = zigzag;
  SetEngagement(Flat(), 1, {}, upright);
  for (const double angle : {0.3, 1.1, 2.9}) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vector3d(1, 2, -0.5).normalized()).matrix();
    Toolpath turned = zigzag;
    for (Pass& pass : turned.passes)
      for (MillingPoint& point : pass.points)
        for (Vector3d* vector : {&point.position, &point.normal, &point.feed, &point.tool_axis})
          *vector = turn * *vector;
    EngagementOptions options = Flat();
    options.stock = [turn, stock = options.stock](const Vector3d& p) { return stock(turn.transpose() * p); };
    SetEngagement(options, 1, {}, turned);
    for (size_t k = 0; k < 4; ++k)
      for (size_t i = 0; i < zigzag.passes[k].points.size(); ++i) {
        const Engagement &here = turned.passes[k].points[i].engagement,
                         &there = upright.passes[k].points[i].engagement;
        const Vector2d at = zigzag.passes[k].points[i].position.head<2>();
        EXPECT_EQ(std::string(Name(here.side)), Name(there.side)) << at.transpose();
        EXPECT_NEAR(here.width, there.width, 1e-6) << at.transpose();
        EXPECT_NEAR(here.depth, there.depth, 1e-6) << at.transpose();
        EXPECT_LT((turn.transpose() * here.force - there.force).norm(), 1e-6) << at.transpose();
      }
  }
}

// Points may stand as close as they like: what they take off is the same, and the time rises in proportion.
TEST(Engagement, OfDensePointsIsThatOfTheSameWay) {
  const auto zigzag = [](double spacing) {
    Toolpath path;
    for (int k = 0; k < 3; ++k) {
      const double y = 8 + 4 * k;
      path.passes.push_back(
          PassAlong(k % 2 == 0 ? Line({-8, y}, {68, y}, spacing) : Line({68, y}, {-8, y}, spacing)));
    }
    return path;
  };
  const auto seconds = [](Toolpath& path) {
    const std::clock_t start = std::clock();
    SetEngagement(Flat(), 1, {}, path);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  Toolpath coarse = zigzag(2), dense = zigzag(0.25), denser = zigzag(0.0625);
  seconds(coarse);
  const double few = seconds(dense), many = seconds(denser);
  EXPECT_LT(many, 8 * few + 0.1);  // of four times as many; 16 times were it quadratic
  for (size_t k = 0; k < 3; ++k)
    for (size_t i = 0; i < coarse.passes[k].points.size(); ++i) {
      const MillingPoint& at = coarse.passes[k].points[i];
      const MillingPoint& same = dense.passes[k].points[8 * i];
      ASSERT_LT((at.position - same.position).norm(), 1e-9);
      EXPECT_NEAR(at.engagement.width, same.engagement.width, 0.05);
      EXPECT_LT((at.engagement.force - same.engagement.force).norm(),
                0.02 * at.engagement.force.norm() + 0.5);
    }
}

TEST(Engagement, OfRingsInwardsAndOutwardsAndOfASpiral) {
  const auto ring = [](double radius, bool clockwise) {
    std::vector<Vector2d> way;
    for (int i = 0; i < 60; ++i) {
      const auto [s, c] = SinCos((clockwise ? -1 : 1) * 2 * kPi * i / 60);
      way.emplace_back(30 + radius * c, 22.5 + radius * s);
    }
    return PassAlong(way, true);
  };
  for (const bool clockwise : {false, true}) {
    Toolpath inwards;
    for (const double radius : {17.0, 13.0, 9.0}) inwards.passes.push_back(ring(radius, clockwise));
    const Compared compared = Compare(inwards);
    EXPECT_GT(clockwise ? compared.down : compared.up, 50) << "the middle stands on the other side";
  }
  Toolpath spiral;
  std::vector<Vector2d> way;
  for (int i = 0; i < 260; ++i) {
    const double angle = 2 * kPi * i / 60, radius = 2 + 3.0 * angle / (2 * kPi);
    way.emplace_back(30 + radius * SinCos(angle).cos, 22.5 + radius * SinCos(angle).sin);
  }
  spiral.passes.push_back(PassAlong(way));
  EXPECT_GT(Compare(spiral).points, 100);
}

TEST(Engagement, OfAPassThatIsMissingAndOfPointsThatAreSkippedCountsWhatIsLeftStanding) {
  Toolpath passes;
  for (const double y : {8.0, 12.0, 20.0}) passes.passes.push_back(PassAlong(Line({-8, y}, {68, y})));
  for (MillingPoint& point : passes.passes[1].points) point.gouge = point.position.x() > 30 ? 1 : 0;
  SetEngagement(Flat(), 1, {}, passes);
  for (const MillingPoint& point : passes.passes[2].points) {
    const double x = point.position.x();
    // From 12 to 20 mm stand 8 − 5 mm up to the cutter's edge; from 8 to 20 the pass is a slot.
    if (x > 2 && x < 20) {
      EXPECT_NEAR(point.engagement.width, 8, 0.1) << x;
    }
    if (x > 42 && x < 54) {
      EXPECT_EQ(Name(point.engagement.side), std::string("slot")) << x;
    }
  }
  EXPECT_EQ(Name(passes.passes[1].points.back().engagement.side), std::string("air"));
}

TEST(Engagement, OverhangsAnOpenBorderAndRampsInAndOut) {
  Toolpath pass;
  pass.passes.push_back(PassAlong(Line({-10, 2}, {70, 2}, 1)));
  SetEngagement(Flat(), 1, {}, pass);
  double before = 0;
  for (const MillingPoint& point : pass.passes[0].points) {
    const double x = point.position.x(), force = point.engagement.force.norm();
    if (x <= -kRadius) {
      EXPECT_EQ(force, 0) << x;
    }
    if (x > -kRadius && x < 0) {
      EXPECT_GE(force, before * (1 - 1e-3)) << x;
    }
    if (x > 1 && x < kWide - kRadius - 1) {
      EXPECT_NEAR(point.engagement.width, kRadius + 2, 0.05) << x;
    }
    if (x >= kWide) {
      EXPECT_EQ(force, 0) << x;
    }
    before = force;
  }
}

TEST(Engagement, OfALayerUnderAMissingOneIsDeeper) {
  Toolpath layers;
  for (const double height : {1.0, 0.0})
    for (const double y : {5.0, 13.0, 21.0})
      layers.passes.push_back(PassAlong(Line({-8, y}, {68, y}), false, height));
  EngagementOptions options = Flat();
  options.stock = [](const Vector3d& p) {
    return p.x() > 0 && p.x() < kWide && p.y() > 0 && p.y() < kHigh && p.z() > -1e-6 && p.z() < 2 * kDepth;
  };
  SetEngagement(options, 1, {}, layers);
  const auto depth = [&](size_t pass) { return layers.passes[pass].points[19].engagement.depth; };
  EXPECT_NEAR(depth(4), 1, 1e-9);
  layers.passes.erase(layers.passes.begin() + 1);
  SetEngagement(options, 1, {}, layers);
  EXPECT_NEAR(depth(3), 2, 1e-9);
}

/// Passes along x at y whose points have the normal of an edge: −y.
Pass EdgeAlong(double y, double height) {
  Pass pass = PassAlong(Line({-8, y}, {68, y}), false, height);
  for (MillingPoint& point : pass.points) point.normal = -Vector3d::UnitY();
  return pass;
}

/// Of the closed form, for as much of a plate's edge.
Vector3d ClosedForm(const EngagementOptions& options, double depth, double width, MillingSide side) {
  const Cut cut{.material = options.edge.material,
                .diameter = 2 * kRadius,
                .teeth = options.edge.teeth,
                .depth = depth,
                .width = width,
                .feed_per_tooth = 20 / (options.spindle_speed * options.edge.teeth),
                .side = side,
                .radial_ratio = options.edge.radial_ratio};
  return MeanCuttingForce(cut).mean;
}

// A plate that the cutter goes through: a wall beside it and a slot, down to the far side, at once and in two
// rounds that are farther apart than the cutter is wide.
TEST(Engagement, OfTheSideOfTheCutterIsThatOfTheClosedForm) {
  constexpr double kPlate = 24;
  EngagementOptions options = Flat();
  options.edge.cutter = {kRadius, 0, 40};
  options.stock = [](const Vector3d& p) {
    return p.x() > 0 && p.x() < kWide && p.y() > 0 && p.y() < kHigh && p.z() > 0 && p.z() < kPlate;
  };
  struct Case {
    double y;
    std::vector<double> tips;
    double depth, width;
    MillingSide side;
  };
  for (const Case& one : {Case{-2, {-1}, kPlate, kRadius - 2, MillingSide::kUp},
                          Case{20, {-1}, kPlate, 2 * kRadius, MillingSide::kSlot},
                          Case{-2, {12, -1}, 12, kRadius - 2, MillingSide::kUp},
                          Case{20, {12, -1}, 12, 2 * kRadius, MillingSide::kSlot}}) {
    Toolpath path;
    for (const double tip : one.tips) path.passes.push_back(EdgeAlong(one.y, tip));
    SetEngagement(options, 1, {}, path);
    const Engagement& found = path.passes.back().points[19].engagement;
    const Vector3d expected = ClosedForm(options, one.depth, one.width, one.side);
    EXPECT_LT((found.force - expected).norm(), 5e-3 * expected.norm())
        << found.force.transpose() << "; " << expected.transpose();
    EXPECT_NEAR(found.depth, kPlate + 1 - (one.tips.size() - 1) * 12, 0.5 * kDepth) << one.y;
    EXPECT_NEAR(found.width, one.width, 5e-3 * one.width);
  }
}

TEST(Entries, MeetMaterialWhereNothingBeforeHasTakenItOff) {
  Toolpath path;
  path.passes.push_back(PassAlong(Line({20, 20}, {40, 20})));            // in the middle of the stock
  path.passes.push_back(PassAlong(Line({30, 20}, {30, 40})));            // in the kerf of the first
  path.passes.push_back(PassAlong(Line({-kRadius - 1, 10}, {20, 10})));  // from beside
  path.passes.push_back(PassAlong(Line({50, 20}, {50, 40}), false, 2 * kDepth));  // over the stock
  path.passes.push_back(PassAlong(Line({50, 20}, {50, 40})));
  path.passes.push_back(PassAlong(Line({20 - 1.1 * kRadius, 20}, {5, 20})));  // half over the first's end
  std::vector<size_t> entries;
  size_t number = 0;
  for (const Pass& pass : path.passes) {
    entries.push_back(number);
    number += pass.points.size();
  }
  EXPECT_EQ(MeetsMaterial(Flat(), path, entries), (std::vector<char>{1, 0, 0, 0, 1, 1}));
  // What is not milled stays.
  for (MillingPoint& point : path.passes[0].points) point.gouge = 1;
  EXPECT_EQ(MeetsMaterial(Flat(), path, {entries[1]}), (std::vector<char>{1}));
}

TEST(Engagement, AStatedSideAndWidthTakeTheStocksPlace) {
  Toolpath pass;
  pass.passes.push_back(PassAlong(Line({20, 20}, {40, 20})));
  EngagementOptions options = Flat();
  for (const MillingSide side : {MillingSide::kUp, MillingSide::kDown, MillingSide::kSlot}) {
    options.stated = StatedCut{side, 3};
    SetEngagement(options, 1, {}, pass);
    const Engagement& found = pass.passes[0].points[5].engagement;
    const Cut cut{options.edge.material, 2 * kRadius, 4, kDepth, 3, 20.0 / 400, side, 0.3, 0};
    EXPECT_LT((found.force - MeanCuttingForce(cut).mean).norm(), 5e-3 * found.force.norm());
    EXPECT_NEAR(found.width, side == MillingSide::kSlot ? 10 : 3, 0.02);
  }
  const CuttingForce heaviest = HeaviestCut(options, pass);
  EXPECT_NEAR(heaviest.engaged, 2, 1e-9);
  EXPECT_GT(heaviest.peak, heaviest.mean.norm());
}

// What is worked out beside missing points alone is what all points come to: of lines, a ring and a wall that
// is milled with the cutter's side, above and below one another, of whose points some are missing.
TEST(Engagement, BesideMissingPointsIsThatOfThePathWithoutThem) {
  const EngagementOptions options = Flat();
  std::vector<Vector2d> ring;
  for (int i = 0; i < 40; ++i)
    ring.emplace_back(30 + 12 * std::cos(i * kPi / 20), 22 + 12 * std::sin(i * kPi / 20));
  Toolpath whole;
  for (int i = 0; i < 7; ++i)
    whole.passes.push_back(PassAlong(Line({-3, 3.0 + 6 * i}, {63, 3.0 + 6 * i}), false, 0.5));
  whole.passes.push_back(PassAlong(ring, true));
  whole.passes.push_back(PassAlong(Line({2, 0}, {2, 45}, 1)));
  whole.passes.push_back(PassAlong(Line({58, 45}, {58, 0}, 1)));
  for (MillingPoint& point : whole.passes.back().points) point.normal = {-1, 0, 0};
  SetEngagement(options, 2, {}, whole);
  uint64_t state = 12345;
  const auto draw = [&](uint64_t below) {
    return ((state = state * 6364136223846793005u + 1442695040888963407u) >> 33) % below;
  };
  size_t alike = 0, others = 0;
  for (int trial = 0; trial < 12; ++trial) {
    Toolpath missing = whole;
    for (int run = 0; run < 4; ++run) {
      std::vector<MillingPoint>& points = missing.passes[draw(missing.passes.size())].points;
      const size_t first = draw(points.size()), length = 1 + draw(8);
      for (size_t i = first; i < std::min(points.size(), first + length); ++i) points[i].gouge = 1;
    }
    Toolpath all = missing;
    SetEngagement(options, 2, {}, all);
    SetEngagementBesideMissing(options, 2, {}, missing);
    for (size_t p = 0; p < all.passes.size(); ++p)
      for (size_t i = 0; i < all.passes[p].points.size(); ++i) {
        const Engagement &found = missing.passes[p].points[i].engagement,
                         &plain = all.passes[p].points[i].engagement;
        ASSERT_EQ(found.force, plain.force) << trial << ' ' << p << ' ' << i;
        ASSERT_EQ(found.width, plain.width);
        ASSERT_EQ(found.depth, plain.depth);
        ASSERT_EQ(found.side, plain.side);
        (plain.force == whole.passes[p].points[i].engagement.force ? alike : others) += 1;
      }
  }
  EXPECT_GT(others, 300u);
  EXPECT_GT(alike, 1000u);
}

}  // namespace
}  // namespace millpose
