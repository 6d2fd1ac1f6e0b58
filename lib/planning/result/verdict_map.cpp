// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/verdict_map.hpp"

#include <algorithm>
#include <cmath>

namespace millpose {

AxisCell AxisCellOf(double rotation) {
  const double cells = (rotation + kPi) / kAxisStep;
  const double nearest = std::floor(cells + 0.5);
  const int index = static_cast<int>(std::fmod(nearest, kAxisRotations));
  return {index < 0 ? index + kAxisRotations : index, std::abs(cells - nearest) * kAxisStep};
}

std::vector<int> PackVerdicts(const AxisVerdicts& verdicts) {
  std::vector<int> runs;
  for (size_t first = 0; first < verdicts.size();) {
    size_t end = first;
    while (end < verdicts.size() && verdicts[end] == verdicts[first]) ++end;
    if (end < verdicts.size() || verdicts[first] != kVerdictUnknown) {
      runs.push_back(verdicts[first]);
      runs.push_back(static_cast<int>(end - first));
    }
    first = end;
  }
  return runs;
}

AxisVerdicts UnpackVerdicts(const std::vector<int>& runs) {
  constexpr size_t kCells = size_t{8} * kAxisRotations;
  AxisVerdicts verdicts;
  for (size_t i = 0; i + 1 < runs.size(); i += 2) {
    const size_t length = static_cast<size_t>(std::max(0, runs[i + 1]));
    verdicts.insert(verdicts.end(), std::min(length, kCells - verdicts.size()), runs[i]);
  }
  verdicts.resize(kCells, kVerdictUnknown);
  return verdicts;
}

}  // namespace millpose
