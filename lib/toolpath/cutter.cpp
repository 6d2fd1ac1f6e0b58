// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cutter.hpp"

namespace millpose {
namespace {

// The greatest value of a concave function on 0..1 by golden section.
template <typename Function>
double Greatest(Function f, double& at) {
  constexpr double kGolden = 0.6180339887498949;
  double a = 0, b = 1, x = 1 - kGolden, y = kGolden;
  double fx = f(x), fy = f(y);
  for (int i = 0; i < 40; ++i) {
    if (fx < fy) {
      a = x, x = y, fx = fy;
      y = a + kGolden * (b - a), fy = f(y);
    } else {
      b = y, y = x, fy = fx;
      x = b - kGolden * (b - a), fx = f(x);
    }
  }
  // Corners matter: a golden section only comes near the ends.
  at = x;
  double best = fx;
  for (const double end : {0.0, 1.0})
    if (const double value = f(end); value > best) {
      best = value;
      at = end;
    }
  return best;
}

// Depth of a point given in the tool's frame; outside the radius the cutter's side goes on downwards steeply,
// which keeps the function concave and never above 0 there.
double DepthAt(const CutterShape& cutter, const Eigen::Vector3d& p, double steep) {
  const double distance = std::hypot(p.x(), p.y());
  if (distance <= cutter.radius) return p.z() - cutter.Bottom(distance);
  return p.z() - cutter.Bottom(cutter.radius) - steep * (distance - cutter.radius);
}

}  // namespace

double CutterShape::Bottom(double distance) const {
  const double beyond = std::max(0.0, distance - (radius - corner_radius));
  return corner_radius - std::sqrt(std::max(0.0, corner_radius * corner_radius - beyond * beyond));
}

Eigen::Vector3d TipAtContact(const CutterShape& cutter, const Eigen::Vector3d& contact,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d across = normal - normal.dot(axis) * axis;
  const double r = cutter.corner_radius;
  Eigen::Vector3d tip = contact + r * (normal - axis);
  if (across.norm() > 1e-9) tip += (cutter.radius - r) * across.normalized();
  return tip;
}

Gouge DeepestGouge(const Mesh& mesh, const CutterShape& cutter, const Eigen::Vector3d& tip,
                   const Eigen::Vector3d& axis, double tolerance) {
  Eigen::Matrix3d R;  // rows: the tool's axes
  R.row(0) = axis.unitOrthogonal();
  R.row(2) = axis;
  R.row(1) = axis.cross(R.row(0).transpose());
  Gouge deepest{tolerance, Eigen::Vector3d::Zero(), -1};
  const double reach = std::hypot(cutter.radius, cutter.length / 2);
  for (const int face : mesh.FacesNear(tip + axis * cutter.length / 2, reach)) {
    std::array<Eigen::Vector3d, 3> corner;
    for (int k = 0; k < 3; ++k) corner[k] = R * (mesh.Corner(face, k) - tip);
    if (std::max({corner[0].z(), corner[1].z(), corner[2].z()}) <= deepest.depth) continue;
    const double span = (corner[1] - corner[0]).norm() + (corner[2] - corner[0]).norm() + cutter.length;
    const double steep = 1e3 * (1 + span / std::max(cutter.radius, 1e-6));
    double s = 0, t = 0;
    const auto at = [&](double u, double v) -> Eigen::Vector3d {
      return corner[0] + u * ((corner[1] - corner[0]) + v * (corner[2] - corner[1]));
    };
    const double depth = Greatest(
        [&](double u) { return Greatest([&](double v) { return DepthAt(cutter, at(u, v), steep); }, t); }, s);
    if (depth <= deepest.depth) continue;
    Greatest([&](double v) { return DepthAt(cutter, at(s, v), steep); }, t);
    const Eigen::Vector3d place = at(s, t);
    if (place.z() <= cutter.length) deepest = {depth, tip + R.transpose() * place, face};
  }
  if (deepest.face < 0) deepest.depth = 0;
  return deepest;
}

}  // namespace millpose
