// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/mesh_parts.hpp"

#include <limits>
#include <map>

#include "base/decompositions.hpp"
#include "geometry/mesh/corner_normals.hpp"

namespace millpose {
namespace {

/// By triangle: connected ones over edges that bend by no more than `crease`.
std::vector<int> Patches(const Mesh& mesh, double crease) {
  std::vector<int> patch(static_cast<size_t>(mesh.face_count()), -1);
  int count = 0;
  for (int start = 0; start < mesh.face_count(); ++start) {
    if (patch[static_cast<size_t>(start)] >= 0) continue;
    std::vector<int> open{start};
    patch[static_cast<size_t>(start)] = count;
    while (!open.empty()) {
      const int face = open.back();
      open.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int other = mesh.Neighbour(face, k);
        if (other < 0 || patch[static_cast<size_t>(other)] >= 0 || BendAngle(mesh, face, k) > crease)
          continue;
        patch[static_cast<size_t>(other)] = count;
        open.push_back(other);
      }
    }
    ++count;
  }
  return patch;
}

void DescribeFaces(const Mesh& mesh, MeshParts& parts) {
  std::vector<Eigen::Vector3d> middle(parts.faces.size(), Eigen::Vector3d::Zero());
  const auto centre = [&](int face) -> Eigen::Vector3d {
    return (mesh.Corner(face, 0) + mesh.Corner(face, 1) + mesh.Corner(face, 2)) / 3;
  };
  for (int face = 0; face < mesh.face_count(); ++face) {
    FacePart& part = parts.faces[static_cast<size_t>(parts.face_of[static_cast<size_t>(face)])];
    const double area = AreaOf(mesh, face);
    ++part.triangles;
    part.area += area;
    middle[static_cast<size_t>(parts.face_of[static_cast<size_t>(face)])] += area * centre(face);
  }
  // The triangle nearest to the middle, since that itself may lie beside the face.
  std::vector<double> nearest(parts.faces.size(), std::numeric_limits<double>::infinity());
  for (int face = 0; face < mesh.face_count(); ++face) {
    const auto number = static_cast<size_t>(parts.face_of[static_cast<size_t>(face)]);
    FacePart& part = parts.faces[number];
    const double away = (centre(face) - middle[number] / part.area).norm();
    if (away >= nearest[number]) continue;
    nearest[number] = away;
    part.place = centre(face);
    part.normal = mesh.FaceNormal(face);
  }
}

/// What the triangles of a face say of it as a cylinder: their normals lie across one direction.
struct NormalSpread {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double area = 0;
  std::vector<int> vertices;
};

/// The radius of the circle through `points` (mm) by least squares; 0 where one is off it by more than a
/// hundredth of the radius.
double RadiusOf(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) middle += p / static_cast<double>(points.size());
  // x² + y² = 2·c·p + w about the middle.
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d q = p - middle;
    const Eigen::Vector3d row(2 * q.x(), 2 * q.y(), 1);
    A += row * row.transpose();
    b += row * q.squaredNorm();
  }
  const Eigen::Vector3d x = Solve3(A, b);
  const double squared = x[2] + x.head<2>().squaredNorm();
  if (!(squared > 0)) return 0;
  const double radius = std::sqrt(squared);
  for (const Eigen::Vector2d& p : points)
    if (std::abs((p - middle - x.head<2>()).norm() - radius) > 0.01 * radius) return 0;
  return radius;
}

double CylinderRadius(const Mesh& mesh, const NormalSpread& spread) {
  constexpr double kAcross = 1e-4;  // of the normals' squares: half a degree off
  constexpr double kCurved = 1e-3;  // likewise: less than a few degrees of a circle says nothing
  const EigenPairs3 eigen = EigenOfSymmetric3(spread.sum / spread.area);
  const Eigen::Vector3d values = eigen.values;  // ascending
  if (values[0] > kAcross || values[1] < kCurved) return 0;
  const Eigen::Vector3d u = eigen.vectors.col(1), v = eigen.vectors.col(2);
  std::vector<Eigen::Vector2d> points;
  for (const int vertex : spread.vertices) {
    const Eigen::Vector3d& p = mesh.triangles().vertices[static_cast<size_t>(vertex)];
    points.emplace_back(u.dot(p), v.dot(p));
  }
  return RadiusOf(points);
}

