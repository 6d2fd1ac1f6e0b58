// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/fcl_part.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include "machine/collision/cutter.hpp"

namespace millpose {
namespace {

constexpr double kSameLength = 1e-3;  // mm; what GJK leaves of lengths and places

using Geometry = std::shared_ptr<const fcl::CollisionGeometryd>;

Geometry MakeConvex(const std::vector<Eigen::Vector3d>& points) {
  // No faces: FCL then looks for extreme vertices by going through all of them, which needs no topology.
  return std::make_shared<fcl::Convexd>(std::make_shared<const std::vector<Eigen::Vector3d>>(points), 0,
                                        std::make_shared<const std::vector<int>>());
}

struct GeometryOf {
  Geometry operator()(const Box& box) const { return std::make_shared<fcl::Boxd>(box.size); }
  Geometry operator()(const Sphere& s) const { return std::make_shared<fcl::Sphered>(s.radius); }
  Geometry operator()(const Cylinder& c) const {
    return std::make_shared<fcl::Cylinderd>(c.radius, c.length);
  }
  Geometry operator()(const Capsule& c) const { return std::make_shared<fcl::Capsuled>(c.radius, c.length); }
  Geometry operator()(const Cone& cone) const { return MakeConvex(AroundFrustum(cone).points); }
  Geometry operator()(const Convex& convex) const { return MakeConvex(convex.points); }
  Geometry operator()(const Triangles& mesh) const {
    auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    std::vector<fcl::Triangle> faces;
    for (const auto& f : mesh.faces) faces.emplace_back(f[0], f[1], f[2]);
    model->beginModel(static_cast<int>(faces.size()), static_cast<int>(mesh.vertices.size()));
    model->addSubModel(mesh.vertices, faces);
    model->endModel();
    return model;
  }
};

/// The farthest point of a convex shape along `d`, shape frame.
struct SupportOf {
  Eigen::Vector3d d;
  Eigen::Vector3d Disc(double radius) const {
    const double across = d.head<2>().norm();
    if (across < 1e-300) return Eigen::Vector3d::Zero();
    return Eigen::Vector3d(d.x() * radius / across, d.y() * radius / across, 0);
  }
  Eigen::Vector3d operator()(const Box& box) const {
    return 0.5 * box.size.cwiseProduct(d.unaryExpr([](double v) { return v < 0 ? -1.0 : 1.0; }));
  }
  Eigen::Vector3d operator()(const Sphere& s) const { return s.radius * d.normalized(); }
  Eigen::Vector3d operator()(const Cylinder& c) const {
    return Disc(c.radius) + Eigen::Vector3d(0, 0, d.z() < 0 ? -c.length / 2 : c.length / 2);
  }
  Eigen::Vector3d operator()(const Capsule& c) const {
    return c.radius * d.normalized() + Eigen::Vector3d(0, 0, d.z() < 0 ? -c.length / 2 : c.length / 2);
  }
  Eigen::Vector3d operator()(const Cone&) const {
    assert(false && "frusta are kept as convex shapes");
    return Eigen::Vector3d::Zero();
  }
  Eigen::Vector3d operator()(const Convex& convex) const {
    const auto less = [&](const auto& a, const auto& b) { return a.dot(d) < b.dot(d); };
    return *std::max_element(convex.points.begin(), convex.points.end(), less);
  }
  Eigen::Vector3d operator()(const Triangles&) const {
    assert(false && "meshes have no support function");
    return Eigen::Vector3d::Zero();
  }
};

double Reach(const Placed& body, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d local = body.X_WG.linear().transpose() * direction;
  return direction.dot(body.X_WG * std::visit(SupportOf{local}, body.part->shape));
}

/// Distance between the supporting planes of two convex parts across `direction` (unit, from a to b): never
/// more than their distance; negative when their extents overlap.
double Separation(const Placed& a, const Placed& b, const Eigen::Vector3d& direction) {
  return -Reach(b, -direction) - Reach(a, direction);
}

Eigen::Vector3d Interior(const Placed& body) { return body.X_WG * body.part->interior; }

/// Largest separation (so least overlap) over the box axes of both, their cross products and the line of
/// centres.
double LeastOverlap(const Placed& a, const Placed& b) {
  std::vector<Eigen::Vector3d> directions{Interior(b) - Interior(a)};
  for (int i = 0; i < 3; ++i) {
    directions.push_back(a.X_WG.linear().col(i));
    directions.push_back(b.X_WG.linear().col(i));
    for (int j = 0; j < 3; ++j) directions.push_back(a.X_WG.linear().col(i).cross(b.X_WG.linear().col(j)));
  }
  double best = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& d : directions) {
    if (d.norm() < 1e-9) continue;
    best = std::max({best, Separation(a, b, d.normalized()), Separation(a, b, -d.normalized())});
  }
  return best;
}

/// The widest gap between two convex parts along the same directions, as soon as it reaches `enough`.
double WidestGap(const Placed& a, const Placed& b, double enough) {
  double widest = -std::numeric_limits<double>::infinity();
  const auto along = [&](const Eigen::Vector3d& d) {
    const double length = d.norm();
    if (length < 1e-9) return false;
    widest = std::max({widest, Separation(a, b, d / length), Separation(a, b, -d / length)});
    return widest >= enough;
  };
  if (along(Interior(b) - Interior(a))) return widest;
  for (int i = 0; i < 3; ++i) {
    if (along(a.X_WG.linear().col(i)) || along(b.X_WG.linear().col(i))) return widest;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (along(a.X_WG.linear().col(i).cross(b.X_WG.linear().col(j)))) return widest;
    }
  }
  return widest;
}

