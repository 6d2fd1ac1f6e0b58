// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim_aside.hpp"

#include <algorithm>

#include "base/rotation.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

Eigen::Vector3d LeftOf(const Eigen::Vector3d& axis, const Eigen::Vector3d& along) {
  return axis.cross(along).normalized();
}

class AsideMaker {
 public:
  AsideMaker(const Contour& contour, const OffsetOptions& options)
      : contour_(contour),
        options_(options),
        inner_(std::max(DegToRad(1), std::min(options.crease, DegToRad(60)))) {}

  Aside Make() {
    aside_.closed = contour_.closed;
    for (size_t i = 0; i < contour_.points.size(); ++i) {
      AddCorner(i);
      if (i < contour_.Segments()) aside_.sides.push_back({SideKind::kAlong, i});
    }
    return std::move(aside_);
  }

 private:
  void AddCorner(size_t i) {
    const size_t count = contour_.points.size();
    const ContourPoint& corner = contour_.points[i];
    const bool first = !contour_.closed && i == 0, last = !contour_.closed && i + 1 == count;
    const Eigen::Vector3d before = corner.place - contour_.points[(i + count - 1) % count].place;
    const Eigen::Vector3d after = contour_.points[(i + 1) % count].place - corner.place;
    if (first || last) return Add(corner, LeftOf(corner.axis, first ? after : before));
    const Eigen::Vector3d in = LeftOf(corner.axis, before), out = LeftOf(corner.axis, after);
    const double turn = Atan2(in.cross(out).dot(corner.axis), in.dot(out));
    // Both sides' meeting point lies d·(1/cos(turn/2) − 1) beyond the arc.
    const double beyond = options_.distance * turn * turn / 8;
    if (turn > 0 ? turn <= inner_ : beyond <= options_.chord / 4) {
      Add(corner, (in + out) / (1 + in.dot(out)));
    } else {
      Add(corner, in);
      if (turn < 0) AddArc(i, in, -turn);
      aside_.sides.push_back({turn > 0 ? SideKind::kAcross : SideKind::kRound, i});
      Add(corner, out);
    }
  }

  // The nodes within the arc.
  void AddArc(size_t i, const Eigen::Vector3d& in, double turn) {
    const double widest =
        2 * std::sqrt(options_.chord / 2 / options_.distance);  // a quarter of the tolerance
    const int steps = std::max(1, static_cast<int>(std::ceil(turn / widest)));
    const ContourPoint& corner = contour_.points[i];
    for (int k = 1; k < steps; ++k) {
      aside_.sides.push_back({SideKind::kRound, i});
      Add(corner, RotationAbout(corner.axis, -turn * k / steps) * in);
    }
  }

  void Add(const ContourPoint& corner, const Eigen::Vector3d& left) {
    aside_.nodes.push_back({corner.place + options_.distance * left, corner.axis});
  }

  const Contour& contour_;
  const OffsetOptions& options_;
  double inner_;  // turns of inner corners up to this, rad, get a single node
  Aside aside_;
};

}  // namespace

OffsetNode Aside::At(size_t side, double share) const {
  const OffsetNode &a = From(side), &b = To(side);
  return {a.place + share * (b.place - a.place), (a.axis + share * (b.axis - a.axis)).normalized()};
}

Aside MovedAside(const Contour& contour, const OffsetOptions& options) {
  return AsideMaker(contour, options).Make();
}

}  // namespace millpose
