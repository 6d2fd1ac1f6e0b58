// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim_offset.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "base/rotation.hpp"
#include "base/trig.hpp"
#include "surface/triangle.hpp"

namespace millpose {
namespace {

constexpr double kTouch = 1e-6;   // mm by which the distance may fall short
constexpr double kMissed = 2e-3;  // mm deep: what lies between two places that are looked at
constexpr double kJoin = 0.02;    // mm between the ends of stretches that go on in each other
constexpr double kShort = 0.05;   // mm: shorter ways are none

Eigen::Vector3d LeftOf(const Eigen::Vector3d& axis, const Eigen::Vector3d& along) {
  return axis.cross(along).normalized();
}

// One segment of the contour, or the arc round its corner, moved aside; t from 0 to 1.
struct Element {
  size_t segment = 0;  // whose first point an arc goes round
  bool arc = false;
  Eigen::Vector3d left = Eigen::Vector3d::Zero();  // of an arc, where it begins
  double turn = 0;                                 // of an arc, clockwise, rad
};

// A stretch of one element.
struct Stretch {
  size_t element = 0;
  double from = 0, to = 1;
};

class Offsetter {
 public:
  Offsetter(const Contour& contour, double distance, double chord, double crease)
      : contour_(contour), distance_(distance), chord_(chord), crease_(crease), near_(contour, 3 * distance) {
    for (size_t i = 0; i < contour.Segments(); ++i) {
      if (i > 0 || contour.closed) AddArc(i);
      elements_.push_back({i, false, Eigen::Vector3d::Zero(), 0});
    }
  }

  Offset Run(const std::stop_token& stop) {
    std::vector<std::vector<Stretch>> runs = Runs(stop);
    Offset offset;
    std::vector<char> used(runs.size(), 0);
    for (size_t first = 0; first < runs.size(); ++first) {
      if (used[first] != 0) continue;
      OffsetPath path;
      for (size_t at = first;;) {
        used[at] = 1;
        Append(runs[at], path);
        const size_t next = NextOf(at, runs);
        if (next == runs.size()) break;
        Tell(runs[at].back(), runs[next].front(), offset.corners);
        path.closed = next == first;
        if (used[next] != 0) break;
        at = next;
      }
      if (whole_) path.closed = true;
      Finish(path, offset.paths);
    }
    return offset;
  }

 private:
  // Where the contour turns to the right the way goes round its corner.
  void AddArc(size_t i) {
    const size_t before = (i + contour_.points.size() - 1) % contour_.points.size();
    const ContourPoint& corner = contour_.From(i);
    const Eigen::Vector3d in = LeftOf(corner.axis, corner.place - contour_.From(before).place);
    const Eigen::Vector3d out = LeftOf(corner.axis, contour_.To(i).place - corner.place);
    const double turn = Atan2(in.cross(out).dot(corner.axis), in.dot(out));
    if (turn < -1e-9) elements_.push_back({i, true, in, -turn});
  }

  OffsetNode At(const Element& element, double t) const {
    const ContourPoint& from = contour_.From(element.segment);
    if (element.arc) {
      const Eigen::Vector3d left = RotationAbout(from.axis, -t * element.turn) * element.left;
      return {from.place + distance_ * left, from.axis};
    }
    const ContourPoint& to = contour_.To(element.segment);
    const Eigen::Vector3d axis = (from.axis + t * (to.axis - from.axis)).normalized();
    const Eigen::Vector3d along = to.place - from.place;
    return {from.place + t * along + distance_ * LeftOf(axis, along), axis};
  }

  double LengthOf(const Element& element) const {
    if (element.arc) return distance_ * element.turn;
    return (contour_.To(element.segment).place - contour_.From(element.segment).place).norm();
  }

  bool Fits(const Element& element, double t) const {
    const OffsetNode node = At(element, t);
    return near_.At(node.place, node.axis) >= distance_ - kTouch;
  }

  // Between a place that fits and one that does not, where it ends to fit.
  double Edge(const Element& element, double fits, double not_fits) const {
    for (int i = 0; i < 50; ++i) {
      const double middle = (fits + not_fits) / 2;
      (Fits(element, middle) ? fits : not_fits) = middle;
    }
    return fits;
  }

  std::vector<Stretch> Fitting(size_t number) const {
    const Element& element = elements_[number];
    const double step = std::sqrt(8 * distance_ * kMissed);
    const int steps = std::max(2, static_cast<int>(std::ceil(LengthOf(element) / step)));
    std::vector<Stretch> stretches;
    bool fitted = Fits(element, 0);
    double begin = 0;
    for (int i = 1; i <= steps; ++i) {
      const double before = static_cast<double>(i - 1) / steps, now = static_cast<double>(i) / steps;
      const bool fits = Fits(element, now);
      if (fits && !fitted) begin = Edge(element, now, before);
      if (!fits && fitted) stretches.push_back({number, begin, Edge(element, before, now)});
      fitted = fits;
    }
    if (fitted) stretches.push_back({number, begin, 1});
    return stretches;
  }

  // Stretches that fit, end to end.
  std::vector<std::vector<Stretch>> Runs(const std::stop_token& stop) {
    std::vector<std::vector<Stretch>> runs;
    bool goes_on = false;
    for (size_t i = 0; i < elements_.size(); ++i) {
      CheckStop(stop);
      const std::vector<Stretch> fitting = Fitting(i);
      if (fitting.empty() || fitting.front().from > 0) goes_on = false;
      for (const Stretch& stretch : fitting) {
        if (!goes_on) runs.emplace_back();
        runs.back().push_back(stretch);
        goes_on = stretch.to == 1;
      }
    }
    const bool round = contour_.closed && goes_on && !runs.empty() && runs.front().front().element == 0 &&
                       runs.front().front().from == 0;
    if (round && runs.size() > 1) {  // the last runs on over the start
      runs.back().insert(runs.back().end(), runs.front().begin(), runs.front().end());
      runs.erase(runs.begin());
    } else if (round) {
      whole_ = true;
    }
    return runs;
  }

