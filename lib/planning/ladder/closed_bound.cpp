// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/closed_bound.hpp"

#include "base/units.hpp"
#include "planning/ladder/returning.hpp"

namespace millpose {
namespace {

/// The nodes of a layer that count, each range those that differ by full revolutions only.
std::vector<NodeRange> RangesOf(const Layer& layer, const std::vector<char>& counted) {
  std::vector<NodeRange> ranges;
  for (size_t node = 0; node < layer.size();) {
    NodeRange range{node, node + 1};
    while (range.second < layer.size() && layer.base[range.second] == layer.base[node]) ++range.second;
    if (std::any_of(counted.begin() + static_cast<std::ptrdiff_t>(range.first),
                    counted.begin() + static_cast<std::ptrdiff_t>(range.second),
                    [](char c) { return c != 0; }))
      ranges.push_back(range);
    node = range.second;
  }
  return ranges;
}

/// The objectives of the nodes from `least` on, ascending.
std::vector<double> ValuesFrom(const LadderProblem& problem, double least) {
  std::vector<double> values;
  for (const Layer& layer : problem.layers)
    for (const double value : layer.objective)
      if (value >= least && value <= problem.most && std::isfinite(value)) values.push_back(value);
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

}  // namespace

bool CanClose(const LadderProblem& problem) {
  NodeMask counted(problem.layers.size());
  size_t fewest = 0;
  std::ptrdiff_t least = std::numeric_limits<std::ptrdiff_t>::max();
  for (size_t t = 0; t < counted.size(); ++t) {
    for (const double value : problem.layers[t].objective)
      counted[t].push_back(std::isfinite(value) && value <= problem.most);
    const std::ptrdiff_t count = std::ranges::count(counted[t], 1);
    if (count < least) least = count, fewest = t;
  }
  if (least == 0) return false;
  LadderProblem from_there = problem;
  from_there.first_layer = fewest;
  return AnyReturning(from_there, RangesOf(problem.layers[fewest], counted[fewest]), counted);
}

double LeastClosedBound(const LadderProblem& problem, double none_below) {
  double least = none_below;  // no sequence is better than the best node of any layer
  for (const Layer& layer : problem.layers)
    least = std::max(least, layer.size() == 0 ? kInfinity : *std::ranges::min_element(layer.objective));
  if (!std::isfinite(least)) return kInfinity;
  const std::vector<double> values = ValuesFrom(problem, least);
  const auto closes = [&](size_t at) {
    LadderProblem bounded = problem;
    bounded.most = values[at];
    return CanClose(bounded);
  };
  // Up in ever larger strides, since a bound that rises rises little; then between the last two.
  size_t low = 0, high = 0;  // none below `low`
  for (size_t stride = 1; high < values.size() && !closes(high); stride *= 4) {
    low = high + 1;
    if (low == values.size()) return kInfinity;
    high = std::min(high + stride, values.size() - 1);
  }
  if (values.empty()) return kInfinity;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (closes(middle))
      high = middle;
    else
      low = middle + 1;
  }
  return values[high];
}

}  // namespace millpose
