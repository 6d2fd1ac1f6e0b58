// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/spread.hpp"

#include <set>

namespace millpose {

PassScale::PassScale(const std::vector<Stretch>& stretches, double lower, double upper)
    : ways_{{lower, 0.0}} {
  struct Event {
    double at, density;
    bool begins;
  };
  std::vector<Event> events;
  for (const Stretch& stretch : stretches) {
    const double from = std::max(stretch.lower, lower), to = std::min(stretch.upper, upper);
    if (from >= to) continue;
    events.push_back({from, stretch.density, true});
    events.push_back({to, stretch.density, false});
  }
  std::ranges::sort(events, [](const Event& a, const Event& b) {
    return std::tie(a.at, a.begins, a.density) < std::tie(b.at, b.begins, b.density);
  });
  std::multiset<double> densities;
  for (const Event& event : events) {
    const auto [at, way] = ways_.back();
    if (event.at > at)
      ways_.emplace_back(event.at, way + (densities.empty() ? 0.0 : *densities.rbegin() * (event.at - at)));
    if (event.begins) {
      densities.insert(event.density);
    } else {
      densities.erase(densities.find(event.density));
    }
  }
}

int PassScale::count() const { return std::max(1, static_cast<int>(std::ceil(total() - 1e-9))); }

double PassScale::PassesAt(double position) const {
  const auto above = std::ranges::upper_bound(ways_, position, {}, &std::pair<double, double>::first);
  if (above == ways_.begin() || total() == 0) return 0;
  const auto& [from, passes] = *std::prev(above);
  const double here = above == ways_.end()
                          ? passes
                          : passes + (above->second - passes) * (position - from) / (above->first - from);
  return here * count() / total();
}

double PassScale::PositionAt(double passes) const {
  if (ways_.size() == 1) return ways_[0].first;
  const double wanted = passes * total() / count();
  size_t k = 1;
  while (k + 1 < ways_.size() && ways_[k].second < wanted) ++k;
  const auto& [a, from] = ways_[k - 1];
  const auto& [b, to] = ways_[k];
  return to > from ? a + (wanted - from) / (to - from) * (b - a) : b;
}

std::vector<double> PassScale::Positions() const {
  std::vector<double> positions;
  for (int i = 0; i < count(); ++i) positions.push_back(PositionAt(i + 0.5));
  return positions;
}

std::vector<double> SpreadEvenly(double lower, double upper, double stepover) {
  return PassScale({{lower, upper, 1 / stepover}}, lower, upper).Positions();
}

}  // namespace millpose
