// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim_offset.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "base/trig.hpp"
#include "toolpath/strategies/trim_distance.hpp"
#include "toolpath/strategies/trim_smooth.hpp"

namespace millpose {
namespace {

constexpr double kTouch = 1e-3;   // mm by which the distance may fall short
constexpr double kMissed = 0.02;  // mm: a corner with less left standing is none
constexpr double kShort = 0.05;   // mm: shorter ways are none

// Where the contour moved aside runs over itself: a place on one side of it, and the event of the other.
struct Crossing {
  size_t side = 0;
  double share = 0;
  size_t other = 0;
};

// Crossings of the sides, each seen along the mean of both tool axes, in the order of the way.
class CrossingFinder {
 public:
  CrossingFinder(const Aside& aside, double distance) : aside_(aside), distance_(distance) {}

  std::vector<Crossing> Find() {
    std::vector<Eigen::AlignedBox3d> boxes;
    const Eigen::Vector3d slack = Eigen::Vector3d::Constant(distance_ / 8);
    for (size_t i = 0; i < aside_.sides.size(); ++i) {
      Eigen::AlignedBox3d box(aside_.From(i).place);
      box.extend(aside_.To(i).place);
      boxes.emplace_back(box.min() - slack, box.max() + slack);
    }
    Bvh(boxes).ForEachPair([&](int a, int b) {
      Look(static_cast<size_t>(std::min(a, b)), static_cast<size_t>(std::max(a, b)));
      return true;
    });
    return Ordered();
  }

 private:
  void Look(size_t a, size_t b) {
    const size_t count = aside_.sides.size();
    if (b == a + 1 || (aside_.closed && a == 0 && b + 1 == count)) return;
    const OffsetNode &a0 = aside_.From(a), &b0 = aside_.From(b);
    if (a0.axis.dot(b0.axis) < 0.5) return;  // another side of the part
    const Eigen::Vector3d axis = (a0.axis + aside_.To(a).axis + b0.axis + aside_.To(b).axis).normalized();
    const Eigen::Vector3d u = aside_.To(a).place - a0.place, v = aside_.To(b).place - b0.place;
    const Eigen::Vector3d off = b0.place - a0.place;
    const double turn = u.cross(v).dot(axis);
    if (std::abs(turn) <= 1e-9 * u.norm() * v.norm()) return;
    const double on_a = off.cross(v).dot(axis) / turn, on_b = off.cross(u).dot(axis) / turn;
    if (on_a < 0 || on_a >= 1 || on_b < 0 || on_b >= 1) return;
    if (std::abs((off + on_b * v - on_a * u).dot(axis)) > distance_ / 2) return;  // one far over the other
    found_.push_back({a, on_a, b, on_b});
  }

  std::vector<Crossing> Ordered() const {
    std::vector<Crossing> events;
    std::vector<size_t> order;
    for (const Pair& pair : found_) {
      events.push_back({pair.a, pair.on_a, events.size() + 1});
      events.push_back({pair.b, pair.on_b, events.size() - 1});
    }
    for (size_t i = 0; i < events.size(); ++i) order.push_back(i);
    std::ranges::stable_sort(order, std::less(),
                             [&](size_t i) { return std::tuple(events[i].side, events[i].share, i); });
    std::vector<size_t> rank(events.size());
    for (size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    std::vector<Crossing> ordered;
    for (const size_t i : order) ordered.push_back({events[i].side, events[i].share, rank[events[i].other]});
    return ordered;
  }

  struct Pair {
    size_t a;
    double on_a;
    size_t b;
    double on_b;
  };

  const Aside& aside_;
  double distance_;
  std::vector<Pair> found_;
};

constexpr size_t kNoCrossing = static_cast<size_t>(-1);

// What lies between two crossings, which is all far enough from the contour or none of it.
struct Piece {
  size_t begin = kNoCrossing,
         end = kNoCrossing;  // crossings; none: the way's own ends, or it is closed without any
  bool fits = false;
};

class Offsetter {
 public:
  Offsetter(const Contour& contour, const OffsetOptions& options)
      : contour_(contour),
        options_(options),
        near_(contour, 3 * options.distance),
        aside_(MovedAside(contour, options)) {}