void FindRadii(const Mesh& mesh, MeshParts& parts) {
  std::vector<NormalSpread> spreads(parts.faces.size());
  for (int face = 0; face < mesh.face_count(); ++face) {
    NormalSpread& spread = spreads[static_cast<size_t>(parts.face_of[static_cast<size_t>(face)])];
    const double area = AreaOf(mesh, face);
    spread.sum += area * mesh.FaceNormal(face) * mesh.FaceNormal(face).transpose();
    spread.area += area;
    for (const int vertex : mesh.triangles().faces[static_cast<size_t>(face)])
      spread.vertices.push_back(vertex);
  }
  for (size_t i = 0; i < spreads.size(); ++i)
    if (spreads[i].area > 0) parts.faces[i].radius = CylinderRadius(mesh, spreads[i]);
}

struct BoundarySide {
  std::array<int, 2> ends;
  Eigen::Vector3d normal;  ///< sum of its faces'
};

/// Splits the sides between two faces into what hangs together.
std::vector<std::vector<BoundarySide>> Connected(const std::vector<BoundarySide>& sides) {
  std::map<int, std::vector<size_t>> at;
  for (size_t i = 0; i < sides.size(); ++i)
    for (const int end : sides[i].ends) at[end].push_back(i);
  std::vector<char> seen(sides.size(), 0);
  std::vector<std::vector<BoundarySide>> found;
  for (size_t start = 0; start < sides.size(); ++start) {
    if (seen[start]) continue;
    std::vector<size_t> open{start};
    seen[start] = 1;
    found.emplace_back();
    while (!open.empty()) {
      const size_t i = open.back();
      open.pop_back();
      found.back().push_back(sides[i]);
      for (const int end : sides[i].ends)
        for (const size_t next : at[end])
          if (!seen[next]) seen[next] = 1, open.push_back(next);
    }
  }
  return found;
}

EdgePart DescribeEdge(const Mesh& mesh, int first, int second, const std::vector<BoundarySide>& sides) {
  const std::vector<Eigen::Vector3d>& vertices = mesh.triangles().vertices;
  EdgePart edge;
  edge.first = first, edge.second = second;
  std::map<int, int> ends;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const BoundarySide& side : sides) {
    const Eigen::Vector3d &a = vertices[static_cast<size_t>(side.ends[0])],
                          &b = vertices[static_cast<size_t>(side.ends[1])];
    const double length = (b - a).norm();
    edge.length += length;
    middle += length * 0.5 * (a + b);
    edge.sides.push_back(side.ends);
    for (const int end : side.ends) ++ends[end];
  }
  edge.closed = std::ranges::all_of(ends, [](const auto& end) { return end.second == 2; });
  middle /= edge.length;
  double nearest = std::numeric_limits<double>::infinity();
  for (const BoundarySide& side : sides) {
    const Eigen::Vector3d at =
        0.5 * (vertices[static_cast<size_t>(side.ends[0])] + vertices[static_cast<size_t>(side.ends[1])]);
    if ((at - middle).norm() >= nearest) continue;
    nearest = (at - middle).norm();
    edge.place = at;
    edge.normal = side.normal.norm() > 1e-9 ? side.normal.normalized() : Eigen::Vector3d::Zero();
  }
  return edge;
}

}  // namespace

MeshParts FindMeshParts(const Mesh& mesh, double crease) {
  MeshParts parts;
  const Triangles& triangles = mesh.triangles();
  parts.face_of = triangles.source.empty() ? Patches(mesh, crease) : triangles.source;
  int count = static_cast<int>(triangles.source_faces.size());
  for (const int number : parts.face_of) count = std::max(count, number + 1);
  parts.faces.resize(static_cast<size_t>(count));
  DescribeFaces(mesh, parts);
  FindRadii(mesh, parts);
  std::map<std::pair<int, int>, std::vector<BoundarySide>> between;
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.Neighbour(face, k);
      if (other >= 0 && other < face) continue;  // seen from there
      const int own = parts.face_of[static_cast<size_t>(face)],
                far = other < 0 ? -1 : parts.face_of[static_cast<size_t>(other)];
      if (own == far) continue;
      const auto& corners = triangles.faces[static_cast<size_t>(face)];
      BoundarySide side{{corners[static_cast<size_t>(k)], corners[static_cast<size_t>((k + 1) % 3)]},
                        mesh.FaceNormal(face)};
      if (other >= 0) side.normal += mesh.FaceNormal(other);
      between[far < 0 ? std::pair(own, -1) : std::minmax({own, far})].push_back(side);
    }
  for (const auto& [faces, sides] : between)
    for (const std::vector<BoundarySide>& connected : Connected(sides))
      parts.edges.push_back(DescribeEdge(mesh, faces.first, faces.second, connected));
  return parts;
}

}  // namespace millpose
