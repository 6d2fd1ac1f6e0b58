// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/sample.hpp"

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

/// Appends the stretches of a pass whose points lie in the share.
void AddStretches(const Pass& pass, const PathSection& share, std::vector<Pass>& passes) {
  const size_t before = passes.size();
  bool goes_on = false;
  for (const MillingPoint& point : pass.points) {
    const double at = share.direction.dot(point.position);
    const bool in = at >= share.Least() && at <= share.Most();
    if (in && !goes_on)
      passes.push_back({.points = {}, .closed = false, .rotation_reference = pass.rotation_reference});
    if (in) passes.back().points.push_back(point);
    goes_on = in;
  }
  if (passes.size() > before && passes.back().points.size() == pass.points.size())
    passes.back().closed = pass.closed;
}

}  // namespace

Toolpath Shared(const Toolpath& toolpath, const PathSection& share) {
  Toolpath shared;
  for (const Pass& pass : toolpath.passes) {
    if (!pass.whole)
      AddStretches(pass, share, shared.passes);
    else if (!pass.points.empty() && share.Owns(pass.points.front().position))
      shared.passes.push_back(pass);
  }
  return shared;
}

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
