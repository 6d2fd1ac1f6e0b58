// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim_smooth.hpp"

#include <algorithm>

#include "base/trig.hpp"
#include "geometry/mesh/triangle.hpp"

namespace millpose {
namespace {

constexpr double kOnePlace = 1e-9;     // mm along the way: one place
constexpr double kNear = 0.3;          // mm: nodes nearer than this go where the tolerance allows it
constexpr double kStraight = 2e-4;     // rad: what bends by less runs straight on
constexpr double kMostPlaces = 20000;  // places looked at because of the axis alone

// A closed line of values or an open one, averaged over a length of it.
class AxisMean {
 public:
  AxisMean(const Way& way, double length)
      : way_(way), half_(length / 2), sides_(way.samples.size() - (way.closed ? 0 : 1)) {
    integrals_.push_back(Eigen::Vector3d::Zero());
    for (size_t i = 0; i < sides_; ++i) {
      const double side = (After(i).node.place - way.samples[i].node.place).norm();
      begins_.push_back(begins_.back() + side);
      integrals_.push_back(integrals_.back() + side / 2 * (way.samples[i].node.axis + After(i).node.axis));
    }
    if (way.closed) half_ = std::min(half_, begins_.back() / 2);
  }

  double length() const { return begins_.back(); }
  double half() const { return half_; }
  double begin(size_t side) const { return begins_[side]; }
  size_t sides() const { return sides_; }
  const TrackSample& After(size_t side) const { return way_.samples[(side + 1) % way_.samples.size()]; }

  /// Of an open way the length shrinks towards its ends, where `own` is the axis.
  Eigen::Vector3d At(double s, const Eigen::Vector3d& own) const {
    const double half = way_.closed ? half_ : std::min({half_, s, length() - s});
    if (half <= kOnePlace) return own;
    return (Integral(s + half) - Integral(s - half)).normalized();
  }

 private:
  Eigen::Vector3d Integral(double s) const {
    if (s < 0) return Integral(s + length()) - integrals_.back();
    if (s > length()) return Integral(s - length()) + integrals_.back();
    const auto after = std::upper_bound(begins_.begin(), begins_.end(), s) - begins_.begin();
    const size_t side = std::min(static_cast<size_t>(after), sides_) - 1;
    const double whole = begins_[side + 1] - begins_[side], part = s - begins_[side];
    const Eigen::Vector3d &a = way_.samples[side].node.axis, &b = After(side).node.axis;
    return integrals_[side] + part * a + (whole > 0 ? part * part / whole / 2 : 0.0) * (b - a);
  }

  const Way& way_;
  double half_;
  size_t sides_;
  std::vector<double> begins_{0};
  std::vector<Eigen::Vector3d> integrals_;
};

class Smoother {
 public:
  Smoother(const Way& way, const Contour& contour, const ContourDistance& near, const OffsetOptions& options)
      : way_(way), contour_(contour), near_(near), options_(options), mean_(way, options.smoothing) {
    for (size_t i = way.closed ? 0 : 1; i < way.samples.size(); ++i)
      if (way.samples[i].rise != 0) rises_.push_back(i);
    const Eigen::Vector3d& axis = way.samples[0].node.axis;
    even_ = rises_.empty() && std::ranges::all_of(way.samples, [&](const TrackSample& sample) {
              return (sample.node.axis - axis).norm() < 1e-12;
            });
  }

  OffsetPath Run(double& lean) {
    for (size_t i = 0; i < mean_.sides(); ++i) {
      const int steps = StepsOf(i);
      for (int k = 0; k < steps; ++k) Add(i, static_cast<double>(k) / steps, lean);
    }
    if (!way_.closed) Add(way_.samples.size() - 1, 0, lean);
    if (way_.closed && nodes_.size() > 1 && mean_.length() - places_.back() < kOnePlace) {
      nodes_.front().place = (nodes_.front().place + nodes_.back().place) / 2;
      nodes_.pop_back();
    }
    return {std::move(nodes_), way_.closed};
  }

 private:
  int StepsOf(size_t side) const {
    if (options_.smoothing <= 0 || even_) return 1;
    const double step = std::max(options_.smoothing / 8, mean_.length() / kMostPlaces);
    const double length = mean_.begin(side + 1) - mean_.begin(side);
    return std::max(1, static_cast<int>(std::ceil(length / step)));
  }

