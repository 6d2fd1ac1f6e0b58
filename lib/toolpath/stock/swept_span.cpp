// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/swept_span.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "base/trig.hpp"

namespace millpose {

using Eigen::Vector3d;

CutterProfile::CutterProfile(const CutterShape& cutter, double tolerance)
    : radius(cutter.radius), length(cutter.length) {
  const double r = cutter.corner_radius, flat = cutter.radius - r;
  int chords = 0;
  if (r > 0) {
    // A chord of an arc by the angle a lies r (1 − cos(a/2)) ≤ r a²/8 within it.
    const double widest = std::sqrt(8 * tolerance / r);
    chords = std::max(1, static_cast<int>(std::ceil(std::numbers::pi / 2 / widest)));
  }
  const auto at = [&](int i) {
    const SineCosine turned = SinCos(std::numbers::pi / 2 * i / std::max(chords, 1));
    return std::pair(flat + r * turned.sin, r - r * turned.cos);  // radius, height
  };
  for (int i = 0; i < chords; ++i) {
    const auto [narrow, low] = at(i);
    const auto [wide, high] = at(i + 1);
    if (high <= low) continue;
    const double rise = (wide - narrow) / (high - low);
    frusta.push_back({low, high, narrow - rise * low, rise});
  }
  if (length > r) frusta.push_back({r, length, cutter.radius, 0});
}

SweptVolume::SweptVolume(const CutterProfile& profile, const Vector3d& from, const Vector3d& to,
                         const Vector3d& axis)
    : profile_(profile), from_(from), way_(to - from), axis_(axis) {
  // How far a disc across the axis reaches; 1 − x² would make 1e-8 of a rounding error.
  const auto beside = [&](int i) { return Eigen::Vector2d(axis[(i + 1) % 3], axis[(i + 2) % 3]).norm(); };
  const Vector3d across = profile.radius * Vector3d(beside(0), beside(1), beside(2));
  for (const Vector3d& tip : {from, to})
    for (const Vector3d& end : {tip, Vector3d(tip + profile.length * axis)}) {
      box_.extend(end - across);
      box_.extend(end + across);
    }
}

namespace {

constexpr double kInside = 1e-9;  // mm by which a place may lie outside for rounding

/// The values of t and u at which a place of the line, t, meets the frustum whose tip is a share u of the
/// way: 0 ≤ u ≤ 1, low ≤ h ≤ high and |l| ≤ radius + rise h, where height h and what lies across the axis, l,
/// are linear in t and u. This is a bounded convex set of the plane, so its least and greatest t lie where
/// two of its borders meet, or where the conic |l|² = (radius + rise h)² has them itself.
class SpanOfFrustum {
 public:
  SpanOfFrustum(const CutterProfile::Frustum& frustum, const Vector3d& beyond, const Vector3d& direction,
                const Vector3d& way, const Vector3d& axis)
      : f_(frustum),
        h0_(beyond.dot(axis)),
        ht_(direction.dot(axis)),
        hu_(-way.dot(axis)),
        l0_(beyond - h0_ * axis),
        lt_(direction - ht_ * axis),
        lu_(-way - hu_ * axis) {}

  /// Whether all that it can meet is in a span: places of its heights, however far from the axis.
  bool AddsNothingTo(const std::optional<Span>& span) const {
    if (!span || ht_ == 0) return false;
    const double a = (f_.low - h0_) / ht_, b = (f_.high - h0_) / ht_, by = -hu_ / ht_;
    return std::min(a, b) + std::min(0.0, by) >= span->low &&
           std::max(a, b) + std::max(0.0, by) <= span->high;
  }

  void Extend(std::optional<Span>& span) {
    span_ = &span;
    const double w0 = f_.radius + f_.rise * h0_, wt = f_.rise * ht_, wu = f_.rise * hu_;
    tt_ = lt_.squaredNorm() - wt * wt;
    tu_ = lt_.dot(lu_) - wt * wu;
    uu_ = lu_.squaredNorm() - wu * wu;
    t_ = lt_.dot(l0_) - wt * w0;
    u_ = lu_.dot(l0_) - wu * w0;
    c_ = l0_.squaredNorm() - w0 * w0;
    for (const double u : {0.0, 1.0}) {
      // The conic on the border u = const.
      Roots(tt_, t_ + tu_ * u, c_ + (2 * u_ + uu_ * u) * u, [&](double t) { Try(t, u); });
      if (ht_ != 0)
        for (const double h : {f_.low, f_.high}) Try((h - h0_ - hu_ * u) / ht_, u);
    }
    for (const double h : {f_.low, f_.high}) OnHeight(h);
    // Where the conic's tangent runs along u: t u_t + u u_u + u_ = 0.
    if (uu_ != 0)
      Roots(tt_ - tu_ * tu_ / uu_, t_ - tu_ * u_ / uu_, c_ - u_ * u_ / uu_,
            [&](double t) { Try(t, -(tu_ * t + u_) / uu_); });
  }

