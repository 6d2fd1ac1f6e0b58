// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice/plane_slices.hpp"

// The OpenMesh adapters of CGAL must come before its algorithms.
// clang-format off
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h>
#include <CGAL/boost/graph/properties_TriMesh_ArrayKernelT.h>
#include <CGAL/AABB_halfedge_graph_segment_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_slicer.h>
// clang-format on

#include "base/parallel.hpp"
#include "geometry/mesh/mesh_impl.hpp"

namespace millpose {

struct OpenMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using OpenMeshTriangles = OpenMesh::TriMesh_ArrayKernelT<OpenMeshTraits>;

/// A mesh as CGAL's slicer takes it, with the same numbers of vertices and faces.
struct HalfedgeMesh {
  OpenMeshTriangles open_mesh;
};

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Slicer = CGAL::Polygon_mesh_slicer<OpenMeshTriangles, Kernel>;
using Polyline = std::vector<Kernel::Point_3>;

Eigen::Vector3d ToEigen(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

std::shared_ptr<const HalfedgeMesh> MakeHalfedges(const Triangles& triangles) {
  auto made = std::make_shared<HalfedgeMesh>();
  OpenMeshTriangles& mesh = made->open_mesh;
  mesh.reserve(triangles.vertices.size(), triangles.faces.size() * 3 / 2, triangles.faces.size());
  for (const auto& p : triangles.vertices) mesh.add_vertex({p.x(), p.y(), p.z()});
  for (size_t f = 0; f < triangles.faces.size(); ++f) {
    const auto& [a, b, c] = triangles.faces[f];
    const auto handle =
        mesh.add_face(OpenMesh::VertexHandle(a), OpenMesh::VertexHandle(b), OpenMesh::VertexHandle(c));
    if (handle.idx() != static_cast<int>(f))
      throw std::logic_error(fmt::format("face {} ({}, {}, {}) does not fit into the manifold", f, a, b, c));
  }
  return made;
}

const OpenMeshTriangles& HalfedgesOf(const Mesh& mesh) {
  const Mesh::Impl& impl = mesh.impl();
  std::call_once(impl.halfedges_made, [&] { impl.halfedges = MakeHalfedges(impl.triangles); });
  return impl.halfedges->open_mesh;
}

// The face that a segment lies in, and the one on the other side when it lies on an edge.
CurvePiece PieceOn(const Mesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d middle = (a + b) / 2;
  const double tolerance = 1e-9 + 1e-12 * middle.cwiseAbs().maxCoeff();
  CurvePiece piece = LinePiece(-1, a, b);
  for (const int face : mesh.FacesNear(middle, tolerance)) {
    if (mesh.ClosestOnFace(a, face).distance > 2 * tolerance ||
        mesh.ClosestOnFace(b, face).distance > 2 * tolerance)
      continue;
    (piece.face < 0 ? piece.face : piece.other_face) = face;
    if (piece.other_face >= 0) break;
  }
  if (piece.face < 0) piece.face = mesh.Closest(middle).face;
  return piece;
}

// A closed curve starts where it is farthest along a skew direction, so that ties are no matter of rounding.
void MoveStart(Curve& curve) {
  const Eigen::Vector3d skew(0.2741, 0.4337, 0.8583);
  const auto farthest = std::ranges::max_element(
      curve.pieces, {}, [&](const CurvePiece& piece) { return skew.dot(piece.start); });
  std::rotate(curve.pieces.begin(), farthest, curve.pieces.end());
}

Curve ToCurve(const Mesh& mesh, const Eigen::Vector3d& normal, const Polyline& polyline) {
  Curve curve;
  double along = 0;
  for (size_t i = 0; i + 1 < polyline.size(); ++i) {
    const Eigen::Vector3d a = ToEigen(polyline[i]), b = ToEigen(polyline[i + 1]);
    if (a == b) continue;
    curve.pieces.push_back(PieceOn(mesh, a, b));
    along += (b - a).dot(normal.cross(mesh.FaceNormal(curve.pieces.back().face)));
  }
  curve.closed = polyline.size() > 2 && polyline.front() == polyline.back();
  if (along < 0) curve = Reversed(curve);
  if (curve.closed && !curve.pieces.empty()) MoveStart(curve);
  return curve;
}

}  // namespace

std::vector<std::vector<Curve>> SliceByPlanes(const Mesh& mesh, const Eigen::Vector3d& normal,
                                              const std::vector<double>& offsets, std::stop_token stop) {
  Slicer slicer(HalfedgesOf(mesh));
  std::vector<std::vector<Curve>> slices;
  for (const double offset : offsets) {
    CheckStop(stop);
    std::vector<Polyline> polylines;
    slicer(Kernel::Plane_3(normal.x(), normal.y(), normal.z(), -offset), std::back_inserter(polylines));
    std::vector<Curve>& curves = slices.emplace_back();
    for (const Polyline& polyline : polylines) {
      Curve curve = ToCurve(mesh, normal, polyline);
      if (!curve.pieces.empty()) curves.push_back(std::move(curve));
    }
    std::ranges::stable_sort(curves, [](const Curve& a, const Curve& b) {
      const Eigen::Vector3d &p = a.pieces[0].start, &q = b.pieces[0].start;
      return std::tie(p.x(), p.y(), p.z()) < std::tie(q.x(), q.y(), q.z());
    });
  }
  return slices;
}

}  // namespace millpose