  OffsetNode EndOf(const std::vector<Stretch>& run) const {
    return At(elements_[run.back().element], run.back().to);
  }
  OffsetNode StartOf(const std::vector<Stretch>& run) const {
    return At(elements_[run.front().element], run.front().from);
  }

  // The run that begins where this one ends; their number where there is none.
  size_t NextOf(size_t at, const std::vector<std::vector<Stretch>>& runs) const {
    if (whole_) return runs.size();
    const Eigen::Vector3d end = EndOf(runs[at]).place;
    size_t nearest = runs.size();
    double best = kJoin;
    for (size_t i = 0; i < runs.size(); ++i)
      if (const double distance = (StartOf(runs[i]).place - end).norm(); distance < best)
        best = distance, nearest = i;
    return nearest;
  }

  void Append(const std::vector<Stretch>& run, OffsetPath& path) const {
    for (const Stretch& stretch : run) {
      const Element& element = elements_[stretch.element];
      int steps = 1;
      if (element.arc) {
        const double widest = 2 * std::sqrt(2 * chord_ / distance_);  // rad of a chord within the tolerance
        steps = std::max(1, static_cast<int>(std::ceil(element.turn * (stretch.to - stretch.from) / widest)));
      }
      for (int i = 0; i <= steps; ++i)
        path.nodes.push_back(At(element, stretch.from + (stretch.to - stretch.from) * i / steps));
    }
  }

  // What the cutter leaves of the contour between two stretches.
  void Tell(const Stretch& end, const Stretch& start, std::vector<TightCorner>& corners) const {
    const OffsetNode node = At(elements_[end.element], end.to);
    TightCorner corner;
    const size_t count = contour_.points.size(), last = elements_[start.element].segment;
    for (size_t i = elements_[end.element].segment; i != last;) {
      i = (i + 1) % count;
      Eigen::Vector3d off = contour_.points[i].place - node.place;
      off -= off.dot(node.axis) * node.axis;
      if (off.norm() - distance_ > corner.left) corner = {contour_.points[i].place, off.norm() - distance_};
    }
    const Eigen::Vector3d in = DirectionOf(end), out = DirectionOf(start);
    const double turn = Atan2(in.cross(out).norm(), in.dot(out));
    if (turn > crease_ + 1e-6 && corner.left > std::max(chord_, 10 * kMissed)) corners.push_back(corner);
  }

  Eigen::Vector3d DirectionOf(const Stretch& stretch) const {
    const size_t segment = elements_[stretch.element].segment;
    return contour_.To(segment).place - contour_.From(segment).place;
  }

  // Without places that lie on each other or on a line.
  static void Finish(OffsetPath& path, std::vector<OffsetPath>& paths) {
    std::vector<OffsetNode> kept;
    for (const OffsetNode& node : path.nodes) {
      if (!kept.empty() && (node.place - kept.back().place).norm() < 1e-3) continue;
      if (kept.size() > 1 && IsStraight(kept[kept.size() - 2], kept.back(), node)) kept.pop_back();
      kept.push_back(node);
    }
    while (path.closed && kept.size() > 2 && (kept.back().place - kept.front().place).norm() < 1e-3)
      kept.pop_back();
    path.nodes = std::move(kept);
    double length = 0;
    for (size_t i = 0; path.nodes.size() > 1 && i < path.Segments(); ++i)
      length += (path.To(i).place - path.From(i).place).norm();
    if (length > kShort && path.nodes.size() >= (path.closed ? 3U : 2U)) paths.push_back(std::move(path));
  }

  static bool IsStraight(const OffsetNode& a, const OffsetNode& b, const OffsetNode& c) {
    const double t = ClosestOnSegment(b.place, a.place, c.place);
    const Eigen::Vector3d axis = (a.axis + t * (c.axis - a.axis)).normalized();
    return (a.place + t * (c.place - a.place) - b.place).norm() < 1e-6 && (axis - b.axis).norm() < 1e-9;
  }

  const Contour& contour_;
  double distance_, chord_, crease_;
  ContourDistance near_;
  std::vector<Element> elements_;
  bool whole_ = false;  // the way fits all round
};

}  // namespace

ContourDistance::ContourDistance(const Contour& contour, double reach) : contour_(contour), reach_(reach) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (size_t i = 0; i < contour.Segments(); ++i) {
    boxes.emplace_back(contour.From(i).place);
    boxes.back().extend(contour.To(i).place);
  }
  tree_ = Bvh(boxes);
}

double ContourDistance::At(const Eigen::Vector3d& place, const Eigen::Vector3d& axis) const {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(reach_);
  double squared = std::numeric_limits<double>::infinity();
  tree_.ForEachIn({place - reach, place + reach}, [&](int i) {
    const auto across = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      const Eigen::Vector3d off = p - place;
      return off - off.dot(axis) * axis;
    };
    const Eigen::Vector3d a = across(contour_.From(static_cast<size_t>(i)).place);
    const Eigen::Vector3d b = across(contour_.To(static_cast<size_t>(i)).place);
    const double t = (b - a).squaredNorm() > 0 ? ClosestOnSegment(Eigen::Vector3d::Zero(), a, b) : 0.0;
    squared = std::min(squared, (a + t * (b - a)).squaredNorm());
  });
  return std::sqrt(squared);
}

Offset OffsetOf(const Contour& contour, double distance, double chord, double crease,
                const std::stop_token& stop) {
  return Offsetter(contour, distance, chord, crease).Run(stop);
}

}  // namespace millpose
