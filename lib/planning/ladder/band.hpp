// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes of a neighbouring layer that a step can come from or go to.
#pragma once

#include <algorithm>

#include "base/units.hpp"
#include "planning/ladder/layer.hpp"

namespace millpose {

/// Nodes of a layer: the first, and one beyond the last.
using NodeRange = std::pair<size_t, size_t>;

/// What of one layer steps reach from, as its nodes stand when this is made. Quick when it is asked in the
/// order of the first freedom.
class BandOfLayer {
 public:
  /// `band`: rad, how far apart the first freedoms of two nodes may lie. `walls`: as LadderProblem says.
  BandOfLayer(const Layer& layer, double band, bool walls) : layer_(layer), band_(band), walls_(walls) {
    if (walls && std::ranges::any_of(layer.objective, IsWall)) FindWalls();
  }

  /// The ranges of nodes (first, one beyond the last) of `lane` whose first freedom lies within the band
  /// about `value`: about it as it stands, and round the turn either way, where that gives other nodes. Empty
  /// ones have first = last.
  std::array<NodeRange, 3> RangesFrom(int lane, double value) {
    const size_t from = layer_.lane_begin[lane], to = layer_.lane_begin[lane + 1];
    std::array<NodeRange, 3> ranges{};
    if (band_ >= kPi && !walls_) {
      ranges[0] = {from, to};
      return ranges;
    }
    const auto part = [&](double middle, Places& places) {
      size_t first = places.first = Seek(places.first, from, to, middle - band_, std::less<>());
      size_t last = places.last = Seek(places.last, from, to, middle + band_, std::less_equal<>());
      if (!left_.empty()) {
        // Reached without leaping over what was pruned; from within a blocked stretch, from both its sides.
        const size_t at = places.at = Seek(places.at, from, to, middle, std::less<>());
        first = std::max(first, left_[at]);
        last = std::min(last, right_[at]);
      }
      return NodeRange{first, std::max(first, last)};
    };
    ranges[0] = part(value, places_[0]);
    const auto [first, last] = ranges[0];
    if (value - band_ < -kPi) {
      NodeRange& above = ranges[1] = part(value + 2 * kPi, places_[1]);
      if (first <= above.first) above = {std::max(above.first, last), std::max(above.second, last)};
    }
    if (value + band_ > kPi) {
      NodeRange& below = ranges[2] = part(value - 2 * kPi, places_[2]);
      if (below.second <= last) below = {std::min(below.first, first), std::min(below.second, first)};
    }
    return ranges;
  }

  /// Calls `visit(first, last)` for each of these ranges that is not empty.
  template <typename Visit>
  void VisitFrom(int lane, double value, const Visit& visit) {
    for (const auto& [first, last] : RangesFrom(lane, value))
      if (first < last) visit(first, last);
  }

 private:
  static bool IsWall(double objective) { return !std::isfinite(objective); }

  /// Where the last question of one turn was answered.
  struct Places {
    size_t first = 0, last = 0, at = 0;
  };

  /// The first of the nodes begin..end−1 that is not `less` than `value`, looked for from `place` on.
  template <typename Less>
  size_t Seek(size_t place, size_t begin, size_t end, double value, const Less& less) const {
    place = std::clamp(place, begin, end);
    while (place > begin && !less(layer_.first[place - 1], value)) --place;
    while (place < end && less(layer_.first[place], value)) ++place;
    return place;
  }

  /// How far one gets from the place before each node, to either side.
  void FindWalls() {
    const size_t count = layer_.size();
    const auto blocked = [&](size_t node) { return IsWall(layer_.objective[node]); };
    left_.assign(count + 1, 0);
    right_.assign(count + 1, count);
    size_t run = 0;  // where the free stretch begins that ends last
    for (size_t k = 0; k < count; ++k) {
      if (!blocked(k) && (k == 0 || blocked(k - 1))) run = k;
      left_[k + 1] = run;
    }
    run = count;
    for (size_t k = count; k-- > 0;) {
      if (!blocked(k) && (k + 1 == count || blocked(k + 1))) run = k + 1;
      right_[k] = run;
    }
  }

  const Layer& layer_;
  double band_;
  bool walls_;
  std::array<Places, 3> places_;
  std::vector<size_t> left_, right_;  ///< empty without walls
};

}  // namespace millpose