  Offset Run(const std::stop_token& stop) {
    crossings_ = CrossingFinder(aside_, options_.distance).Find();
    FindPieces(stop);
    Offset offset;
    std::vector<char> used(pieces_.size(), 0);
    // Ways of an open contour from their beginning on, then what is closed.
    for (const bool begins : {true, false})
      for (size_t first = 0; first < pieces_.size(); ++first) {
        if (used[first] != 0 || !pieces_[first].fits || (begins && HasBefore(first))) continue;
        CheckStop(stop);
        AddPath(first, used, offset);
      }
    return offset;
  }

 private:
  void FindPieces(const std::stop_token& stop) {
    const size_t count = crossings_.size();
    if (count == 0) {
      pieces_.emplace_back();
    } else {
      if (!aside_.closed) pieces_.push_back({kNoCrossing, 0, false});
      for (size_t i = 0; i + 1 < count; ++i) pieces_.push_back({i, i + 1, false});
      pieces_.push_back({count - 1, aside_.closed ? 0 : kNoCrossing, false});
    }
    for (Piece& piece : pieces_) {
      CheckStop(stop);
      double fits = 0, all = 0;
      ForEachPart(piece, [&](size_t side, double from, double to) {
        const double length = (aside_.To(side).place - aside_.From(side).place).norm() * (to - from);
        all += length;
        if (Fits(side, (from + to) / 2)) fits += length;
      });
      piece.fits = all > 0 && fits > all / 2;
    }
  }

  // The sides of a piece, of the first and last the share that is its own.
  template <typename Visit>
  void ForEachPart(const Piece& piece, Visit visit) const {
    const size_t sides = aside_.sides.size();
    size_t side = piece.begin == kNoCrossing ? 0 : crossings_[piece.begin].side;
    double from = piece.begin == kNoCrossing ? 0 : crossings_[piece.begin].share;
    const size_t last = piece.end == kNoCrossing ? sides - 1 : crossings_[piece.end].side;
    const double to = piece.end == kNoCrossing ? 1 : crossings_[piece.end].share;
    for (; side != last || from > to; side = (side + 1) % sides, from = 0) visit(side, from, 1.0);
    visit(side, from, to);
  }

  bool Fits(size_t number, double share) const {
    const AsideSide& side = aside_.sides[number];
    if (side.kind == SideKind::kAcross) return false;
    OffsetNode node = aside_.At(number, share);
    if (side.kind == SideKind::kRound) {  // on the arc, not on its chord
      const Eigen::Vector3d& corner = contour_.points[side.at].place;
      node.place = corner + options_.distance * (node.place - corner).normalized();
    }
    // Between axes that differ the way is a chord, too.
    const double twist = (aside_.To(number).axis - aside_.From(number).axis).squaredNorm();
    return near_.At(node.place, node.axis) >= options_.distance * (1 - twist / 4) - kTouch;
  }

  size_t SegmentFrom(size_t crossing) const { return aside_.closed ? crossing : crossing + 1; }

  size_t SegmentUpTo(size_t crossing) const {
    if (!aside_.closed) return crossing;
    return (crossing + crossings_.size() - 1) % crossings_.size();
  }

  bool HasBefore(size_t piece) const {
    const size_t begin = pieces_[piece].begin;
    if (begin == kNoCrossing) return aside_.closed;
    return pieces_[SegmentUpTo(crossings_[begin].other)].fits || pieces_[SegmentUpTo(begin)].fits;
  }

  // The piece that goes on where this one ends: at a crossing the way changes to the other strand.
  size_t NextOf(size_t piece, const std::vector<char>& used, size_t first) const {
    const size_t end = pieces_[piece].end;
    if (end == kNoCrossing) return aside_.closed ? first : kNoCrossing;
    for (const size_t next : {SegmentFrom(crossings_[end].other), SegmentFrom(end)})
      if (pieces_[next].fits && (used[next] == 0 || next == first)) return next;
    return kNoCrossing;
  }

