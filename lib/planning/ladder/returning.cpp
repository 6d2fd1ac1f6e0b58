// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/returning.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "planning/ladder/mask_kernel.hpp"

namespace millpose {
namespace {

constexpr size_t kBits = 64;  // of a mask

/// The steps from one layer into nodes of the next.
class MaskSteps {
 public:
  MaskSteps(const LadderProblem& problem, size_t from, size_t to, const MaskRow& row)
      : source_(problem.layers[from]),
        target_(problem.layers[to]),
        rule_(problem.RuleFrom(from)),
        band_(source_, BandBetween(problem, rule_, source_, target_), problem.walls),
        row_(row) {
    if (!problem.blocked.empty()) blocked_ = &problem.blocked[from];
    if (blocked_)
      for (const auto& [before, node] : *blocked_) barred_.insert(node);
  }

  /// Of the nodes of a lane that `counts` says so of, from which ranges they are reached.
  template <typename Counts>
  void Into(size_t lane, const Counts& counts, std::vector<Mask>& reached) {
    const size_t first = target_.lane_begin[lane], last = target_.lane_begin[lane + 1];
    if (!row_.Any(source_.lane_begin[lane], source_.lane_begin[lane + 1])) return;
    for (size_t begin = first / kBlock * kBlock; begin < last; begin += kBlock) {
      MaskTargets targets;
      targets.nodes = &target_.joints;
      targets.begin = begin;
      std::array<std::array<NodeRange, 3>, kBlock> ranges{};
      bool some = false;
      for (size_t node = std::max(begin, first); node < std::min(begin + kBlock, last); ++node) {
        if (!counts(node)) continue;
        ranges[node - begin] = band_.RangesFrom(static_cast<int>(lane), target_.first[node]);
        some = true;
      }
      for (size_t part = 0; some && part < 3; ++part) {
        for (size_t l = 0; l < kBlock; ++l) std::tie(targets.first[l], targets.last[l]) = ranges[l][part];
        ReachBlock(rule_, source_.joints, row_, targets);
      }
      for (size_t node = std::max(begin, first); node < std::min(begin + kBlock, last); ++node)
        reached[node] = barred_.contains(node) ? ReachUnbarred(node, ranges[node - begin])
                                               : targets.reached[node - begin];
    }
  }

 private:
  /// Rare: some way into the node is barred, so they are looked at one by one.
  Mask ReachUnbarred(size_t node, const std::array<NodeRange, 3>& ranges) const {
    const Joints q = target_.joints.At(node);
    Mask reached = 0;
    for (const auto& [first, last] : ranges)
      for (size_t k = first; k < last; ++k)
        if ((row_.masks[k] & ~reached) != 0 && std::isfinite(StepCost(rule_, source_.joints.At(k), q)) &&
            !blocked_->contains({k, node}))
          reached |= row_.masks[k];
    return reached;
  }

  const Layer &source_, &target_;
  StepRule rule_;
  BandOfLayer band_;
  const BlockedEdges* blocked_ = nullptr;
  std::set<size_t> barred_;  ///< nodes into which some way is
  const MaskRow& row_;
};

class MaskSweep {
 public:
  MaskSweep(const LadderProblem& problem, const NodeMask& counted) : problem_(problem), counted_(counted) {}

  /// Which of at most 64 ranges are come back to.
  Mask Run(std::span<const NodeRange> ranges) const {
    const size_t count = problem_.layers.size();
    std::vector<Mask> start(problem_.layers[problem_.first_layer].size(), 0);
    for (size_t i = 0; i < ranges.size(); ++i)
      for (size_t node = ranges[i].first; node < ranges[i].second; ++node)
        if (Counts(problem_.first_layer, node)) start[node] |= Mask{1} << i;
    MaskRow row(start);
    std::vector<Mask> reached;
    for (size_t t = 0; t < count; ++t) {
      CheckStop(problem_.stop);
      const size_t from = (problem_.first_layer + t) % count, to = (from + 1) % count;
      if (!row.Any(0, problem_.layers[from].size())) return 0;
      MaskSteps steps(problem_, from, to, row);
      reached.assign(problem_.layers[to].size(), 0);
      for (size_t lane = 0; lane + 1 < problem_.layers[to].lane_begin.size(); ++lane)
        steps.Into(
            lane, [&](size_t node) { return Counts(to, node); }, reached);
      row.Set(reached);
    }
    Mask returning = 0;
    for (size_t node = 0; node < start.size(); ++node) returning |= start[node] & row.masks[node];
    return returning;
  }

