// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/geometry/damaged_meshes.hpp"

#include "base/random.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

Eigen::Vector3d Offset(RandomStream& random, double size) {
  return size * Eigen::Vector3d{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
}

/// Damages that keep a mesh closed: what tessellators and file formats leave.
class Damage {
 public:
  Damage(Triangles& mesh, RandomStream& random) : mesh_(mesh), random_(random) {}

  void Any() {
    switch (random_.Below(5)) {
      case 0:
        return Sliver(random_.Uniform(0.1, 0.9));
      case 1:  // next to the end of the edge: a vertex that the weld joins
        return Sliver(random_.Uniform(0, 1) < 0.5 ? 1e-7 : 1 - 1e-7);
      case 2:
        return Star(random_.Uniform(0, 1) < 0.5 ? 1e-6 : 0.4);
      case 3:
        return OpenJunction(random_.Uniform(0.1, 0.9));
      default:
        return Turned();
    }
  }

 private:
  /// A vertex beside the edge of a face, at most `off` away on each axis: the face is split there. Returns
  /// the triangle that would fill the crack to the neighbour, which keeps the whole edge.
  std::array<int, 3> Junction(double share, double off) {
    const int face = random_.Below(static_cast<int>(mesh_.faces.size())), side = random_.Below(3);
    auto f = mesh_.faces[face];
    std::rotate(f.begin(), f.begin() + side, f.end());
    const Eigen::Vector3d &a = mesh_.vertices[f[0]], &b = mesh_.vertices[f[1]];
    const int middle = static_cast<int>(mesh_.vertices.size());
    const Eigen::Vector3d at = a + share * (b - a) + Offset(random_, off);
    mesh_.vertices.push_back(at);
    mesh_.faces[face] = {f[0], middle, f[2]};
    mesh_.faces.push_back({middle, f[1], f[2]});
    return {f[0], f[1], middle};
  }

  /// A T-junction filled by a triangle without area.
  void Sliver(double share) { mesh_.faces.push_back(Junction(share, 0.3 * kDamageWeld)); }

  /// A T-junction that stays open: a crack without width.
  void OpenJunction(double share) { Junction(share, 0.1 * kDamageWeld); }

  /// A vertex in a face, perhaps next to one of its corners.
  void Star(double weight) {
    const int face = random_.Below(static_cast<int>(mesh_.faces.size()));
    const auto f = mesh_.faces[face];
    const int middle = static_cast<int>(mesh_.vertices.size());
    mesh_.vertices.emplace_back((1 - 2 * weight) * mesh_.vertices[f[0]] + weight * mesh_.vertices[f[1]] +
                                weight * mesh_.vertices[f[2]]);
    mesh_.faces[face] = {f[0], f[1], middle};
    mesh_.faces.push_back({f[1], f[2], middle});
    mesh_.faces.push_back({f[2], f[0], middle});
  }

  /// A triangle turned round.
  void Turned() {
    if (random_.Uniform() < 0.1) Flip(mesh_, random_.Below(static_cast<int>(mesh_.faces.size())));
  }

  Triangles& mesh_;
  RandomStream& random_;
};

Triangles Shape(RandomStream& random) {
  switch (random.Below(4)) {
    case 0:
      return BoxShape({0, 0, 0}, {30, 20, 10});
    case 1:
      return SphereShape(15, 4 + random.Below(3));
    case 2:
      return CylinderShape(8, 40, 5 + random.Below(6), 1 + random.Below(2));
    default: {
      Triangles two = BoxShape({0, 0, 0}, {10, 10, 10});  // two bodies with a common edge
      Append(two, BoxShape({10, 10, 0}, {20, 20, 10}));
      return two;
    }
  }
}

}  // namespace

double Volume(const Triangles& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.faces)
    volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6;
  return volume;
}

DamagedMesh MakeDamagedMesh(uint64_t number) {
  RandomStream random(31, number);
  DamagedMesh made;
  made.mesh = Shape(random);
  made.volume = Volume(made.mesh);
  Damage damage(made.mesh, random);
  for (int k = random.Below(12); k > 0; --k) damage.Any();
  made.indexed = made.mesh;
  if (random.Uniform() < 0.5) {
    made.mesh = Soup(made.mesh);
    for (Eigen::Vector3d& p : made.mesh.vertices)
      p += Offset(random, 1e-3 * kDamageWeld);  // rounding of a file
  }
  return made;
}

}  // namespace millpose
