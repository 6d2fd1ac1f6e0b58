// SPDX-License-Identifier: GPL-3.0-or-later
#include "cell/apart.hpp"

#include <algorithm>
#include <cmath>

namespace millpose {
namespace {

/// What rounding may have added to a bound, mm: cells are some 10⁴ mm wide.
constexpr double kRounding = 1e-8;

/// Gap between the intervals [−half, half] and [lower, upper], componentwise; negative where they overlap.
Eigen::Vector3d Gap(const Eigen::Vector3d& half, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  return (lower - half).cwiseMax(-half - upper);
}

/// Distance of the origin from the segment between two points of the plane, squared.
double SegmentSquare(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp(-a.dot(along) / length, 0.0, 1.0) : 0.0;
  return (a + share * along).squaredNorm();
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Distance of the origin from a triangle of the plane; 0 inside.
double FlatDistance(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double ab = Cross(a, b), bc = Cross(b, c), ca = Cross(c, a);
  if ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0)) return 0;
  return std::sqrt(std::min({SegmentSquare(a, b), SegmentSquare(b, c), SegmentSquare(c, a)}));
}

/// Looks for planes between one body and the triangles of a mesh.
class Search {
 public:
  Search(const Envelope& body, const Pose& X_MG, const TriangleTree& mesh, double bound, double enough)
      : body_(body),
        mesh_(mesh),
        R_GM_(X_MG.linear().transpose()),
        centre_(X_MG * body.centre),
        extent_(X_MG.linear().cwiseAbs() * body.half),
        abs_R_GM_(R_GM_.cwiseAbs()),
        best_(bound + kRounding),
        enough_(enough + kRounding) {}

  double Run() {
    if (!mesh_.empty()) Visit(0, NodeBound(mesh_.nodes()[0]));
    return std::max(0.0, best_ - kRounding);
  }

 private:
  /// Separation of the body's box and a node's along the axes of both.
  double NodeBound(const TriangleTree::Node& node) const {
    const Eigen::Vector3d middle = 0.5 * (node.lower + node.upper) - centre_;
    const Eigen::Vector3d half = 0.5 * (node.upper - node.lower);
    const double aligned = (middle.cwiseAbs() - half - extent_).cwiseMax(0.0).squaredNorm();
    if (aligned >= best_ * best_) return std::sqrt(aligned);
    const double own =
        ((R_GM_ * middle).cwiseAbs() - abs_R_GM_ * half - body_.half).cwiseMax(0.0).squaredNorm();
    return std::sqrt(std::max(aligned, own));
  }

  void Visit(int index, double node_bound) {
    if (node_bound >= best_ || best_ < enough_) return;
    const TriangleTree::Node& node = mesh_.nodes()[index];
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count && best_ >= enough_; ++i) {
        best_ = std::min(best_, TriangleBound(mesh_.triangles()[i]));
      }
      return;
    }
    const int left = index + 1, right = node.right;
    const double a = NodeBound(mesh_.nodes()[left]), b = NodeBound(mesh_.nodes()[right]);
    // The nearer first: it lowers the bound that the other is held against.
    Visit(a <= b ? left : right, std::min(a, b));
    Visit(a <= b ? right : left, std::max(a, b));
  }

  /// The widest gap found between the body and a triangle, 0 or more; no further than what is better than the
  /// best.
  double TriangleBound(const TriangleTree::Corners& corners) const {
    const Eigen::Vector3d a = R_GM_ * (corners[0] - centre_), b = R_GM_ * (corners[1] - centre_),
                          c = R_GM_ * (corners[2] - centre_);
    const Eigen::Vector3d gap = Gap(body_.half, a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c));
    double widest = gap.cwiseMax(0.0).norm();
    if (widest >= best_) return widest;
    const Eigen::Vector3d ab = b - a, bc = c - b, ca = a - c;
    const Eigen::Vector3d normal = ab.cross(bc);
    if (const double length = normal.norm(); length > 0) {
      widest = std::max(widest, (std::abs(normal.dot(a)) - Extent(normal)) / length);
      if (widest >= best_) return widest;
    }
    if (body_.radius > 0) {
      const double across = std::max(0.0, FlatDistance(a.head<2>(), b.head<2>(), c.head<2>()) - body_.radius);
      const double along = std::max(0.0, gap.z());
      return std::max(widest, std::sqrt(across * across + along * along));
    }
    for (const Eigen::Vector3d* edge : {&ab, &bc, &ca}) {
      widest = std::max(widest, EdgeGap(a, b, c, *edge));
      if (widest >= best_) return widest;
    }
    return widest;
  }

  /// The body's extent to either side of its centre along a direction, times the direction's length.
  double Extent(const Eigen::Vector3d& direction) const {
    const double box = direction.cwiseAbs().dot(body_.half);
    if (body_.radius == 0) return box;
    return std::min(box,
                    body_.radius * direction.head<2>().norm() + body_.half.z() * std::abs(direction.z()));
  }

  /// The widest gap along the directions square to an edge of the triangle and one of the box.
  double EdgeGap(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                 const Eigen::Vector3d& edge) const {
    double widest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis).cross(edge);
      const double length = direction.norm();
      if (length == 0) continue;
      const double pa = direction.dot(a), pb = direction.dot(b), pc = direction.dot(c);
      const double extent = direction.cwiseAbs().dot(body_.half);
      const double gap = std::max(std::min({pa, pb, pc}) - extent, -extent - std::max({pa, pb, pc}));
      widest = std::max(widest, gap / length);
    }
    return widest;
  }

  const Envelope& body_;
  const TriangleTree& mesh_;
  const Eigen::Matrix3d R_GM_;
  const Eigen::Vector3d centre_, extent_;  // mesh frame; of the body's box along the mesh's axes
  const Eigen::Matrix3d abs_R_GM_;
  double best_, enough_;
};

struct RadiusOf {
  const Eigen::Vector3d& centre;
  double operator()(const Sphere& sphere) const { return sphere.radius; }
  double operator()(const Cylinder& cylinder) const { return cylinder.radius; }
  double operator()(const Capsule& capsule) const { return capsule.radius; }
  double operator()(const Cone& cone) const { return std::max(cone.radius_bottom, cone.radius_top); }
  double operator()(const Convex& convex) const {
    double square = 0;
    for (const Eigen::Vector3d& p : convex.points)
      square = std::max(square, (p - centre).head<2>().squaredNorm());
    return std::sqrt(square);
  }
  double operator()(const Box&) const { return 0; }
  double operator()(const Triangles&) const { return 0; }
};

}  // namespace

Envelope EnvelopeOf(const Shape& shape, const Eigen::Vector3d& centre, const Eigen::Vector3d& half) {
  Envelope envelope{centre, half, std::visit(RadiusOf{centre}, shape)};
  // A hull is taken as round only where the cylinder is the smaller one.
  const bool hull = std::holds_alternative<Convex>(shape);
  if (hull && 3 * envelope.radius * envelope.radius > 4 * half.x() * half.y()) envelope.radius = 0;
  return envelope;
}

double LeastDistance(const Envelope& body, const Pose& X_MG, const TriangleTree& mesh, double bound,
                     double enough) {
  return Search(body, X_MG, mesh, bound, enough).Run();
}

}  // namespace millpose