  void Add(size_t side, double share, double& lean) {
    const TrackSample &from = way_.samples[side], &to = mean_.After(side);
    const bool end = side == mean_.sides();  // of an open way
    const double length = end ? 0 : mean_.begin(side + 1) - mean_.begin(side);
    const double s = mean_.begin(side) + share * length;
    OffsetNode node{from.node.place + share * (to.node.place - from.node.place),
                    (from.node.axis + share * (to.node.axis - from.node.axis)).normalized()};
    const Eigen::Vector3d own = node.axis;
    node.axis = mean_.At(s, own);
    lean = std::max(lean, Atan2(own.cross(node.axis).norm(), own.dot(node.axis)));
    Place(from.segment, Rise(s, side), node);
    if (!nodes_.empty() && s - places_.back() < kOnePlace) {  // both strands' views of one place
      nodes_.back().place = (nodes_.back().place + node.place) / 2;
      return;
    }
    places_.push_back(s);
    nodes_.push_back(node);
  }

  // By which the way must leave the plane of the contour beside it, so that it changes evenly from strand to
  // strand.
  double Rise(double s, size_t side) const {
    double rise = 0;
    const size_t count = way_.samples.size();
    for (const size_t j : rises_) {
      double off = s - mean_.begin(j);
      if (way_.closed && off > mean_.length() / 2) off -= mean_.length();
      if (way_.closed && off < -mean_.length() / 2) off += mean_.length();
      if (std::abs(off) >= mean_.half()) continue;
      const double share = 1 - std::abs(off) / mean_.half();
      const bool after = std::abs(off) < kOnePlace ? (side + count - j) % count < (count + 1) / 2 : off > 0;
      rise += (after ? -share : share) / 2 * way_.samples[j].rise;
    }
    return rise;
  }

  // Beside the contour's part that the way lies beside, as far as its distance, and from all others no less.
  void Place(size_t segment, double rise, OffsetNode& node) const {
    for (int i = 0; i < 3; ++i) {
      double share = 0;
      const Eigen::Vector3d to = FootOf(segment, node, share);
      if (to.norm() < kOnePlace) return;
      const ContourPoint &a = contour_.From(segment), &b = contour_.To(segment);
      node.place =
          a.place + share * (b.place - a.place) + rise * node.axis - options_.distance / to.norm() * to;
    }
    constexpr double kTooNear = 1e-4;  // mm
    for (int i = 0; i < 4; ++i) {
      const NearestOnContour nearest = near_.Nearest(node.place, node.axis);
      if (nearest.distance >= options_.distance - kTooNear || nearest.distance < kOnePlace) return;
      node.place += (options_.distance / nearest.distance - 1) * nearest.off;
    }
  }

  // Along the contour from `segment` on to where it lies nearest.
  Eigen::Vector3d FootOf(size_t& segment, const OffsetNode& node, double& share) const {
    const auto across = [&](size_t at, double& where) {
      return AcrossToSegment(node.place, node.axis, contour_.From(at).place, contour_.To(at).place, where);
    };
    Eigen::Vector3d to = across(segment, share);
    const size_t count = contour_.Segments();
    for (size_t moves = 0; moves < 16 && (share == 0 || share == 1); ++moves) {
      if (!contour_.closed && (share == 0 ? segment == 0 : segment + 1 == count)) break;
      const size_t next = (segment + (share == 0 ? count - 1 : 1)) % count;
      double there = 0;
      const Eigen::Vector3d off = across(next, there);
      if (off.squaredNorm() >= to.squaredNorm()) break;
      segment = next, share = there, to = off;
    }
    return to;
  }

  const Way& way_;
  const Contour& contour_;
  const ContourDistance& near_;
  const OffsetOptions& options_;
  AxisMean mean_;
  bool even_ = false;          // axis and height are the same everywhere
  std::vector<size_t> rises_;  // samples at which the way's height changes
  std::vector<double> places_;
  std::vector<OffsetNode> nodes_;
};

// Which nodes are needed to stay within the chord tolerance, in the surface and at the tip (Douglas and
// Peucker 1973, at half of it); where neighbours are close, those without which the whole is kept go as well.
class Thinning {
 public:
  Thinning(OffsetPath path, const OffsetOptions& options)
      : nodes_(std::move(path.nodes)), closed_(path.closed), options_(options) {
    if (!closed_) return;
    std::ranges::rotate(nodes_, nodes_.begin() + static_cast<std::ptrdiff_t>(SharpestCorner()));
    nodes_.push_back(nodes_.front());
  }

