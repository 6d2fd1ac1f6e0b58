// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/split.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "base/random.hpp"
#include "run/placement/sample.hpp"

namespace millpose {
namespace {

struct Case {
  std::vector<double> along, seams;
  std::vector<std::vector<ScoredPoint>> rows;
  double overlap = 0;

  SplitProblem Problem() const { return {along, rows, seams, overlap}; }
};

/// Places that each reach a stretch of the part, worse towards its ends, and some points nobody knows why
/// not.
Case Drawn(uint64_t seed) {
  RandomStream random(seed, 0);
  const auto draw = [&] { return random.Uniform(); };
  Case drawn;
  for (int i = 0; i < 20; ++i) drawn.along.push_back(std::round(1000 * draw()));
  for (int i = 1; i < 8; ++i) drawn.seams.push_back(125 * i);
  drawn.overlap = 60 * draw();
  for (int place = 0; place < 6; ++place) {
    const double middle = 1000 * draw(), reach = 150 + 300 * draw();
    std::vector<ScoredPoint>& row = drawn.rows.emplace_back();
    for (const double at : drawn.along) {
      const bool free = std::abs(at - middle) < reach && draw() > 0.05;
      row.push_back({free ? Infeasibility::kNone : Infeasibility::kUnreachable,
                     free ? 1 + std::abs(at - middle) / reach + 0.2 * draw() : 0});
    }
  }
  return drawn;
}

/// What lies between two seams in a place; none without a point of its own.
std::optional<SplitCost> CostOf(const Case& of, size_t place, double from, double to) {
  SplitCost cost;
  bool own = false;
  for (size_t i = 0; i < of.along.size(); ++i) {
    own = own || (of.along[i] >= from && of.along[i] <= to);
    if (of.along[i] >= from - of.overlap / 2 && of.along[i] <= to + of.overlap / 2)
      cost.Add(of.rows[place][i]);
  }
  return own ? std::optional(cost) : std::nullopt;
}

/// The least of all splits that go on from a seam, tried one by one; `before`: what lies up to there costs.
void TryAll(const Case& of, size_t count, double from, const SplitCost& before,
            std::optional<SplitCost>& least) {
  const double end = std::numeric_limits<double>::infinity();
  for (size_t place = 0; place < of.rows.size(); ++place) {
    if (count == 1) {
      const std::optional<SplitCost> last = CostOf(of, place, from, end);
      if (last && (!least || before + *last < *least)) least = before + *last;
      continue;
    }
    for (const double seam : of.seams)
      if (const std::optional<SplitCost> own = seam > from ? CostOf(of, place, from, seam) : std::nullopt)
        TryAll(of, count - 1, seam, before + *own, least);
  }
}

TEST(BestSplit, IsTheBestOfAllSplits) {
  for (uint64_t seed = 1; seed <= 40; ++seed)
    for (const size_t count : {1, 2, 3}) {
      const Case of = Drawn(seed);
      const std::vector<SplitPart> parts = BestSplit(of.Problem(), count);
      std::optional<SplitCost> least;
      TryAll(of, count, -std::numeric_limits<double>::infinity(), {}, least);
      ASSERT_EQ(parts.size(), count);
      SplitCost cost;
      for (size_t i = 0; i < count; ++i) {
        cost = cost + *CostOf(of, parts[i].place, parts[i].from, parts[i].to);
        EXPECT_EQ(parts[i].from, i == 0 ? -std::numeric_limits<double>::infinity() : parts[i - 1].to);
      }
      EXPECT_EQ(parts.back().to, std::numeric_limits<double>::infinity());
      EXPECT_EQ(cost.missing, least->missing) << seed;
      EXPECT_EQ(cost.worst, least->worst) << seed;
      EXPECT_NEAR(cost.sum / least->sum, 1, 1e-12) << seed;
    }
}

TEST(BestSplit, HasNoneWithMoreStationsThanPlacesForSeams) {
  Case of = Drawn(3);
  of.seams = {500};
  EXPECT_TRUE(BestSplit(of.Problem(), 3).empty());
  EXPECT_EQ(BestSplit(of.Problem(), 2).size(), 2U);
}

TEST(Shared, HoldsEveryPointOnceOrMore) {
  Toolpath path;
  for (const bool closed : {false, true}) {
    Pass pass;
    pass.closed = closed;
    for (int i = 0; i < 40; ++i) {
      MillingPoint point;
      point.position = {std::abs(20.0 - i), 1.0 * i, 0};
      pass.points.push_back(point);
    }
    path.passes.push_back(pass);
  }
  Pass hole = path.passes.front();
  hole.whole = true;
  hole.points.resize(3);
  path.passes.push_back(hole);
  const auto count = [](const Toolpath& of) {
    size_t points = 0;
    for (const Pass& pass : of.passes) points += pass.points.size();
    return points;
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Toolpath lower = Shared(path, {x, -1e9, 10.5, 0}), upper = Shared(path, {x, 10.5, 1e9, 0});
  EXPECT_EQ(count(lower) + count(upper), count(path));
  EXPECT_EQ(count(Shared(path, {x, -1e9, 10.5, 4})), count(lower) + 8);
  EXPECT_EQ(count(Shared(path, {x, 10.5, 1e9, 4})), count(upper) + 8);
  const Toolpath all = Shared(path, {x, -1e9, 1e9, 0});
  ASSERT_EQ(all.passes.size(), 3U);
  EXPECT_TRUE(all.passes[1].closed);
  EXPECT_FALSE(lower.passes[1].closed);
}

}  // namespace
}  // namespace millpose
