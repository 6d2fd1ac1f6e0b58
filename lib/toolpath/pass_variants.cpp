// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/pass_variants.hpp"

#include <algorithm>

namespace millpose {
namespace {

/// Lays points between two others; their arc lengths share what lies between those.
void Insert(const MillingPoint& from, const MillingPoint& to, double way,
            const std::vector<const MillingPoint*>& between, Pass& pass) {
  std::vector<double> lengths;
  double sum = 0;
  const MillingPoint* at = &from;
  for (const MillingPoint* next : between)
    lengths.push_back(sum += (next->position - at->position).norm()), at = next;
  sum += (to.position - at->position).norm();
  for (size_t i = 0; i < between.size(); ++i) {
    pass.points.push_back(*between[i]);
    pass.points.back().arc_length = from.arc_length + way * lengths[i] / sum;
  }
}

}  // namespace

void ReversePass(double length, MillingPoint& point) {
  point.arc_length = length - point.arc_length;
  point.feed = -point.feed;
  if (point.kind != PointKind::kCut)
    point.kind = point.kind == PointKind::kLeadIn ? PointKind::kLeadOut : PointKind::kLeadIn;
}

Pass RunFromEnd(const Pass& pass) {
  Pass turned = pass;
  std::ranges::reverse(turned.points);
  if (turned.points.empty()) return turned;
  const double length = turned.points.front().arc_length;
  for (MillingPoint& point : turned.points) ReversePass(length, point);
  return turned;
}

Pass WithPointsBetween(const Pass& laid, const Pass& finer, const std::vector<char>& between) {
  const size_t count = laid.points.size();
  Pass pass = laid;
  pass.points.clear();
  size_t at = 0;
  for (size_t t = 0; t < count; ++t) {
    const MillingPoint& from = laid.points[t];
    if (at >= finer.points.size() || !IsSamePlace(finer.points[at], from)) return laid;
    pass.points.push_back(from);
    ++at;
    if (t + 1 == count && !laid.closed) break;
    const MillingPoint& to = laid.points[(t + 1) % count];
    std::vector<const MillingPoint*> inner;
    for (; at < finer.points.size() && !IsSamePlace(finer.points[at], to); ++at)
      if (between[t] != 0 && finer.points[at].gouge == 0) inner.push_back(&finer.points[at]);
    const double way = t + 1 < count ? to.arc_length - from.arc_length : (to.position - from.position).norm();
    Insert(from, to, way, inner, pass);
  }
  return at == finer.points.size() ? pass : laid;
}

}  // namespace millpose