  void AddPath(size_t first, std::vector<char>& used, Offset& offset) const {
    Way way;
    for (size_t at = first;;) {
      used[at] = 1;
      Append(pieces_[at], way);
      const size_t next = NextOf(at, used, first);
      if (next == kNoCrossing) break;
      const size_t end = pieces_[at].end;
      if (end != kNoCrossing && pieces_[next].begin != end) Tell(end, crossings_[end].other, offset.corners);
      way.closed = next == first;
      if (way.closed) break;
      at = next;
    }
    OffsetPath path = SmoothPath(way, contour_, near_, options_, offset.lean);
    double length = 0;
    for (size_t i = 0; path.nodes.size() > 1 && i < path.Segments(); ++i)
      length += (path.To(i).place - path.From(i).place).norm();
    if (length > kShort && path.nodes.size() >= (path.closed ? 3U : 2U))
      offset.paths.push_back(std::move(path));
  }

  TrackSample SampleAt(size_t side, double share) const {
    const size_t at = aside_.sides[side].at;
    return {aside_.At(side, share), std::min(at, contour_.Segments() - 1), 0};
  }

  OffsetNode NodeAt(size_t crossing) const {
    return aside_.At(crossings_[crossing].side, crossings_[crossing].share);
  }

  // A crossing lies between both strands, which differ in height on a curved skin.
  TrackSample AtCrossing(size_t crossing, double rise) const {
    TrackSample sample = SampleAt(crossings_[crossing].side, crossings_[crossing].share);
    sample.node.place = (NodeAt(crossing).place + NodeAt(crossings_[crossing].other).place) / 2;
    sample.rise = rise;
    return sample;
  }

  void Append(const Piece& piece, Way& way) const {
    if (piece.begin != kNoCrossing) {
      const OffsetNode from = NodeAt(crossings_[piece.begin].other), to = NodeAt(piece.begin);
      way.samples.push_back(AtCrossing(piece.begin, (to.place - from.place).dot(to.axis)));
    }
    ForEachPart(piece, [&](size_t side, double from, double to) {
      if (from == 0) way.samples.push_back(SampleAt(side, 0));
      const bool last = side + 1 == aside_.sides.size();
      if (to == 1 && last && !aside_.closed) way.samples.push_back(SampleAt(side, 1));
    });
    if (piece.end != kNoCrossing) way.samples.push_back(AtCrossing(piece.end, 0));
  }

  // What the cutter leaves of the contour between two strands that cross, if nothing there fits.
  void Tell(size_t end, size_t start, std::vector<TightCorner>& corners) const {
    for (size_t i = end; i != start; i = (i + 1) % crossings_.size())
      if (pieces_[SegmentFrom(i)].fits) return;
    const OffsetNode node = AtCrossing(end, 0).node;
    const size_t first = SegmentOf(end), last = SegmentOf(start), count = contour_.points.size();
    TightCorner corner;
    for (size_t i = first; i != last;) {
      i = (i + 1) % count;
      Eigen::Vector3d off = contour_.points[i].place - node.place;
      off -= off.dot(node.axis) * node.axis;
      if (off.norm() - options_.distance > corner.left)
        corner = {contour_.points[i].place, off.norm() - options_.distance};
    }
    const Eigen::Vector3d in = DirectionOf(first), out = DirectionOf(last);
    const double turn = Atan2(in.cross(out).norm(), in.dot(out));
    if (turn > options_.crease + 1e-6 && corner.left > std::max(options_.chord, kMissed))
      corners.push_back(corner);
  }

  size_t SegmentOf(size_t crossing) const { return aside_.sides[crossings_[crossing].side].at; }

  Eigen::Vector3d DirectionOf(size_t segment) const {
    const size_t at = std::min(segment, contour_.Segments() - 1);
    return contour_.To(at).place - contour_.From(at).place;
  }

  const Contour& contour_;
  const OffsetOptions& options_;
  ContourDistance near_;
  Aside aside_;
  std::vector<Crossing> crossings_;
  std::vector<Piece> pieces_;
};

}  // namespace

Offset OffsetOf(const Contour& contour, const OffsetOptions& options, const std::stop_token& stop) {
  return Offsetter(contour, options).Run(stop);
}

}  // namespace millpose
