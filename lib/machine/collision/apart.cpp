// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/apart.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

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

/// The point of a triangle that is nearest to `p` (Ericson 2005, section 5.1.5).
Eigen::Vector3d NearestOfTriangle(const TriangleTree::Corners& corners, const Eigen::Vector3d& p) {
  const auto& [a, b, c] = corners;
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac;
}

/// The point of a body that is nearest to `p`, about the body's centre.
Eigen::Vector3d NearestOfBody(const Envelope& body, const Eigen::Vector3d& p) {
  if (body.kind == Envelope::Kind::kBox) return p.cwiseMax(-body.half).cwiseMin(body.half);
  if (body.kind == Envelope::Kind::kCylinder) {
    Eigen::Vector3d q(p.x(), p.y(), std::clamp(p.z(), -body.half.z(), body.half.z()));
    if (const double away = q.head<2>().norm(); away > body.radius) q.head<2>() *= body.radius / away;
    return q;
  }
  const Eigen::Vector3d on_core(0, 0, std::clamp(p.z(), -body.core, body.core));
  const double away = (p - on_core).norm();
  return away > body.radius ? Eigen::Vector3d(on_core + body.radius / away * (p - on_core)) : p;
}

/// The farthest point of a body along `n` (unit), about the body's centre.
Eigen::Vector3d FarthestOfBody(const Envelope& body, const Eigen::Vector3d& n) {
  const auto along_z = [&](double half) { return n.z() < 0 ? -half : half; };
  if (body.kind == Envelope::Kind::kBox)
    return body.half.cwiseProduct(n.unaryExpr([](double v) { return v < 0 ? -1.0 : 1.0; }));
  if (body.kind == Envelope::Kind::kCylinder) {
    const double across = n.head<2>().norm(), scale = across > 0 ? body.radius / across : 0;
    return {scale * n.x(), scale * n.y(), along_z(body.half.z())};
  }
  return body.radius * n + Eigen::Vector3d(0, 0, along_z(body.core));
}

/// A triangle, and a second body, about the centre of the first.
struct TriangleBeside {
  const TriangleTree::Corners& corners;
  Eigen::Vector3d Nearest(const Eigen::Vector3d& p) const { return NearestOfTriangle(corners, p); }
  Eigen::Vector3d Farthest(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d* farthest = &corners[0];
    for (const Eigen::Vector3d& corner : corners) {
      if (n.dot(corner) > n.dot(*farthest)) farthest = &corner;
    }
    return *farthest;
  }
};
struct BodyBeside {
  const Envelope& body;
  const Pose& X_AB;  ///< of the centres
  Eigen::Vector3d Nearest(const Eigen::Vector3d& p) const {
    return X_AB * NearestOfBody(body, X_AB.inverse(Eigen::Isometry) * p);
  }
  Eigen::Vector3d Farthest(const Eigen::Vector3d& n) const {
    return X_AB * FarthestOfBody(body, X_AB.linear().transpose() * n);
  }
};

/// Brackets the distance of something convex (about the body's centre) from a body: nearest points are
/// carried to and fro, and each pair of them says how far it is at most, and the planes square to it how far
/// at least.
template <class Other>
DistanceBracket BracketBeside(const Envelope& body, const Other& other) {
  constexpr int kRounds = 8;
  constexpr double kTight = 1e-7;  // mm
  DistanceBracket found{0, std::numeric_limits<double>::infinity()};
  Eigen::Vector3d p = other.Nearest(Eigen::Vector3d::Zero()), q = NearestOfBody(body, p);
  for (int round = 0; round < kRounds; ++round) {
    const double apart = (p - q).norm();
    found.most = std::min(found.most, apart);
    if (apart < kTight) return found;
    const Eigen::Vector3d n = (p - q) / apart, farthest = FarthestOfBody(body, n),
                          nearest = other.Farthest(-n);
    found.least = std::max(found.least, n.dot(nearest) - n.dot(farthest));
    if (found.most - found.least < kTight) break;
    // From where the planes touch, or on from where the points are: whatever is nearer.
    const Eigen::Vector3d on_body = NearestOfBody(body, nearest), on_other = other.Nearest(farthest);
    const Eigen::Vector3d next = other.Nearest(q);
    const double by_nearest = (nearest - on_body).norm(), by_farthest = (on_other - farthest).norm();
    p = next, q = NearestOfBody(body, next);
    double least = (p - q).norm();
    if (by_nearest < least) p = nearest, q = on_body, least = by_nearest;
    if (by_farthest < least) p = on_other, q = farthest;
  }
  return found;
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

  /// As BracketDistance; `enough` is its `near`.
  DistanceBracket RunBracket() {
    const double bound = best_;
    if (!mesh_.empty()) VisitBracket(0, NodeBound(mesh_.nodes()[0]));
    const double least = most_ < enough_ ? 0 : std::min(least_, bound);
    return {std::max(0.0, least - kRounding), most_ + kRounding};
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

  /// Here best_ is the smaller of the bound and what the distance is at most.
  void VisitBracket(int index, double node_bound) {
    if (node_bound >= best_ || most_ < enough_) return;
    const TriangleTree::Node& node = mesh_.nodes()[index];
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count && most_ >= enough_; ++i) {
        TriangleTree::Corners corners = mesh_.triangles()[i];
        if (TriangleBound(corners) >= best_) continue;
        for (Eigen::Vector3d& corner : corners) corner = R_GM_ * (corner - centre_);
        const DistanceBracket found = BracketBeside(body_, TriangleBeside{corners});
        least_ = std::min(least_, found.least);
        most_ = std::min(most_, found.most);
        best_ = std::min(best_, most_);
      }
      return;
    }
    const int left = index + 1, right = node.right;
    const double a = NodeBound(mesh_.nodes()[left]), b = NodeBound(mesh_.nodes()[right]);
    VisitBracket(a <= b ? left : right, std::min(a, b));
    VisitBracket(a <= b ? right : left, std::max(a, b));
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
  double least_ = std::numeric_limits<double>::infinity(), most_ = least_;
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
  using Kind = Envelope::Kind;
  if (std::holds_alternative<Box>(shape)) envelope.kind = Kind::kBox;
  if (std::holds_alternative<Cylinder>(shape)) envelope.kind = Kind::kCylinder;
  if (std::holds_alternative<Sphere>(shape)) envelope.kind = Kind::kRounded;
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    envelope.kind = Kind::kRounded;
    envelope.core = 0.5 * capsule->length;
  }
  return envelope;
}

double LeastDistance(const Envelope& body, const Pose& X_MG, const TriangleTree& mesh, double bound,
                     double enough) {
  return Search(body, X_MG, mesh, bound, enough).Run();
}

DistanceBracket BracketDistance(const Envelope& body, const Pose& X_MG, const TriangleTree& mesh,
                                double bound, double near) {
  assert(body.kind != Envelope::Kind::kHull);
  return Search(body, X_MG, mesh, bound, near).RunBracket();
}

DistanceBracket BracketDistance(const Envelope& a, const Pose& X_AB, const Envelope& b) {
  assert(a.kind != Envelope::Kind::kHull && b.kind != Envelope::Kind::kHull);
  Pose centres = X_AB;  // of b's centre about a's
  centres.translation() = X_AB * b.centre - a.centre;
  const DistanceBracket found = BracketBeside(a, BodyBeside{b, centres});
  return {std::max(0.0, found.least - kRounding), found.most + kRounding};
}

}  // namespace millpose
