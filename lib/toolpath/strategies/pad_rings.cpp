// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/pad_rings.hpp"

#include <Eigen/Geometry>

namespace millpose {
namespace {

using Free = std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>;

constexpr double kTie = 1e-6;      // mm: rounding decides nothing between ways of equal length
constexpr double kNearEnd = 1.5;   // steps to what the end of a ring goes on to
constexpr double kNearRing = 2.5;  // steps between rings: the innermost of two sides lie up to 2 apart

// Where two rings come nearest to each other.
struct Meeting {
  double distance = std::numeric_limits<double>::infinity();
  Eigen::Vector3d here = Eigen::Vector3d::Zero(), there = Eigen::Vector3d::Zero();
};

Eigen::AlignedBox3d BoxOf(const Loop& loop) {
  Eigen::AlignedBox3d box;
  for (const CurvePiece& piece : loop.curve().pieces) box.extend(piece.start);
  return box;
}

// By looking from points of one ring and going to and fro from the best of them.
Meeting MeetingOf(const Loop& here, const Loop& there) {
  constexpr int kLooks = 64;
  Meeting meeting;
  for (int i = 0; i < kLooks; ++i) {
    const Eigen::Vector3d p = here.At(here.length() * i / kLooks);
    const auto [distance, at] = there.Nearest(p);
    if (distance < meeting.distance - kTie) meeting = {distance, p, there.At(at)};
  }
  for (int i = 0; i < 4; ++i) {
    meeting.here = here.At(here.Nearest(meeting.there).second);
    const auto [distance, at] = there.Nearest(meeting.here);
    meeting.there = there.At(at);
    meeting.distance = distance;
  }
  return meeting;
}

/// Trees of rings that are near each other (Prim 1957: the shortest links), and the way through them.
class RingForest {
 public:
  RingForest(std::vector<PadRing> rings, double step, bool climb, const Free& free)
      : step_(step), climb_(climb), free_(free) {
    for (PadRing& ring : rings) nodes_.push_back(Node{std::move(ring)});
    for (const Node& node : nodes_) boxes_.push_back(BoxOf(node.ring.loop));
  }

  std::vector<Curve> Curves() {
    std::vector<Curve> curves;
    for (size_t root = Root(); root < nodes_.size(); root = Root()) {
      Grow(root);
      Curve& curve = curves.emplace_back();
      Walk(root, nodes_[root].ring.loop.At(0), false, curve);
      curve.closed = (curve.pieces.back().end - curve.pieces.front().start).norm() < 1e-9;
    }
    return curves;
  }

 private:
  struct Node {
    PadRing ring;
    Eigen::Vector3d entry = Eigen::Vector3d::Zero(), from = Eigen::Vector3d::Zero();  // on it, on its parent
    std::vector<size_t> children = {};
    size_t size = 1;  // of the tree from here
    bool used = false;
  };

  // The outermost and, of these, the longest ring that is left.
  size_t Root() const {
    size_t root = nodes_.size();
    for (size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].used) continue;
      if (root == nodes_.size() || nodes_[i].ring.level < nodes_[root].ring.level ||
          (nodes_[i].ring.level == nodes_[root].ring.level &&
           nodes_[i].ring.loop.length() > nodes_[root].ring.loop.length() + kTie))
        root = i;
    }
    return root;
  }

  void Grow(size_t root) {
    std::vector<Meeting> best(nodes_.size());
    std::vector<size_t> parent(nodes_.size(), root), order;
    Orient(nodes_[root], true);
    for (size_t added = root;;) {
      nodes_[added].used = true;
      order.push_back(added);
      size_t next = nodes_.size();
      for (size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].used) continue;
        if (const Meeting meeting = LinkOf(added, i, best[i].distance);
            meeting.distance < best[i].distance - kTie) {
          best[i] = meeting;
          parent[i] = added;
        }
        if (std::isfinite(best[i].distance) &&
            (next == nodes_.size() || best[i].distance < best[next].distance - kTie))
          next = i;
      }
      if (next == nodes_.size()) break;
      Node& child = nodes_[next];
      child.from = best[next].here;
      child.entry = best[next].there;
      Orient(child, child.ring.level > nodes_[parent[next]].ring.level);
      nodes_[parent[next]].children.push_back(next);
      added = next;
    }
    for (auto it = order.rbegin(); it != order.rend(); ++it)
      for (const size_t child : nodes_[*it].children) nodes_[*it].size += nodes_[child].size;
  }

  Meeting LinkOf(size_t here, size_t there, double bound) const {
    const double reach = std::min(bound, kNearRing * step_);
    if (std::abs(nodes_[here].ring.level - nodes_[there].ring.level) > 1 ||
        boxes_[here].exteriorDistance(boxes_[there]) > reach)
      return {};
    const Meeting meeting = MeetingOf(nodes_[here].ring.loop, nodes_[there].ring.loop);
    return meeting.distance < reach && free_(meeting.here, meeting.there) ? meeting : Meeting{};
  }

  void Orient(Node& node, bool inwards) const {
    if (inwards == climb_) node.ring.loop = Loop(Reversed(node.ring.loop.curve()));
  }

  // The children that can be reached from a point of their parent, those with most behind them last.
  std::vector<size_t> Near(const Node& node, const Eigen::Vector3d& p) const {
    std::vector<size_t> near;
    for (const size_t child : node.children) {
      const Loop& loop = nodes_[child].ring.loop;
      const auto [distance, at] = loop.Nearest(p);
      if (distance <= kNearEnd * step_ && free_(p, loop.At(at))) near.push_back(child);
    }
    std::ranges::stable_sort(near, {}, [this](size_t child) { return nodes_[child].size; });
    return near;
  }

  // Round a ring from the place nearest to a point, stepping aside to children that lie elsewhere, then on to
  // those that are near its end; `returns`: and back to that place.
  void Walk(size_t at, const Eigen::Vector3d& entry, bool returns, Curve& curve) const {
    const Node& node = nodes_[at];
    const Loop& loop = node.ring.loop;
    const double from = loop.Nearest(entry).second;
    const Eigen::Vector3d end = loop.At(from);
    const std::vector<size_t> near = Near(node, end);
    std::vector<std::pair<double, size_t>> aside;  // how far ahead
    for (const size_t child : node.children) {
      if (std::ranges::find(near, child) != near.end()) continue;
      const double ahead = loop.Nearest(nodes_[child].from).second - from;
      aside.emplace_back(ahead < 0 ? ahead + loop.length() : ahead, child);
    }
    std::ranges::sort(aside);
    double done = 0;
    for (const auto& [ahead, child] : aside) {
      const double next = std::max(ahead, done + 1e-3);  // links begin on the ring
      Append(curve, loop.Way(from + done, next - done));
      Walk(child, nodes_[child].entry, true, curve);
      done = next;
    }
    Append(curve, loop.Way(from + done, loop.length() - done));
    for (const size_t child : near) {
      const bool back = returns || child != near.back();
      Walk(child, end, back, curve);
      if (back) curve.pieces.push_back(LinePiece(curve.pieces.back().face, curve.pieces.back().end, end));
    }
  }

  std::vector<Node> nodes_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  double step_;
  bool climb_;
  const Free& free_;
};

}  // namespace

std::vector<Curve> JoinRings(std::vector<PadRing> rings, double step, bool climb, const Free& free) {
  return RingForest(std::move(rings), step, climb, free).Curves();
}

}  // namespace millpose
