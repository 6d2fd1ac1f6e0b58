// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/branch_ladder.hpp"

#include <map>

#include "tests/planning/pose/problems.hpp"

namespace millpose {
namespace {

constexpr int kNear = 6;  // settings between neighbours

/// Breaks, worst objective.
using Cost = std::pair<size_t, double>;

/// What a pass costs at least, over the points that have a pose.
struct Least {
  Cost cost;
  size_t points = 0;
};

/// Whether anything stands in the way of a rotation at a point: drawn, `in` of a hundred.
bool IsFree(size_t t, double rotation, int in) {
  RandomStream random(static_cast<uint64_t>(std::lround(RadToDeg(rotation)) + 360), t);
  return random.Below(100) >= in;
}

/// The least cost of a pass on a branch: every setting of a point against every one of the point before.
std::optional<Least> LeastCost(const AdmissibleBounds& bounds, const std::vector<CandidateTable>& tables,
                               int branch, int in) {
  using Node = std::pair<const CandidateTable::Entry*, Cost>;
  const auto leads = [&](const CandidateTable::Entry& a, const CandidateTable::Entry& b, int count) {
    const int apart = std::abs(static_cast<int>(a.setting) - static_cast<int>(b.setting));
    if (std::min(apart, count - apart) > kNear) return false;
    for (int j = 0; j < 6; ++j)
      if (std::abs(a.q[j] - b.q[j]) > kPi && bounds.upper[j] - bounds.lower[j] < 3 * kPi) return false;
    return true;
  };
  std::vector<Node> before;
  size_t points = 0;
  for (size_t t = 0; t < tables.size(); ++t) {
    std::vector<Node> now;
    for (const CandidateTable::Entry& entry : tables[t].entries()) {
      if (entry.branch != branch || !IsFree(t, tables[t].Setting(entry.setting)[0], in)) continue;
      std::optional<Cost> least;
      for (const auto& [from, cost] : before) {
        auto [breaks, worst] = cost;
        breaks += leads(*from, entry, static_cast<int>(tables[t].settings())) ? 0 : 1;
        const Cost here{breaks, std::max(worst, entry.objective)};
        if (!least || here < *least) least = here;
      }
      now.emplace_back(&entry, before.empty() ? Cost{0, entry.objective} : *least);
    }
    if (now.empty()) continue;  // left out
    before = std::move(now);
    ++points;
  }
  if (before.empty()) return std::nullopt;
  return Least{std::ranges::min(before, {}, &Node::second).second, points};
}

TEST(BranchLadder, IsTheBestOfAllWaysThatNothingBars) {
  std::map<bool, int> broken;
  for (const double wrist : {0.05, 0.6}) {
    PoseProblem problem = MakeProblem(Kr500R2830());
    problem.bounds.wrist_min = wrist;
    for (const int j : {3, 5})  // of axes that go round once at most
      problem.bounds.lower[j] = -kPi, problem.bounds.upper[j] = kPi;
    std::vector<CandidateTable> tables;
    for (int t = 0; t < 9; ++t)
      tables.push_back(CandidateTable::OfStep(
          PointScorer(problem, PanelPoint(-320 + 80 * t, 70 * (t % 3)), Eigen::Vector3d::UnitZ()),
          DegToRad(5)));
    const std::array<BranchScore, 8> promises = PromisesOf(tables);
    for (const int in : {0, 50, 80, 93})
      for (int branch = 0; branch < 8; ++branch) {
        BranchLadder ladder(problem.bounds, tables, static_cast<size_t>(branch));
        EXPECT_FALSE(IsBetter(ladder.Bound(), promises[static_cast<size_t>(branch)])) << branch;
        EXPECT_EQ(promises[static_cast<size_t>(branch)].free > 0, ladder.Bound().free > 0) << branch;
        const BranchScore found = ladder.Score(
            {[&](size_t t, const Joints&, const FreedomValues& at) { return IsFree(t, at[0], in); },
             [](size_t, const Joints&) { return true; }},
            std::nullopt);
        const std::optional<Least> least = LeastCost(problem.bounds, tables, branch, in);
        if (!least) {
          EXPECT_EQ(found.free, 0u);
          continue;
        }
        const auto& [breaks, worst] = least->cost;
        EXPECT_EQ(found.free, least->points - breaks) << branch << " " << in;
        ++broken[breaks > 0];
        if (breaks > 0) continue;  // of points after a break no objective is told
        EXPECT_EQ(found.worst, worst) << branch << " " << in;
      }
  }
  EXPECT_GT(broken[false], 5);
  EXPECT_GT(broken[true], 2);
}

}  // namespace
}  // namespace millpose
