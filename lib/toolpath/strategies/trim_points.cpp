// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim_points.hpp"

#include <algorithm>

namespace millpose {
namespace {

class PointMaker {
 public:
  PointMaker(const Trim& trim, const ToolpathOptions& options, const TrimStops& way)
      : trim_(trim), options_(options), way_(way.stops), lead_in_(way.lead_in), lead_out_(way.lead_out) {}

  Pass Make() {
    FindDirections();
    pass_.whole = true;
    pass_.rotation_reference = options_.rotation_reference;
    Add(way_[0], Tip(way_[0]), along_[0], PointKind::kLeadIn);
    for (size_t i = 1; i < way_.size(); ++i) {
      const PointKind kind = i <= lead_in_    ? PointKind::kLeadIn
                             : i >= lead_out_ ? PointKind::kLeadOut
                                              : PointKind::kCut;
      const Eigen::Vector3d from = Tip(way_[i - 1]), to = Tip(way_[i]);
      const int steps =
          std::max(1, static_cast<int>(std::ceil((to - from).norm() / options_.spacing - 1e-9))) *
          std::max(1, options_.parts);
      for (int k = 1; k < steps; ++k) {
        const double share = static_cast<double>(k) / steps;
        TrimStop stop = way_[i];
        const TrimStop& before = way_[i - 1];
        stop.node.axis = (before.node.axis + share * (stop.node.axis - before.node.axis)).normalized();
        stop.depth = before.depth + share * (stop.depth - before.depth);
        Add(stop, from + share * (to - from), along_[i - 1], kind);
      }
      const Eigen::Vector3d both = along_[i - 1] + along_[std::min(i, along_.size() - 1)];
      const bool turns = way_[i].back != way_[std::min(i + 1, way_.size() - 1)].back;
      Add(way_[i], to, both.norm() > 1e-3 && !turns ? Eigen::Vector3d(both.normalized()) : along_[i - 1],
          kind);
    }
    return std::move(pass_);
  }

 private:
  static Eigen::Vector3d Tip(const TrimStop& stop) { return stop.node.place - stop.depth * stop.node.axis; }

  // Of each way between two stops, across the axis; straight up or down: as before, or as after at the
  // beginning.
  void FindDirections() {
    const size_t count = way_.size() - 1;
    along_.assign(count, Eigen::Vector3d::Zero());
    for (size_t i = 0; i < count; ++i) {
      Eigen::Vector3d way = Tip(way_[i + 1]) - Tip(way_[i]);
      const Eigen::Vector3d& axis = way_[i + 1].node.axis;
      way -= way.dot(axis) * axis;
      if (way.norm() > 1e-6)
        along_[i] = way.normalized();
      else if (i > 0)
        along_[i] = along_[i - 1];
    }
    for (size_t i = count; i-- > 0;)
      if (along_[i].isZero() && i + 1 < count) along_[i] = along_[i + 1];
  }

  void Add(const TrimStop& stop, const Eigen::Vector3d& tip, const Eigen::Vector3d& along, PointKind kind) {
    MillingPoint point;
    point.position = tip;
    point.tool_axis = stop.node.axis;
    const bool left = trim_.climb != stop.back;
    point.normal = (left ? point.tool_axis.cross(along) : along.cross(point.tool_axis)).normalized();
    point.feed = (along - along.dot(point.normal) * point.normal).normalized();
    point.feed_rate = stop.feed;
    point.kind = kind;
    // What rises by up to 10° beside the line is still the blank's own surface.
    if (trim_.line && trim_.line->blank)
      point.own = OwnCut{stop.depth + 0.18 * options_.cutter.radius, stop.depth - trim_.through};
    if (!pass_.points.empty())
      point.arc_length = pass_.points.back().arc_length + (tip - pass_.points.back().position).norm();
    pass_.points.push_back(point);
  }

  const Trim& trim_;
  const ToolpathOptions& options_;
  const std::vector<TrimStop>& way_;
  size_t lead_in_, lead_out_;
  std::vector<Eigen::Vector3d> along_;
  Pass pass_;
};

}  // namespace

Pass PointsAlong(const Trim& trim, const ToolpathOptions& options, const TrimStops& way) {
  return PointMaker(trim, options, way).Make();
}

}  // namespace millpose
