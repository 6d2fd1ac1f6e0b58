// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/corner_normals.hpp"

#include <numeric>

namespace millpose {
namespace {

// atan2 keeps its accuracy at both ends, where acos of the scalar product loses half the digits.
double Angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

int CornerAt(const std::array<int, 3>& face, int vertex) {
  return face[0] == vertex ? 0 : face[1] == vertex ? 1 : 2;
}

// Union-find over the corners 3·face + k.
class Fans {
 public:
  explicit Fans(size_t corners) : parent_(corners) { std::iota(parent_.begin(), parent_.end(), 0); }
  int Root(int corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void Join(int a, int b) {
    a = Root(a), b = Root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace

double BendAngle(const Mesh& mesh, int face, int k) {
  const int other = mesh.Neighbour(face, k);
  return other < 0 ? 0.0 : Angle(mesh.FaceNormal(face), mesh.FaceNormal(other));
}

CornerNormals::CornerNormals(const Mesh& mesh, double crease) : normals_(mesh.face_count()) {
  const auto& faces = mesh.triangles().faces;
  Fans fans(3 * faces.size());
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.Neighbour(face, k);
      if (other <= face || BendAngle(mesh, face, k) > crease) continue;
      for (const int end : {k, (k + 1) % 3})
        fans.Join(3 * face + end, 3 * other + CornerAt(faces[other], faces[face][end]));
    }
  std::vector<Eigen::Vector3d> sums(3 * faces.size(), Eigen::Vector3d::Zero());
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& p = mesh.Corner(face, k);
      const double angle = Angle(mesh.Corner(face, (k + 1) % 3) - p, mesh.Corner(face, (k + 2) % 3) - p);
      sums[fans.Root(3 * face + k)] += angle * mesh.FaceNormal(face);
    }
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& sum = sums[fans.Root(3 * face + k)];
      // Around a spike the normals can cancel out; then the face's own is the only one that means anything.
      normals_[face][k] = sum.norm() > 1e-9 ? Eigen::Vector3d(sum.normalized()) : mesh.FaceNormal(face);
    }
}

Eigen::Vector3d CornerNormals::At(int face, const Eigen::Vector3d& barycentric) const {
  const auto& [a, b, c] = normals_[face];
  return (barycentric[0] * a + barycentric[1] * b + barycentric[2] * c).normalized();
}

}  // namespace millpose
