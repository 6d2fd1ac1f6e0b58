// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/overlap.hpp"

#include <cassert>

namespace millpose {
namespace {

/// Points of a pass by running index; a closed one goes on round, with arc lengths that go on too.
class Round {
 public:
  explicit Round(const Pass& pass) : pass_(pass), count_(static_cast<int>(pass.points.size())) {
    if (pass.closed) {
      around_ = pass.points.back().arc_length - pass.points.front().arc_length +
                (pass.points.front().position - pass.points.back().position).norm();
    }
  }
  bool Has(int index) const { return pass_.closed || (index >= 0 && index < count_); }
  size_t Source(int index) const { return static_cast<size_t>((index % count_ + count_) % count_); }
  MillingPoint At(int index) const {
    MillingPoint point = pass_.points[Source(index)];
    point.arc_length += around_ * std::floor(static_cast<double>(index) / count_);
    return point;
  }

 private:
  const Pass& pass_;
  int count_;
  double around_ = 0;
};

/// How a part grows beyond a split: by points from index `from` on in direction `step`, `length` mm of them
/// but at least one and `most` at most.
struct Growth {
  int split;
  int from, step;
  double length;
  size_t most;
};

/// The repeated points, then the lead beyond the last; outwards from the part that they are added to.
std::vector<SplitPoint> Added(const Round& round, const Growth& growth, const PassEnds& ends,
                              double spacing) {
  const auto& [split, from, step, length, most] = growth;
  std::vector<SplitPoint> added;
  const PointKind kind = step > 0 ? PointKind::kLeadOut : PointKind::kLeadIn;
  const double start = round.Has(from - step) ? round.At(from - step).arc_length : 0;
  for (int i = from; round.Has(i) && added.size() < most; i += step) {
    SplitPoint repeated{round.At(i), round.Source(i), split, false};
    repeated.point.kind = kind;
    const bool enough = std::abs(repeated.point.arc_length - start) >= length;
    added.push_back(std::move(repeated));
    if (enough) break;
  }
  if (added.empty()) return added;
  for (SplitPoint& beyond : LeadBeyond(added.back(), step, ends, spacing)) added.push_back(std::move(beyond));
  return added;
}

}  // namespace

std::vector<SplitPoint> LeadBeyond(const SplitPoint& end, int step, const PassEnds& ends, double spacing) {
  if (ends.lead == LeadShape::kNone) return {};
  PassEnds lead = ends;
  lead.overrun = 0;
  // What is repeated here has been cut: nothing is left to ramp into.
  if (lead.lead == LeadShape::kAlong) lead.lead = LeadShape::kNormal;
  Toolpath path;
  path.passes.push_back(Pass{{end.point}, false, Eigen::Vector3d::UnitZ()});
  AddPassEnds(lead, spacing, path);
  const std::vector<MillingPoint>& points = path.passes[0].points;  // in, the point, out
  const size_t at = points.size() / 2;
  std::vector<SplitPoint> beyond;
  for (size_t k = 1; k <= at; ++k) {
    const size_t from = step > 0 ? at + k : at - k;
    SplitPoint added = end;
    added.point = points[from];
    added.point.kind = step > 0 ? PointKind::kLeadOut : PointKind::kLeadIn;
    added.point.arc_length = end.point.arc_length + (points[from].arc_length - points[at].arc_length);
    added.break_before = false;
    beyond.push_back(std::move(added));
  }
  return beyond;
}

std::vector<SplitPoint> WithOverlaps(const Pass& pass, std::span<const Split> splits, const PassEnds& ends,
                                     double spacing) {
  using By = OverlapChoice::By;
  const Round round(pass);
  const size_t count = pass.points.size();
  const auto grown = [&](size_t split, By by) -> std::vector<SplitPoint> {
    if (splits[split].overlap.by != by) return {};
    const int after = static_cast<int>(splits[split].after);
    const bool seam = splits[split].after + 1 == count;
    // The later part grows backwards from the split, the earlier one forwards.
    const int from = by == By::kEarlier ? after + 1 : seam ? -1 : after;
    const int step = by == By::kEarlier ? 1 : -1;
    return Added(round, {static_cast<int>(split), from, step, splits[split].overlap.length, count - 1}, ends,
                 spacing);
  };
  std::vector<SplitPoint> points;
  bool lifted = false;
  const auto push = [&](SplitPoint point) {
    point.break_before = lifted;
    lifted = false;
    points.push_back(std::move(point));
  };
  const auto enter = [&](size_t split) {
    const std::vector<SplitPoint> added = grown(split, By::kLater);
    std::for_each(added.rbegin(), added.rend(), push);
  };
  if (!splits.empty() && splits.back().after + 1 == count) enter(splits.size() - 1);
  size_t next = 0;
  for (size_t t = 0; t < count; ++t) {
    push({pass.points[t], t, -1, false});
    if (next == splits.size() || splits[next].after != t) continue;
    const std::vector<SplitPoint> added = grown(next, By::kEarlier);
    std::for_each(added.begin(), added.end(), push);
    lifted = t + 1 < count;
    if (lifted) enter(next);
    ++next;
  }
  assert(next == splits.size() && "splits ascend");
  return points;
}

std::vector<OverlapChoice> OverlapChoices(double length) {
  using By = OverlapChoice::By;
  return {{By::kLater, length},
          {By::kEarlier, length},
          {By::kLater, length / 2},
          {By::kEarlier, length / 2},
          {By::kLater, 0},
          {By::kEarlier, 0},
          {By::kNone, 0}};
}

}  // namespace millpose