  OffsetPath Thin() {
    const size_t last = nodes_.size() - 1;
    std::vector<char> key(nodes_.size(), 0);
    key[0] = key[last] = 1;
    MarkStraights(key);
    const std::vector<char> ends = key;
    if (closed_) key[Farthest()] = 1;
    for (size_t begin = 0, i = 1; i <= last; ++i)
      if (key[i] != 0) Mark(std::exchange(begin, i), i, key);
    for (size_t i = 0; i <= last; ++i)
      if (key[i] != 0) kept_.push_back(i);
    DropNear(ends);
    if (closed_) kept_.pop_back();
    OffsetPath path{{}, closed_};
    for (const size_t i : kept_) path.nodes.push_back(nodes_[i]);
    return path;
  }

 private:
  size_t SharpestCorner() const {
    const size_t count = nodes_.size();
    size_t found = 0;
    double least = 1 - 1e-6;  // cosine
    for (size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d in = nodes_[i].place - nodes_[(i + count - 1) % count].place;
      const Eigen::Vector3d out = nodes_[(i + 1) % count].place - nodes_[i].place;
      const double straight = in.dot(out) / std::max(kOnePlace, in.norm() * out.norm());
      if (straight < least - 1e-6) least = straight, found = i;
    }
    return found;
  }

  size_t Farthest() const {
    size_t far = 0;
    for (size_t i = 0; i < nodes_.size(); ++i)
      if ((nodes_[i].place - nodes_[0].place).norm() > (nodes_[far].place - nodes_[0].place).norm() + 1e-7)
        far = i;
    return far;
  }

  // The ends of straights that are long beside an arc's chords: left out, they would slant what lies right.
  void MarkStraights(std::vector<char>& key) const {
    const double least = 8 * std::sqrt(2 * options_.chord * options_.distance);
    const auto along = [&](size_t i) -> Eigen::Vector3d {
      return (nodes_[i + 1].place - nodes_[i].place).normalized();
    };
    for (size_t begin = 0; begin + 1 < nodes_.size();) {
      size_t end = begin + 1;
      while (end + 1 < nodes_.size() && (along(end) - along(begin)).norm() < kStraight) ++end;
      if ((nodes_[end].place - nodes_[begin].place).norm() > least) key[begin] = key[end] = 1;
      begin = end;
    }
  }

  // How far node i lies from the straight motion from a to b, at the tip or in the surface.
  double Off(size_t i, size_t a, size_t b) const {
    const OffsetNode &from = nodes_[a], &to = nodes_[b];
    const double t = ClosestOnSegment(nodes_[i].place, from.place, to.place);
    const Eigen::Vector3d off = from.place + t * (to.place - from.place) - nodes_[i].place;
    const Eigen::Vector3d lean = (from.axis + t * (to.axis - from.axis)).normalized() - nodes_[i].axis;
    return std::max(off.norm(), (off - options_.depth * lean).norm());
  }

  void Mark(size_t first, size_t last, std::vector<char>& key) const {
    std::vector<std::pair<size_t, size_t>> spans{{first, last}};
    while (!spans.empty()) {
      const auto [begin, end] = spans.back();
      spans.pop_back();
      double worst = options_.chord / 2;
      size_t corner = begin;
      for (size_t i = begin + 1; i < end; ++i)
        if (const double off = Off(i, begin, end); off > worst + 1e-7) worst = off, corner = i;
      if (corner == begin) continue;
      key[corner] = 1;
      spans.emplace_back(begin, corner);
      spans.emplace_back(corner, end);
    }
  }

  bool Passes(size_t a, size_t b) const {
    for (size_t i = a + 1; i < b; ++i)
      if (Off(i, a, b) > options_.chord) return false;
    return true;
  }

  void DropNear(const std::vector<char>& stays) {
    const auto near = [&](size_t a, size_t b) {
      return (nodes_[kept_[a]].place - nodes_[kept_[b]].place).norm() < kNear;
    };
    for (size_t k = 1; k + 1 < kept_.size() && kept_.size() > 4;)
      if (stays[kept_[k]] == 0 && (near(k - 1, k) || near(k, k + 1)) && Passes(kept_[k - 1], kept_[k + 1]))
        kept_.erase(kept_.begin() + static_cast<std::ptrdiff_t>(k));
      else
        ++k;
  }

  std::vector<OffsetNode> nodes_;  // of a closed way the first again at its end
  bool closed_;
  const OffsetOptions& options_;
  std::vector<size_t> kept_;
};

}  // namespace

OffsetPath SmoothPath(const Way& way, const Contour& contour, const ContourDistance& near,
                      const OffsetOptions& options, double& lean) {
  if (way.samples.size() < 2) return {};
  OffsetPath path = Smoother(way, contour, near, options).Run(lean);
  if (path.nodes.size() < 3) return path;
  return Thinning(std::move(path), options).Thin();
}

}  // namespace millpose