 private:
  /// a x² + 2 b x + c = 0.
  template <typename Found>
  static void Roots(double a, double b, double c, const Found& found) {
    const double square = b * b - a * c;
    if (square < 0) return;
    const double root = std::sqrt(square), q = b >= 0 ? -b - root : -b + root;
    if (a != 0) found(q / a);
    if (q != 0) found(c / q);
  }

  /// The conic on the border h = const.
  void OnHeight(double h) {
    if (std::abs(ht_) >= std::abs(hu_)) {
      if (ht_ == 0) return;
      const double at = (h - h0_) / ht_, by = -hu_ / ht_;  // t = at + by u
      Roots(uu_ + (2 * tu_ + tt_ * by) * by, u_ + tu_ * at + (tt_ * at + t_) * by,
            c_ + (2 * t_ + tt_ * at) * at, [&](double u) { Try(at + by * u, u); });
    } else {
      const double at = (h - h0_) / hu_, by = -ht_ / hu_;  // u = at + by t
      Roots(tt_ + (2 * tu_ + uu_ * by) * by, t_ + tu_ * at + (uu_ * at + u_) * by,
            c_ + (2 * u_ + uu_ * at) * at, [&](double t) { Try(t, at + by * t); });
    }
  }

  void Try(double t, double u) {
    std::optional<Span>& span = *span_;
    if (span && t >= span->low && t <= span->high) return;
    if (!(u >= -kInside && u <= 1 + kInside)) return;
    const double h = h0_ + ht_ * t + hu_ * u;
    if (h < f_.low - kInside || h > f_.high + kInside) return;
    const double width = f_.radius + f_.rise * h + kInside;
    if ((l0_ + lt_ * t + lu_ * u).squaredNorm() > width * width) return;
    if (!span) span = Span{t, t};
    span->low = std::min(span->low, t);
    span->high = std::max(span->high, t);
  }

  const CutterProfile::Frustum& f_;
  double h0_, ht_, hu_;
  Vector3d l0_, lt_, lu_;
  double tt_, tu_, uu_, t_, u_, c_;  ///< of the conic
  std::optional<Span>* span_ = nullptr;
};

}  // namespace

// Seen along the line: farther from the tip's way than the cutter's shadow reaches.
bool SweptVolume::PassesBeside(const Vector3d& beyond, const Vector3d& direction) const {
  const auto across = [&](const Vector3d& v) -> Vector3d { return v - v.dot(direction) * direction; };
  const Vector3d way = across(way_), place = across(beyond);
  const double square = way.squaredNorm();
  const double share = square > 0 ? std::clamp(place.dot(way) / square, 0.0, 1.0) : 0;
  const double reach = profile_.radius + profile_.length * across(axis_).norm() + kInside;
  return (place - share * way).squaredNorm() > reach * reach;
}

Span SweptVolume::BetweenPlanes(const Vector3d& origin, const Vector3d& direction) const {
  constexpr double kLeast = 0.1;  // cosine of line and axis, below which the planes tell little
  const double rise = direction.dot(axis_);
  if (std::abs(rise) < kLeast)
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  // The height over the tip is start + rise · t − climb · u, u from 0 to 1.
  const double start = (origin - from_).dot(axis_), climb = way_.dot(axis_);
  const double tip = (std::min(0.0, climb) - start) / rise;
  const double end = (profile_.length + std::max(0.0, climb) - start) / rise;
  return {std::min(tip, end), std::max(tip, end)};
}

std::optional<Span> SweptVolume::On(const Vector3d& origin, const Vector3d& direction) const {
  std::optional<Span> span;
  const Vector3d beyond = origin - from_;
  if (PassesBeside(beyond, direction)) return span;
  const auto extend = [&](const CutterProfile::Frustum& frustum) {
    SpanOfFrustum of(frustum, beyond, direction, way_, axis_);
    if (!of.AddsNothingTo(span)) of.Extend(span);
  };
  // The widest and the lowest first: mostly nothing is left for those between.
  extend(profile_.frusta.back());
  for (size_t i = 0; i + 1 < profile_.frusta.size(); ++i) extend(profile_.frusta[i]);
  return span;
}

std::vector<CutterMotion> WithoutTurns(const CutterMotion& motion, double length, double tolerance) {
  const double swing = (motion.to.axis - motion.from.axis).norm() * length;
  // Half a part's turn is the farthest that its mean axis leans from the true one.
  const int parts = std::max(1, static_cast<int>(std::ceil(swing / (2 * tolerance))));
  std::vector<CutterMotion> straight;
  const auto at = [&](double share) -> CutterPlace {
    return {motion.from.tip + share * (motion.to.tip - motion.from.tip),
            (motion.from.axis + share * (motion.to.axis - motion.from.axis)).normalized()};
  };
  for (int i = 0; i < parts; ++i) {
    CutterMotion part{at(static_cast<double>(i) / parts), at(static_cast<double>(i + 1) / parts),
                      motion.pass};
    part.from.axis = part.to.axis = at((i + 0.5) / parts).axis;
    straight.push_back(part);
  }
  return straight;
}

}  // namespace millpose