/// A point that lies in the world boxes of both, or between them.
Eigen::Vector3d BetweenBoxes(const Placed& a, const Placed& b) {
  const auto lower = [](const Placed& p) -> Eigen::Vector3d {
    return p.centre - p.half_axes.cwiseAbs().rowwise().sum();
  };
  const auto upper = [](const Placed& p) -> Eigen::Vector3d {
    return p.centre + p.half_axes.cwiseAbs().rowwise().sum();
  };
  return 0.5 * (lower(a).cwiseMax(lower(b)) + upper(a).cwiseMin(upper(b)));
}

bool InGrownBox(const Placed& body, const Eigen::Vector3d& p, double by) {
  const Eigen::Vector3d local = body.X_WG.linear().transpose() * (p - body.centre);
  return (local.cwiseAbs() - body.part->half).maxCoeff() <= by;
}

std::array<Eigen::Vector3d, 2> Twice(const Eigen::Vector3d& place) { return {place, place}; }

/// The nearest points of two parts as ends of the way between them; FCL 0.7 gives those of a mesh and a shape
/// at times in the other order, of a mesh and a sphere none at all.
std::array<Eigen::Vector3d, 2> EndsOf(const fcl::DistanceResultd& result, const Placed& a, const Placed& b) {
  const Eigen::Vector3d &p = result.nearest_points[0], &q = result.nearest_points[1];
  if (std::abs((q - p).norm() - result.min_distance) <= kSameLength) {
    if (InGrownBox(a, p, kSameLength) && InGrownBox(b, q, kSameLength)) return {p, q};
    if (InGrownBox(a, q, kSameLength) && InGrownBox(b, p, kSameLength)) return {q, p};
  }
  const Eigen::Vector3d between = 0.5 * (p + q);
  const bool plausible =
      InGrownBox(a, between, result.min_distance) && InGrownBox(b, between, result.min_distance);
  return Twice(plausible ? between : BetweenBoxes(a, b));
}

fcl::DistanceResultd FclDistance(const Placed& a, const Placed& b, double bound) {
  fcl::DistanceRequestd request;
  request.enable_nearest_points = true;
  request.enable_signed_distance = false;  // signed distances go through EPA, whose asserts end the process
  fcl::DistanceResultd result(bound);
  fcl::distance(a.part->geometry.get(), a.X_WG, b.part->geometry.get(), b.X_WG, request, result);
  return result;
}

BoundedDistance ConvexDistance(const Placed& a, const Placed& b, double bound) {
  const fcl::DistanceResultd result = FclDistance(a, b, std::numeric_limits<double>::max());
  if (result.min_distance <= 0) return {std::min(0.0, LeastOverlap(a, b)), Twice(BetweenBoxes(a, b))};
  const Eigen::Vector3d &p = result.nearest_points[0], &q = result.nearest_points[1];
  // GJK stops when it no longer advances, at times early: what two parallel planes show is certain.
  double distance = 0;
  if ((q - p).norm() > 0) distance = std::max(0.0, Separation(a, b, (q - p).normalized()));
  distance = std::min(distance, result.min_distance);
  return {std::min(distance, bound), EndsOf(result, a, b)};
}

bool Swallows(const Placed& outer, const Placed& inner) {
  if (!outer.part->mesh() || !outer.part->solid->closed()) return false;
  const Pose X_OuterInner = outer.X_WG.inverse(Eigen::Isometry) * inner.X_WG;
  if (!inner.part->mesh()) return outer.part->solid->Contains(X_OuterInner * inner.part->interior);
  for (const Eigen::Vector3d& p : inner.part->solid->representatives()) {
    if (outer.part->solid->Contains(X_OuterInner * p)) return true;
  }
  return false;
}

BoundedDistance MeshDistance(const Placed& a, const Placed& b, double bound) {
  const fcl::DistanceResultd result = FclDistance(a, b, bound);
  if (result.min_distance < bound) {
    if (result.min_distance <= 0) return {0, Twice(BetweenBoxes(a, b))};
    return {result.min_distance, EndsOf(result, a, b)};
  }
  if (Swallows(a, b)) return {0, Twice(b.centre)};
  if (Swallows(b, a)) return {0, Twice(a.centre)};
  return {bound};
}

}  // namespace

