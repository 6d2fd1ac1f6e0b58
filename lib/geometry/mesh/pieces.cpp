// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/pieces.hpp"

#include "geometry/mesh/triangle.hpp"

namespace millpose {
namespace {

const Eigen::Vector3d kSkew(0.5773, 0.2113, 0.7887);  // unlikely to lie in a face of a part

// By `neighbour(face, k)`: the face over its side k, negative at a rim.
template <typename NeighbourOf>
std::vector<ConnectedPiece> Grow(size_t faces, const NeighbourOf& neighbour) {
  std::vector<char> seen(faces, 0);
  std::vector<ConnectedPiece> pieces;
  for (size_t seed = 0; seed < faces; ++seed) {
    if (seen[seed] != 0) continue;
    seen[seed] = 1;
    ConnectedPiece& piece = pieces.emplace_back();
    piece.faces.push_back(static_cast<int>(seed));
    for (size_t head = 0; head < piece.faces.size(); ++head)
      for (int k = 0; k < 3; ++k) {
        const int other = neighbour(piece.faces[head], k);
        piece.closed = piece.closed && other >= 0;
        if (other < 0 || seen[other] != 0) continue;
        seen[other] = 1;
        piece.faces.push_back(other);
      }
  }
  return pieces;
}

std::vector<ConnectedPiece> PiecesOf(const std::vector<Side>& partners) {
  return Grow(partners.size() / 3, [&](int face, int k) {
    const Side other = partners[3 * face + k];
    return other == kNoSide ? -1 : FaceOf(other);
  });
}

void Turn(const ConnectedPiece& piece, Triangles& mesh) {
  for (const int face : piece.faces) std::swap(mesh.faces[face][1], mesh.faces[face][2]);
}

// A closed piece as a body.
class Body {
 public:
  Body(const Triangles& mesh, const ConnectedPiece& piece) : mesh_(mesh), piece_(piece) {
    const Eigen::Vector3d& origin = Corner(piece.faces[0], 0);
    for (const int face : piece.faces) {
      const Eigen::Vector3d a = Corner(face, 0) - origin, b = Corner(face, 1) - origin,
                            c = Corner(face, 2) - origin;
      volume_ += a.dot(b.cross(c));
      for (int k = 0; k < 3; ++k) box_.extend(Corner(face, k));
    }
  }

  bool InsideOut() const { return volume_ < 0; }

  // Whether most of another piece's faces lie inside: a few of them may touch.
  bool Holds(const Body& other) const {
    if (!box_.intersects(other.box_)) return false;
    constexpr size_t kSamples = 7;
    const std::vector<int>& faces = other.piece_.faces;
    const size_t samples = std::min(kSamples, faces.size());
    size_t inside = 0;
    for (size_t i = 0; i < samples; ++i) {
      const int face = faces[i * faces.size() / samples];
      inside += Contains((Corner(face, 0) + Corner(face, 1) + Corner(face, 2)) / 3) ? 1 : 0;
    }
    return 2 * inside > samples;
  }

 private:
  const Eigen::Vector3d& Corner(int face, int k) const { return mesh_.vertices[mesh_.faces[face][k]]; }

  bool Contains(const Eigen::Vector3d& p) const {
    if (!box_.contains(p)) return false;
    bool inside = false;
    for (const int face : piece_.faces)
      if (RayCrosses(p, kSkew, Corner(face, 0), Corner(face, 1), Corner(face, 2))) inside = !inside;
    return inside;
  }

  const Triangles& mesh_;
  const ConnectedPiece& piece_;
  double volume_ = 0;  // six times
  Eigen::AlignedBox3d box_;
};

}  // namespace

std::vector<ConnectedPiece> PiecesOf(const Mesh& mesh) {
  return Grow(static_cast<size_t>(mesh.face_count()),
              [&](int face, int k) { return mesh.Neighbour(face, k); });
}

size_t TurnPiecesOutside(const std::vector<Side>& partners, Triangles& manifold) {
  const std::vector<ConnectedPiece> pieces = PiecesOf(partners);
  std::vector<const ConnectedPiece*> closed;
  std::vector<Body> bodies;
  for (const ConnectedPiece& piece : pieces) {
    if (!piece.closed) continue;
    closed.push_back(&piece);
    bodies.emplace_back(manifold, piece);
  }
  std::vector<const ConnectedPiece*> wrong;
  for (size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].InsideOut()) continue;
    size_t depth = 0;
    for (size_t outer = 0; outer < bodies.size(); ++outer)
      depth += outer != i && bodies[outer].Holds(bodies[i]) ? 1 : 0;
    if (depth % 2 == 0) wrong.push_back(closed[i]);
  }
  for (const ConnectedPiece* piece : wrong) Turn(*piece, manifold);
  return wrong.size();
}

size_t FlipOpenPieces(Triangles& manifold) {
  size_t flipped = 0;
  for (const ConnectedPiece& piece : PiecesOf(PartnersOf(manifold))) {
    if (piece.closed) continue;
    Turn(piece, manifold);
    flipped += piece.faces.size();
  }
  return flipped;
}

}  // namespace millpose
