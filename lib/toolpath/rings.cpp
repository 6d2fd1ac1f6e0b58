// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cylinder_slices.hpp"
#include "surface/triangle.hpp"
#include "toolpath/spread.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

// Smallest distance of a convex polygon's points from the axis: 0 where the axis passes through it, else on a
// side.
double LeastRadius(const std::vector<Eigen::Vector3d>& polygon, const Axis& axis) {
  const auto flat = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector3d d = p - axis.point;
    return d - d.dot(axis.direction) * axis.direction;
  };
  double least = std::numeric_limits<double>::infinity();
  bool left = true, right = true;  // the axis lies on one side of all sides
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d a = flat(polygon[i]), b = flat(polygon[(i + 1) % polygon.size()]);
    const double t = ClosestOnSegment(Eigen::Vector3d::Zero(), a, b);
    least = std::min(least, (a + t * (b - a)).norm());
    const double side = axis.direction.dot(a.cross(b));
    left = left && side > 0;
    right = right && side < 0;
  }
  return left || right ? 0.0 : least;
}

// How a patch lies to the cylinders: radii, and the least share of a radial step that runs along the surface.
Stretch StretchOf(const Region::Patch& patch, const Eigen::Vector3d& normal, const Axis& axis) {
  Stretch stretch{LeastRadius(patch.corners, axis), 0, 1};
  double rise = 1;
  for (const Eigen::Vector3d& p : patch.corners) {
    const double radius = axis.Radius(p);
    stretch.upper = std::max(stretch.upper, radius);
    const Eigen::Vector3d d = p - axis.point, radial = d - d.dot(axis.direction) * axis.direction;
    if (radius > 0) rise = std::min(rise, normal.cross(radial).norm() / radius);
  }
  stretch.slope = 1 / std::max(1e-9, rise);
  return stretch;
}

class Rings : public Strategy {
 public:
  std::vector<Lane> Lanes(const Mesh& mesh, const Region& region, const ToolpathOptions& options,
                          std::stop_token stop) const override {
    const Axis axis{options.axis_point, options.axis_direction};
    double lower = std::numeric_limits<double>::infinity(), upper = 0;
    std::vector<Stretch> stretches;
    for (const Region::Patch& patch : region.Patches()) {
      stretches.push_back(StretchOf(patch, mesh.FaceNormal(patch.face), axis));
      lower = std::min(lower, stretches.back().lower);
      upper = std::max(upper, stretches.back().upper);
    }
    if (lower > upper) return {};
    const double rim = options.region.rim_distance;
    if (upper - lower > 2 * rim) {
      lower += lower > 0 ? rim : 0;
      upper -= rim;
    }
    const Eigen::Vector3d zero = ZeroDirection(options);
    const Eigen::Vector3d quarter = axis.direction.cross(zero);
    std::vector<Lane> lanes;
    const std::vector<double> radii = options.stepover_on_surface
                                          ? SpreadOnSurface(stretches, lower, upper, options.stepover)
                                          : SpreadEvenly(lower, upper, options.stepover);
    for (auto& curves : SliceByCylinders(mesh, axis, radii, stop)) {
      for (Curve& curve : curves) MoveSeam(curve, zero);
      const auto progress = [=](const Eigen::Vector3d& p) {
        const Eigen::Vector3d d = p - axis.point;
        const double angle = std::atan2(d.dot(quarter), d.dot(zero));
        return angle < 0 ? angle + 2 * kPi : angle;
      };
      lanes.push_back({std::move(curves), progress, options.zigzag && lanes.size() % 2 == 1});
    }
    return lanes;
  }

 private:
  // Rings begin in the direction of the rotation reference, seen along the axis.
  static Eigen::Vector3d ZeroDirection(const ToolpathOptions& options) {
    const Eigen::Vector3d& axis = options.axis_direction;
    const Eigen::Vector3d flat = options.rotation_reference - options.rotation_reference.dot(axis) * axis;
    return flat.norm() > 1e-6 ? Eigen::Vector3d(flat.normalized()) : axis.unitOrthogonal();
  }

  // A closed ring begins exactly where it is farthest along `zero`.
  static void MoveSeam(Curve& curve, const Eigen::Vector3d& zero) {
    if (!curve.closed) return;
    size_t seam = 0;
    double best = -std::numeric_limits<double>::infinity(), at = 0;
    for (size_t i = 0; i < curve.pieces.size(); ++i) {
      const CurvePiece& piece = curve.pieces[i];
      for (const double t : {0.0, piece.arc ? Apex(piece, zero) : 0.0})
        if (const double height = zero.dot(piece.At(t)); height > best + 1e-9) {
          best = height;
          seam = i;
          at = t;
        }
    }
    std::rotate(curve.pieces.begin(), curve.pieces.begin() + static_cast<std::ptrdiff_t>(seam),
                curve.pieces.end());
    if (at <= 0) return;
    const CurvePiece whole = curve.pieces.front();
    curve.pieces.front() = whole.Part(at, 1);
    curve.pieces.push_back(whole.Part(0, at));
  }

  // Parameter at which an arc is farthest along `zero`, or 0 when that is not between its ends.
  static double Apex(const CurvePiece& piece, const Eigen::Vector3d& zero) {
    double angle = std::atan2(zero.dot(piece.v), zero.dot(piece.u));
    const double low = std::min(piece.angle0, piece.angle1), high = std::max(piece.angle0, piece.angle1);
    while (angle < low) angle += 2 * kPi;
    while (angle - 2 * kPi >= low) angle -= 2 * kPi;
    const double t = (angle - piece.angle0) / (piece.angle1 - piece.angle0);
    return angle <= high && t > 1e-9 && t < 1 - 1e-9 ? t : 0.0;
  }
};

}  // namespace

std::unique_ptr<Strategy> MakeRings() { return std::make_unique<Rings>(); }

}  // namespace millpose