FclPart MakePart(const Shape& shape) {
  FclPart part;
  part.shape = shape;
  if (const auto* cone = std::get_if<Cone>(&shape)) part.shape = AroundFrustum(*cone);
  auto geometry = std::const_pointer_cast<fcl::CollisionGeometryd>(std::visit(GeometryOf{}, part.shape));
  geometry->computeLocalAABB();
  part.centre = geometry->aabb_local.center();
  part.half = 0.5 * (geometry->aabb_local.max_ - geometry->aabb_local.min_);
  part.radius = part.half.norm();
  if (const auto* convex = std::get_if<Convex>(&part.shape)) {
    for (const auto& p : convex->points) part.interior += p / static_cast<double>(convex->points.size());
    part.radius = 0;
    for (const auto& p : convex->points) part.radius = std::max(part.radius, (p - part.centre).norm());
  }
  part.envelope = EnvelopeOf(part.shape, part.centre, part.half);
  if (const auto* mesh = std::get_if<Triangles>(&part.shape)) {
    part.solid = std::make_shared<const Solid>(*mesh);
    part.shape = Triangles{};  // FCL and Solid have it
  }
  part.geometry = std::move(geometry);
  return part;
}

Placed PlacePart(const FclPart& part, const Pose& X_WG) {
  return {&part, X_WG, X_WG * part.centre, X_WG.linear() * part.half.asDiagonal()};
}

namespace {

/// The gap between two boxes, as seen along the axes of `side`'s: in the corner region of one box outside of
/// the other's extent along several of them.
double GapAlongAxes(const Placed& side, const Placed& other, const Eigen::Vector3d& between) {
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const auto axis = side.X_WG.linear().col(i);
    double gap = std::abs(axis.dot(between)) - side.part->half[i];
    for (int k = 0; k < 3 && gap > 0; ++k) gap -= std::abs(axis.dot(other.half_axes.col(k)));
    if (gap > 0) square += gap * gap;
  }
  return std::sqrt(square);
}

}  // namespace

double BoxDistance(const Placed& a, const Placed& b) {
  const Eigen::Vector3d between = b.centre - a.centre;
  const double spheres = between.norm() - a.part->radius - b.part->radius;
  return std::max({spheres, GapAlongAxes(a, b, between), GapAlongAxes(b, a, between), 0.0});
}

bool BoxesApart(const Placed& a, const Placed& b, double bound) {
  const Eigen::Vector3d between = b.centre - a.centre;
  return bound <= 0 || between.norm() - a.part->radius - b.part->radius >= bound ||
         GapAlongAxes(a, b, between) >= bound || GapAlongAxes(b, a, between) >= bound;
}

bool ApartFromStill(const Placed& still, const Placed& part, double bound) {
  const Eigen::Vector3d between = part.centre - still.centre;
  return between.norm() - still.part->radius - part.part->radius >= bound ||
         GapAlongAxes(still, part, between) >= bound;
}

bool ApartAlongAxes(const Placed& side, const Placed& other, double bound) {
  return GapAlongAxes(side, other, other.centre - side.centre) >= bound;
}

namespace {

/// Of a part's envelope from the triangles of a mesh.
double ProvenFrom(const Placed& mesh, const Placed& body, double bound, double enough) {
  const Pose X_MG = mesh.X_WG.inverse(Eigen::Isometry) * body.X_WG;
  const double least = LeastDistance(body.part->envelope, X_MG, mesh.part->solid->tree(), bound, enough);
  return least >= enough && Swallows(mesh, body) ? 0 : least;
}

}  // namespace

double ProvenDistance(const Placed& a, const Placed& b, double bound, double enough) {
  if (!a.part->mesh() && !b.part->mesh()) return std::clamp(WidestGap(a, b, bound), 0.0, bound);
  if (!b.part->mesh()) return ProvenFrom(a, b, bound, enough);
  const double of_a = ProvenFrom(b, a, bound, enough);
  if (!a.part->mesh() || of_a >= enough) return of_a;
  return ProvenFrom(a, b, bound, enough);  // two meshes: the box of one or the other may lie clear
}

DistanceBracket BracketOf(const Placed& a, const Placed& b, double bound, double near) {
  const Placed &mesh = a.part->mesh() ? a : b, &body = a.part->mesh() ? b : a;
  const auto closed_form = [](const Placed& one) {
    return !one.part->mesh() && one.part->envelope.kind != Envelope::Kind::kHull;
  };
  if (closed_form(a) && closed_form(b))
    return BracketDistance(a.part->envelope, a.X_WG.inverse(Eigen::Isometry) * b.X_WG, b.part->envelope);
  if (!mesh.part->mesh() || !closed_form(body)) return {0, std::numeric_limits<double>::infinity()};
  const Pose X_MG = mesh.X_WG.inverse(Eigen::Isometry) * body.X_WG;
  const DistanceBracket found =
      BracketDistance(body.part->envelope, X_MG, mesh.part->solid->tree(), bound, near);
  if (found.least >= bound && Swallows(mesh, body)) return {0, 0};
  return found;
}

BoundedDistance DistanceUpTo(const Placed& a, const Placed& b, double bound) {
  if (a.part->mesh()) return MeshDistance(a, b, bound);
  if (b.part->mesh()) {
    BoundedDistance found = MeshDistance(b, a, bound);
    std::swap(found.ends[0], found.ends[1]);
    return found;
  }
  return ConvexDistance(a, b, bound);
}

}  // namespace millpose
