// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/mesh.hpp"

#include "geometry/mesh/edges.hpp"
#include "geometry/mesh/mesh_impl.hpp"
#include "geometry/mesh/triangle.hpp"

namespace millpose {
namespace {

std::vector<std::array<int, 3>> NeighboursOf(const Triangles& triangles) {
  const std::vector<Side> partners = PartnersOf(triangles);
  std::vector<std::array<int, 3>> neighbours(triangles.faces.size());
  for (size_t side = 0; side < partners.size(); ++side)
    neighbours[side / 3][side % 3] = partners[side] == kNoSide ? -1 : FaceOf(partners[side]);
  return neighbours;
}

std::vector<Eigen::AlignedBox3d> BoxesOf(const Triangles& triangles) {
  std::vector<Eigen::AlignedBox3d> boxes;
  boxes.reserve(triangles.faces.size());
  for (const auto& [a, b, c] : triangles.faces) {
    boxes.emplace_back(triangles.vertices[a]);
    boxes.back().extend(triangles.vertices[b]).extend(triangles.vertices[c]);
  }
  return boxes;
}

bool RayMeets(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
              const Eigen::AlignedBox3d& box) {
  double near = 0, far = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double t0 = (box.min()[axis] - origin[axis]) / direction[axis];
    const double t1 = (box.max()[axis] - origin[axis]) / direction[axis];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  return near <= far;
}

}  // namespace

Mesh::Mesh(Triangles manifold) {
  auto impl = std::make_shared<Impl>();
  impl->triangles = std::move(manifold);
  const Triangles& triangles = impl->triangles;
  impl->neighbours = NeighboursOf(triangles);
  impl->tree = Bvh(BoxesOf(triangles));
  impl->face_normals.reserve(triangles.faces.size());
  for (const auto& [a, b, c] : triangles.faces) {
    const Eigen::Vector3d &pa = triangles.vertices[a], &pb = triangles.vertices[b],
                          &pc = triangles.vertices[c];
    impl->face_normals.push_back((pb - pa).cross(pc - pa).normalized());
  }
  impl_ = std::move(impl);
}

const Triangles& Mesh::triangles() const { return impl_->triangles; }

const Eigen::Vector3d& Mesh::Corner(int face, int k) const {
  return impl_->triangles.vertices[impl_->triangles.faces[face][k]];
}

const Eigen::Vector3d& Mesh::FaceNormal(int face) const { return impl_->face_normals[face]; }

int Mesh::Neighbour(int face, int k) const { return impl_->neighbours[face][k]; }

SurfacePoint Mesh::ClosestOnFace(const Eigen::Vector3d& p, int face) const {
  SurfacePoint point;
  point.face = face;
  point.barycentric = ClosestOnTriangle(p, Corner(face, 0), Corner(face, 1), Corner(face, 2));
  point.position = point.barycentric[0] * Corner(face, 0) + point.barycentric[1] * Corner(face, 1) +
                   point.barycentric[2] * Corner(face, 2);
  point.distance = (point.position - p).norm();
  return point;
}

SurfacePoint Mesh::Closest(const Eigen::Vector3d& p, double within) const {
  const auto [face, squared] = impl_->tree.Nearest(p, within * within, [&](int f) {
    const double distance = ClosestOnFace(p, f).distance;
    return distance * distance;
  });
  return face < 0 ? SurfacePoint() : ClosestOnFace(p, face);
}

std::vector<int> Mesh::FacesNear(const Eigen::Vector3d& p, double distance) const {
  std::vector<int> faces;
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(distance);
  impl_->tree.ForEachIn({p - reach, p + reach}, [&](int face) {
    if (ClosestOnFace(p, face).distance <= distance) faces.push_back(face);
  });
  std::ranges::sort(faces);
  return faces;
}

bool Mesh::Contains(const Eigen::Vector3d& p) const {
  int votes = 0;
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(0.5773, 0.2113, 0.7887), Eigen::Vector3d(-0.3219, 0.8837, 0.3395),
        Eigen::Vector3d(0.2741, -0.4337, -0.8583)}) {
    int crossings = 0;
    impl_->tree.ForEachWhere(
        [&](const Eigen::AlignedBox3d& box) { return RayMeets(p, direction, box); },
        [&](int face) {
          crossings += RayCrosses(p, direction, Corner(face, 0), Corner(face, 1), Corner(face, 2)) ? 1 : 0;
        });
    votes += crossings % 2;
  }
  return votes >= 2;
}

}  // namespace millpose
