// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/batch/time_left.hpp"

#include <algorithm>
#include <numeric>

namespace millpose {

std::optional<double> TimeLeft(const BatchState& state) {
  if (state.ended.empty()) return std::nullopt;
  const auto count = static_cast<double>(state.ended.size());
  const double sum = std::accumulate(state.ended.begin(), state.ended.end(), 0.0), mean = sum / count;
  // Those that run already longer than the mean are known to be no shorter: short jobs end first.
  double known = sum;
  for (const double so_far : state.running) known += std::max(so_far, mean);
  const double typical = known / (count + static_cast<double>(state.running.size()));
  std::vector<double> places;  // when each is free
  for (const double so_far : state.running)
    places.push_back(so_far < typical ? typical - so_far : 0.5 * so_far);
  places.resize(std::max({state.places, places.size(), size_t{1}}), 0.0);
  for (size_t job = 0; job < state.waiting; ++job) *std::ranges::min_element(places) += typical;
  return *std::ranges::max_element(places);
}

}  // namespace millpose
