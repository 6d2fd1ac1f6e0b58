// SPDX-License-Identifier: GPL-3.0-or-later
#include "placement/sample.hpp"

#include <algorithm>

namespace millpose {
namespace {

constexpr size_t kOfPass = 3;

/// `count` of `size` things, evenly, the first and the last among them.
std::vector<size_t> Evenly(size_t size, size_t count) {
  std::vector<size_t> taken;
  if (count >= size) count = size;
  for (size_t i = 0; i < count; ++i) taken.push_back(count == 1 ? size / 2 : i * (size - 1) / (count - 1));
  return taken;
}

}  // namespace

Toolpath SampleOf(const Toolpath& toolpath, size_t count) {
  std::vector<Pass> passes;
  for (const Pass& pass : toolpath.passes) {
    Pass cuts{.points = {}, .closed = pass.closed, .rotation_reference = pass.rotation_reference};
    for (const MillingPoint& point : pass.points)
      if (point.kind == PointKind::kCut && point.gouge <= 0) cuts.points.push_back(point);
    if (!cuts.points.empty()) passes.push_back(std::move(cuts));
  }
  const std::vector<size_t> taken = Evenly(passes.size(), std::max<size_t>(1, count / kOfPass));
  size_t points = 0;
  for (const size_t i : taken) points += passes[i].points.size();
  Toolpath sample;
  for (const size_t i : taken) {
    const Pass& pass = passes[i];
    const size_t share = (count * pass.points.size() + points - 1) / points;
    Pass cuts{.points = {}, .closed = pass.closed, .rotation_reference = pass.rotation_reference};
    for (const size_t k : Evenly(pass.points.size(), std::max(std::min(count, kOfPass), share)))
      cuts.points.push_back(pass.points[k]);
    sample.passes.push_back(std::move(cuts));
  }
  return sample;
}

}  // namespace millpose
