// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/corner_normals.hpp"

#include <numeric>

#include "base/trig.hpp"

namespace millpose {
namespace {

// atan2 keeps its accuracy at both ends, where acos of the scalar product loses half the digits.
double Angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return Atan2(a.cross(b).norm(), a.dot(b));
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

// Means over the faces around a corner.
class SmoothNormals {
 public:
  SmoothNormals(const Mesh& mesh, double crease, double radius)
      : mesh_(mesh), crease_(crease), radius_(radius), seen_(mesh.face_count(), -1) {
    for (int face = 0; face < mesh.face_count(); ++face)
      centres_.push_back((mesh.Corner(face, 0) + mesh.Corner(face, 1) + mesh.Corner(face, 2)) / 3);
  }

  /// The mean normal around the corner 3·face + k; zero when no face's centre is near.
  Eigen::Vector3d At(int corner) {
    const Eigen::Vector3d p = mesh_.Corner(corner / 3, corner % 3);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    queue_.assign(1, corner / 3);
    seen_[corner / 3] = corner;
    for (size_t head = 0; head < queue_.size(); ++head) {
      const int at = queue_[head];
      const double share = (centres_[at] - p).norm() / radius_;
      const Eigen::Vector3d a = mesh_.Corner(at, 0);
      if (share < 1) sum += (1 - share * share) * (mesh_.Corner(at, 1) - a).cross(mesh_.Corner(at, 2) - a);
      for (int side = 0; side < 3; ++side) {
        const int other = mesh_.Neighbour(at, side);
        if (other < 0 || seen_[other] == corner || (centres_[other] - p).norm() >= radius_ ||
            BendAngle(mesh_, at, side) > crease_)
          continue;
        seen_[other] = corner;
        queue_.push_back(other);
      }
    }
    return sum.norm() > 1e-9 * radius_ * radius_ ? Eigen::Vector3d(sum.normalized())
                                                 : Eigen::Vector3d::Zero();
  }

 private:
  const Mesh& mesh_;
  double crease_, radius_;
  std::vector<Eigen::Vector3d> centres_;
  std::vector<int> seen_;  // by face: for which corner last
  std::vector<int> queue_;
};

}  // namespace

double BendAngle(const Mesh& mesh, int face, int k) {
  const int other = mesh.Neighbour(face, k);
  return other < 0 ? 0.0 : Angle(mesh.FaceNormal(face), mesh.FaceNormal(other));
}

CornerNormals::CornerNormals(const Mesh& mesh, double crease, double smoothing)
    : normals_(mesh.face_count()) {
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
  if (smoothing <= 0) return;
  SmoothNormals smooth(mesh, crease, smoothing / 2);
  std::vector<Eigen::Vector3d> means(3 * faces.size(), Eigen::Vector3d::Zero());
  for (int corner = 0; corner < static_cast<int>(means.size()); ++corner) {
    const int root = fans.Root(corner);
    if (root == corner) means[corner] = smooth.At(corner);
    // Where the faces are larger than the length there is nothing to smooth.
    if (means[root].norm() > 0.5) normals_[corner / 3][corner % 3] = means[root];
  }
}

Eigen::Vector3d CornerNormals::At(int face, const Eigen::Vector3d& barycentric) const {
  const auto& [a, b, c] = normals_[face];
  return (barycentric[0] * a + barycentric[1] * b + barycentric[2] * c).normalized();
}

}  // namespace millpose
