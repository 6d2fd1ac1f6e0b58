// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/split.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

namespace millpose {
namespace {

struct Choice {
  SplitCost cost;
  size_t place = 0;
};

/// How costs are compared. The worst value of a split is its worst part's, so that the other parts are free
/// to be worse than they need for the sake of a sum: once it is known what the worst must be, `most`, the sum
/// decides between parts that are no worse.
struct Measure {
  std::optional<double> most;

  bool Allows(const SplitCost& cost) const { return !most || cost.worst <= *most; }
  bool Less(const SplitCost& a, const SplitCost& b) const {
    return most ? std::tie(a.missing, a.sum) < std::tie(b.missing, b.sum) : a < b;
  }
};

/// The best place for what lies between any two of the edges (the part's ends and the seams between).
class SpanTable {
 public:
  SpanTable(const SplitProblem& problem, const Measure& measure)
      : problem_(problem), measure_(measure), order_(problem.along.size()) {
    const double end = std::numeric_limits<double>::infinity();
    edges_.push_back(-end);
    edges_.insert(edges_.end(), problem.seams.begin(), problem.seams.end());
    edges_.push_back(end);
    std::iota(order_.begin(), order_.end(), size_t{0});
    std::ranges::stable_sort(order_, {}, [&](size_t i) { return problem.along[i]; });
    best_.resize(edges_.size() * edges_.size());
    for (size_t from = 0; from + 1 < edges_.size(); ++from)
      for (size_t place = 0; place < problem.rows.size(); ++place) Sweep(from, place);
  }

  const std::vector<double>& edges() const { return edges_; }
  const std::optional<Choice>& At(size_t from, size_t to) const { return best_[from * edges_.size() + to]; }

 private:
  double At(size_t rank) const { return problem_.along[order_[rank]]; }

  /// From one edge to all behind it, in one place.
  void Sweep(size_t from, size_t place) {
    const std::vector<ScoredPoint>& points = problem_.rows[place];
    size_t rank = 0;
    while (rank < order_.size() && At(rank) < edges_[from] - problem_.overlap / 2) ++rank;
    size_t own = rank;  // the first that is no neighbour's
    while (own < order_.size() && At(own) < edges_[from]) ++own;
    SplitCost cost;
    for (size_t to = from + 1; to < edges_.size(); ++to) {
      for (; rank < order_.size() && At(rank) <= edges_[to] + problem_.overlap / 2; ++rank)
        cost.Add(points[order_[rank]]);
      if (own == order_.size() || At(own) > edges_[to]) continue;
      std::optional<Choice>& best = best_[from * edges_.size() + to];
      if (measure_.Allows(cost) && (!best || measure_.Less(cost, best->cost))) best = Choice{cost, place};
    }
  }

  const SplitProblem& problem_;
  const Measure& measure_;
  std::vector<double> edges_;
  std::vector<size_t> order_;
  std::vector<std::optional<Choice>> best_;
};

/// Up to an edge in so many parts: what that costs, and where the last of them begins.
struct Reached {
  SplitCost cost;
  size_t from = 0;
};

struct Split {
  SplitCost cost;
  std::vector<SplitPart> parts;  ///< empty where there is none
};

Split Cheapest(const SplitProblem& problem, size_t count, const Measure& measure) {
  const SpanTable spans(problem, measure);
  const size_t edges = spans.edges().size();
  std::vector<std::vector<std::optional<Reached>>> reached(count + 1,
                                                           std::vector<std::optional<Reached>>(edges));
  reached[0][0] = Reached{};
  for (size_t n = 0; n < count; ++n)
    for (size_t from = 0; from < edges; ++from) {
      if (!reached[n][from]) continue;
      for (size_t to = from + 1; to < edges; ++to) {
        if (!spans.At(from, to)) continue;
        const SplitCost cost = reached[n][from]->cost + spans.At(from, to)->cost;
        std::optional<Reached>& best = reached[n + 1][to];
        if (!best || measure.Less(cost, best->cost)) best = Reached{cost, from};
      }
    }
  Split split;
  if (!reached[count][edges - 1]) return split;
  split.cost = reached[count][edges - 1]->cost;
  for (size_t n = count, to = edges - 1; n > 0; --n) {
    const size_t from = reached[n][to]->from;
    split.parts.push_back({spans.At(from, to)->place, spans.edges()[from], spans.edges()[to]});
    to = from;
  }
  std::ranges::reverse(split.parts);
  return split;
}

}  // namespace

void SplitCost::Add(const ScoredPoint& point) {
  if (point.obstacle != Infeasibility::kNone) {
    ++missing;
    return;
  }
  worst = std::max(worst, point.objective);
  sum += point.objective;
}

SplitCost SplitCost::operator+(const SplitCost& other) const {
  return {missing + other.missing, std::max(worst, other.worst), sum + other.sum};
}

std::vector<SplitPart> BestSplit(const SplitProblem& problem, size_t count) {
  const Split least = Cheapest(problem, count, {});
  if (least.parts.empty()) return {};
  return Cheapest(problem, count, {least.cost.worst}).parts;
}

}  // namespace millpose
