// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/rounding.hpp"

#include <limits>

namespace millpose {
namespace {

constexpr double kSteps = 1e4;         // per mm, as texts state it
constexpr double kLeast = 1 / kSteps;  // mm

/// Whether motion i ends in a corner that is rounded.
bool IsRounded(const MotionProgram& program, size_t i) {
  const std::vector<Motion>& motions = program.motions;
  return i > 0 && i + 1 < motions.size() && motions[i].type == MotionType::kLinear && !motions[i].exact &&
         motions[i + 1].type == MotionType::kLinear;
}

/// A corner of a piece: at which distances it may be rounded, and at which it is as round as it can be.
struct Wanted {
  size_t motion;
  double most;   ///< mm; infinite where half of the shorter motion is within tolerance
  double whole;  ///< mm; beyond it nothing changes
};

/// The corners of motions first..last−1.
std::vector<Wanted> CornersOf(const MotionProgram& program, size_t first, size_t last,
                              const PathTolerance& tolerance) {
  const std::vector<Motion>& motions = program.motions;
  std::vector<Wanted> corners;
  for (size_t i = first; i < last; ++i) {
    if (!IsRounded(program, i)) continue;
    const Corner corner = CornerBetween(motions[i - 1].X_PT, motions[i].X_PT, motions[i + 1].X_PT);
    const double reach = LargestReach(corner, tolerance);
    const bool bounded = reach < corner.shorter / 2;
    corners.push_back({i, bounded ? reach : std::numeric_limits<double>::infinity(), reach});
  }
  return corners;
}

/// Distances in as few steps as give every corner at least half of what it could have.
void SetDistances(std::vector<Motion>& motions, const std::vector<Wanted>& corners) {
  double longest = 0;
  for (const Wanted& corner : corners) longest = std::max(longest, corner.whole);
  for (size_t begin = 0; begin < corners.size();) {
    double most = longest, whole = 0;
    size_t end = begin;
    for (; end < corners.size(); ++end) {
      const double less = std::min(most, corners[end].most), more = std::max(whole, corners[end].whole);
      if (end > begin && 2 * less < more) break;
      most = less;
      whole = more;
    }
    const double distance = std::max(kLeast, std::floor(most * kSteps) / kSteps);
    for (; begin < end; ++begin) motions[corners[begin].motion].blend = distance;
  }
}

}  // namespace

void ChooseRounding(MotionProgram& program, const PathTolerance& tolerance) {
  program.blend_is_distance = true;
  std::vector<Motion>& motions = program.motions;
  for (size_t first = 0; first < motions.size();) {
    size_t last = first + 1;
    while (last < motions.size() && motions[last].type == motions[first].type) ++last;
    for (size_t i = first; i < last; ++i) motions[i].blend = 0;
    if (motions[first].type == MotionType::kLinear)
      SetDistances(motions, CornersOf(program, first, last, tolerance));
    first = last;
  }
}

}  // namespace millpose
