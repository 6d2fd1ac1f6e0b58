// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "base/units.hpp"
#include "report/html_columns.hpp"
#include "report/html_json.hpp"
#include "report/packed.hpp"

namespace millpose::html {
namespace {

/// (zone, length) bytes, the lengths below 256 as the rotations of a branch are.
void AppendRuns(const std::vector<uint8_t>& zones, size_t row, std::vector<uint8_t>& bytes) {
  for (size_t begin = 0; begin < zones.size(); begin += row) {
    for (size_t first = begin; first < begin + row;) {
      size_t end = first;
      while (end < begin + row && zones[end] == zones[first]) ++end;
      bytes.push_back(zones[first]);
      bytes.push_back(static_cast<uint8_t>(end - first));
      first = end;
    }
  }
}

/// The number of a pair, from 1; 0 where the map does not know it.
uint32_t NumberOf(const AxisMap& map, const std::string& pair) {
  const auto found = std::ranges::find(map.pairs, pair);
  return found == map.pairs.end() ? 0 : static_cast<uint32_t>(found - map.pairs.begin()) + 1;
}

}  // namespace

Json MapJson(const HtmlInput& input, const std::vector<ReportRow>& rows) {
  if (!input.map) return nullptr;
  assert(input.grid.count < 256 && input.map->zones.size() == input.curves.size());
  std::vector<uint8_t> runs;
  std::vector<uint32_t> start;
  for (const std::vector<uint8_t>& zones : input.map->zones) {
    start.push_back(static_cast<uint32_t>(runs.size()));
    AppendRuns(zones, static_cast<size_t>(input.grid.count), runs);
  }
  start.push_back(static_cast<uint32_t>(runs.size()));
  // Where each shown point's own optimum and best free candidate lie, ° and branch, and what bars the former.
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<float> own, free;
  std::vector<uint32_t> branches, barred;
  for (const ReportRow& row : rows) {
    const PassResult& pass = input.plan.passes[static_cast<size_t>(row.pass)];
    const PlannedPoint& point = pass.points[static_cast<size_t>(row.point)];
    barred.push_back(point.barred < 0 ? 0
                                      : NumberOf(*input.map, pass.pairs[static_cast<size_t>(point.barred)]));
    own.push_back(static_cast<float>(point.own_branch < 0 ? none : RadToDeg(point.own_rotation)));
    free.push_back(static_cast<float>(point.free_branch < 0 ? none : RadToDeg(point.free_rotation)));
    branches.push_back(static_cast<uint32_t>((point.own_branch & 15) << 4 | (point.free_branch & 15)));
  }
  return {{"full", input.map->full},          {"pairs", input.map->pairs},   {"runs", Base64(runs)},
          {"start", PackUint32(start)},       {"own_deg", PackFloats(own)},  {"free_deg", PackFloats(free)},
          {"branches", PackUint32(branches)}, {"barred", PackUint32(barred)}};
}

}  // namespace millpose::html