 private:
  bool Counts(size_t layer, size_t node) const {
    const double objective = problem_.layers[layer].objective[node];
    return std::isfinite(objective) && objective <= problem_.most &&
           (counted_.empty() || counted_[layer][node] != 0);
  }

  const LadderProblem& problem_;
  const NodeMask& counted_;
};

}  // namespace

std::vector<char> AreReturning(const LadderProblem& problem, const std::vector<NodeRange>& ranges,
                               const NodeMask& counted) {
  const MaskSweep sweep(problem, counted);
  std::vector<char> returning(ranges.size(), 0);
  for (size_t first = 0; first < ranges.size(); first += kBits) {
    const size_t size = std::min(kBits, ranges.size() - first);
    const Mask mask = sweep.Run(std::span(ranges).subspan(first, size));
    for (size_t i = 0; i < size; ++i) returning[first + i] = static_cast<char>((mask >> i) & 1);
  }
  return returning;
}

size_t CountLanes(const LadderProblem& problem) { return problem.layers[0].lane_begin.size() - 1; }

ReturningNodes FindReturning(LadderProblem problem, size_t lane) {
  if (std::ranges::any_of(problem.break_before, [](char lifted) { return lifted != 0; })) return {};
  const auto counts = [&](double objective) { return std::isfinite(objective) && objective <= problem.most; };
  std::ptrdiff_t fewest = std::numeric_limits<std::ptrdiff_t>::max();
  for (size_t t = 0; t < problem.layers.size() && fewest > 0; ++t) {
    const Layer& layer = problem.layers[t];
    const auto begin = layer.objective.begin();
    const std::ptrdiff_t count =
        std::count_if(begin + static_cast<std::ptrdiff_t>(layer.lane_begin[lane]),
                      begin + static_cast<std::ptrdiff_t>(layer.lane_begin[lane + 1]), counts);
    if (count < fewest) fewest = count, problem.first_layer = t;
  }
  const Layer& layer = problem.layers[problem.first_layer];
  std::vector<NodeRange> ranges;
  for (size_t node = layer.lane_begin[lane]; node < layer.lane_begin[lane + 1]; ++node) {
    if (!counts(layer.objective[node])) continue;
    if (!ranges.empty() && layer.base[ranges.back().first] == layer.base[node])
      ranges.back().second = node + 1;
    else
      ranges.emplace_back(node, node + 1);
  }
  ReturningNodes found{problem.first_layer, {}};
  const NodeMask all;
  const MaskSweep sweep(problem, all);
  for (size_t first = 0; first < ranges.size() && found.ranges.empty(); first += kBits) {
    const std::span<const NodeRange> some =
        std::span(ranges).subspan(first, std::min(kBits, ranges.size() - first));
    const Mask mask = sweep.Run(some);
    for (size_t i = 0; i < some.size(); ++i)
      if ((mask >> i & 1) != 0) found.ranges.push_back(some[i]);
  }
  return found;
}

std::vector<double> PossibleBounds(const LadderProblem& problem, double most) {
  double least = 0;
  for (const Layer& layer : problem.layers)
    least = std::max(least, layer.size() == 0 ? kInfinity : std::ranges::min(layer.objective));
  std::vector<double> values;
  for (const Layer& layer : problem.layers)
    for (const double value : layer.objective)
      if (value >= least && value <= most && std::isfinite(value)) values.push_back(value);
  std::ranges::sort(values);
  const auto same = std::ranges::unique(values);
  values.erase(same.begin(), same.end());
  return values;
}

double LeastClosedBound(const LadderProblem& problem) {
  const std::vector<double> values = PossibleBounds(problem, problem.most);
  auto least = values.end();
  for (size_t lane = 0; lane < CountLanes(problem); ++lane) {
    const auto open = [&](double value) {
      LadderProblem within = problem;
      within.most = value;
      return FindReturning(within, lane).ranges.empty();
    };
    if (least == values.begin() || open(*std::prev(least))) continue;
    // Often one point alone bounds the whole.
    least = open(values.front()) ? std::partition_point(values.begin() + 1, std::prev(least), open)
                                 : values.begin();
  }
  return least == values.end() ? kInfinity : *least;
}

}  // namespace millpose
