// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/spread.hpp"

#include <set>

namespace millpose {
namespace {

int CountFor(double length, double stepover) {
  return std::max(1, static_cast<int>(std::ceil(length / stepover - 1e-9)));
}

}  // namespace

std::vector<double> SpreadEvenly(double lower, double upper, double stepover) {
  const int count = CountFor(upper - lower, stepover);
  std::vector<double> positions;
  for (int i = 0; i < count; ++i) positions.push_back(lower + (i + 0.5) * ((upper - lower) / count));
  return positions;
}

std::vector<double> SpreadOnSurface(const std::vector<Stretch>& stretches, double lower, double upper,
                                    double stepover) {
  constexpr double kMaxSlope = 20;
  struct Event {
    double at, slope;
    bool begins;
  };
  std::vector<Event> events;
  for (const Stretch& stretch : stretches) {
    const double from = std::max(stretch.lower, lower), to = std::min(stretch.upper, upper);
    if (from >= to) continue;
    const double slope = std::clamp(stretch.slope, 1.0, kMaxSlope);
    events.push_back({from, slope, true});
    events.push_back({to, slope, false});
  }
  std::ranges::sort(events, [](const Event& a, const Event& b) {
    return std::tie(a.at, a.begins, a.slope) < std::tie(b.at, b.begins, b.slope);
  });
  // Lengths on the surface up to each position; where there is no surface, positions pass for free.
  std::vector<std::pair<double, double>> ways{{lower, 0.0}};
  std::multiset<double> slopes;
  for (const Event& event : events) {
    const auto [at, way] = ways.back();
    if (event.at > at)
      ways.emplace_back(event.at, way + (slopes.empty() ? 0.0 : *slopes.rbegin() * (event.at - at)));
    if (event.begins) {
      slopes.insert(event.slope);
    } else {
      slopes.erase(slopes.find(event.slope));
    }
  }
  const double total = ways.back().second;
  const int count = CountFor(total, stepover);
  std::vector<double> positions;
  size_t k = 1;
  for (int i = 0; i < count && total > 0; ++i) {
    const double wanted = (i + 0.5) * total / count;
    while (k + 1 < ways.size() && ways[k].second < wanted) ++k;
    const auto& [a, from] = ways[k - 1];
    const auto& [b, to] = ways[k];
    positions.push_back(a + (wanted - from) / (to - from) * (b - a));
  }
  return positions;
}

double StepoverForScallop(double radius, double height) {
  return height < radius ? 2 * std::sqrt(2 * radius * height - height * height) : 2 * radius;
}

}  // namespace millpose
