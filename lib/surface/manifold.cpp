// SPDX-License-Identifier: GPL-3.0-or-later
#include <numeric>

#include "surface/edges.hpp"
#include "surface/repair.hpp"
#include "surface/triangle.hpp"

namespace millpose {
namespace {

// Turns the sides of one edge that lie around it in a consistent order into pairs that bound the same
// material: seen along low→high, material lies ahead (by angle) of a side that runs high→low and behind one
// that runs low→high.
bool PairByMaterial(const Triangles& mesh, const EdgeSide* begin, const EdgeSide* end,
                    std::vector<Side>& partner) {
  struct Spoke {
    double angle;
    bool forward;
    Side side;
  };
  const Eigen::Vector3d& origin = mesh.vertices[begin->low];
  const Eigen::Vector3d axis = (mesh.vertices[begin->high] - origin).normalized();
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  std::vector<Spoke> spokes;
  for (const EdgeSide* it = begin; it != end; ++it) {
    const auto& face = mesh.faces[FaceOf(it->side)];
    const Eigen::Vector3d apex = mesh.vertices[face[(CornerOf(it->side) + 2) % 3]] - origin;
    spokes.push_back({std::atan2(apex.dot(v), apex.dot(u)), face[CornerOf(it->side)] == it->low, it->side});
  }
  std::ranges::sort(spokes, {}, &Spoke::angle);
  const size_t count = spokes.size();
  for (size_t i = 0; i < count; ++i) {
    const Spoke& next = spokes[(i + 1) % count];
    const double step = next.angle - spokes[i].angle;
    if (spokes[i].forward == next.forward || std::abs(step) < 1e-6) return false;
  }
  for (size_t i = 0; i < count; ++i)
    if (!spokes[i].forward) {
      const Spoke& next = spokes[(i + 1) % count];
      partner[spokes[i].side] = next.side;
      partner[next.side] = spokes[i].side;
    }
  return true;
}

const Eigen::Vector3d kSkew(0.5773, 0.2113, 0.7887);  // unlikely to lie in a face of a part

class ManifoldMaker {
 public:
  ManifoldMaker(Triangles& mesh, RepairCounts& counts)
      : mesh_(mesh),
        counts_(counts),
        partner_(3 * mesh.faces.size(), kNoSide),
        piece_(mesh.faces.size(), -1) {}

  void Run() {
    Pair();
    std::vector<char> flip = Orientations();
    Turn(flip);
    TurnPiecesOutside();
    SplitVertices();
  }

 private:
  void Pair() {
    const std::vector<EdgeSide> sides = SortedSides(mesh_);
    ForEachEdge(sides, [&](size_t begin, size_t end) {
      if (end - begin == 2) {
        partner_[sides[begin].side] = sides[begin + 1].side;
        partner_[sides[begin + 1].side] = sides[begin].side;
      } else if (end - begin > 2) {
        ++counts_.non_manifold_edges;
        PairByMaterial(mesh_, &sides[begin], &sides[0] + end, partner_);
      }
    });
  }

  void Cut(Side side) {
    partner_[partner_[side]] = kNoSide;
    partner_[side] = kNoSide;
  }

  int Start(Side side) const { return mesh_.faces[FaceOf(side)][CornerOf(side)]; }

  // Finds the pieces; says which faces must turn so that each piece is oriented as most of it is.
  std::vector<char> Orientations() {
    std::vector<char> flip(mesh_.faces.size(), 0);
    std::vector<int> queue;
    for (size_t seed = 0; seed < mesh_.faces.size(); ++seed) {
      if (piece_[seed] >= 0) continue;
      const int piece = static_cast<int>(counts_.pieces++);
      queue.assign(1, static_cast<int>(seed));
      piece_[seed] = piece;
      size_t turned = 0;
      for (size_t head = 0; head < queue.size(); ++head) {
        const int face = queue[head];
        turned += flip[face];
        for (int k = 0; k < 3; ++k) Reach(3 * face + k, piece, flip, queue);
      }
      if (2 * turned > queue.size())
        for (const int face : queue) flip[face] = flip[face] == 0 ? 1 : 0;
      counts_.flipped += std::min(turned, queue.size() - turned);
    }
    return flip;
  }

  void Reach(Side side, int piece, std::vector<char>& flip, std::vector<int>& queue) {
    const Side other = partner_[side];
    if (other == kNoSide) return;
    const int face = FaceOf(side), neighbour = FaceOf(other);
    const bool against = Start(side) == Start(other);
    const char wanted = static_cast<char>(against ? 1 - flip[face] : flip[face]);
    if (piece_[neighbour] < 0) {
      piece_[neighbour] = piece;
      flip[neighbour] = wanted;
      queue.push_back(neighbour);
    } else if (flip[neighbour] != wanted) {
      ++counts_.not_orientable_edges;
      Cut(side);
    }
  }

  // Turning (a, b, c) into (a, c, b) makes side k side 2−k.
  void Turn(const std::vector<char>& flip) {
    const auto moved = [&](Side s) {
      return s == kNoSide || flip[FaceOf(s)] == 0 ? s : 3 * FaceOf(s) + 2 - CornerOf(s);
    };
    std::vector<Side> partner(partner_.size());
    for (Side s = 0; s < static_cast<Side>(partner_.size()); ++s) partner[moved(s)] = moved(partner_[s]);
    partner_ = std::move(partner);
    for (size_t f = 0; f < mesh_.faces.size(); ++f)
      if (flip[f] != 0) std::swap(mesh_.faces[f][1], mesh_.faces[f][2]);
  }

  struct Piece {
    bool closed = true;
    double volume = 0;  // six times
    Eigen::AlignedBox3d box;
    std::vector<int> faces;
  };

  std::vector<Piece> Pieces() const {
    std::vector<Piece> pieces(counts_.pieces);
    for (size_t f = 0; f < mesh_.faces.size(); ++f) {
      Piece& piece = pieces[piece_[f]];
      piece.faces.push_back(static_cast<int>(f));
      const auto& [a, b, c] = mesh_.faces[f];
      const Eigen::Vector3d& origin = mesh_.vertices[mesh_.faces[piece.faces[0]][0]];
      const Eigen::Vector3d pa = mesh_.vertices[a] - origin, pb = mesh_.vertices[b] - origin,
                            pc = mesh_.vertices[c] - origin;
      piece.volume += pa.dot(pb.cross(pc));
      for (int k = 0; k < 3; ++k) {
        piece.box.extend(mesh_.vertices[mesh_.faces[f][k]]);
        piece.closed = piece.closed && partner_[3 * f + k] != kNoSide;
      }
    }
    return pieces;
  }

  // How many other closed pieces hold the piece's first triangle.
  int Depth(const std::vector<Piece>& pieces, size_t inner) const {
    const auto& [a, b, c] = mesh_.faces[pieces[inner].faces[0]];
    const Eigen::Vector3d p = (mesh_.vertices[a] + mesh_.vertices[b] + mesh_.vertices[c]) / 3;
    int depth = 0;
    for (size_t outer = 0; outer < pieces.size(); ++outer) {
      if (outer == inner || !pieces[outer].closed || !pieces[outer].box.contains(p)) continue;
      int crossings = 0;
      for (const int face : pieces[outer].faces) {
        const auto& [oa, ob, oc] = mesh_.faces[face];
        crossings += RayCrosses(p, kSkew, mesh_.vertices[oa], mesh_.vertices[ob], mesh_.vertices[oc]) ? 1 : 0;
      }
      depth += crossings % 2;
    }
    return depth;
  }

  // Closed pieces get their outside out, cavities (in a body, facing inwards) stay.
  void TurnPiecesOutside() {
    const std::vector<Piece> pieces = Pieces();
    std::vector<char> flip(mesh_.faces.size(), 0);
    for (size_t i = 0; i < pieces.size(); ++i) {
      counts_.closed_pieces += pieces[i].closed ? 1 : 0;
      if (!pieces[i].closed || pieces[i].volume >= 0 || Depth(pieces, i) % 2 == 1) continue;
      ++counts_.turned_pieces;
      for (const int face : pieces[i].faces) flip[face] = 1;
    }
    if (counts_.turned_pieces > 0) Turn(flip);
  }

  int Root(int corner) {
    while (fan_[corner] != corner) corner = fan_[corner] = fan_[fan_[corner]];
    return corner;
  }

  void Join(int a, int b) {
    a = Root(a), b = Root(b);
    fan_[std::max(a, b)] = std::min(a, b);
  }

  // The corners of each fan get a vertex of their own: the first fan of a vertex keeps it.
  Triangles WithFansApart() {
    fan_.resize(partner_.size());
    std::iota(fan_.begin(), fan_.end(), 0);
    for (Side s = 0; s < static_cast<Side>(partner_.size()); ++s)
      if (const Side other = partner_[s]; other > s) {
        Join(s, NextSide(other));  // a side starts where its partner ends
        Join(NextSide(s), other);
      }
    std::vector<int> vertex_of_fan(partner_.size(), -1);
    std::vector<char> used(mesh_.vertices.size(), 0);
    Triangles apart;
    apart.vertices = mesh_.vertices;
    apart.faces = mesh_.faces;
    apart.source = mesh_.source;
    apart.source_faces = mesh_.source_faces;
    for (Side s = 0; s < static_cast<Side>(partner_.size()); ++s) {
      int& vertex = vertex_of_fan[Root(s)];
      if (vertex < 0) {
        const int original = Start(s);
        vertex = original;
        if (used[original] != 0) {
          vertex = static_cast<int>(apart.vertices.size());
          apart.vertices.push_back(mesh_.vertices[original]);
        }
        counts_.non_manifold_vertices += used[original] == 1 ? 1 : 0;  // counted once, however many fans
        used[original] = used[original] == 0 ? 1 : 2;
      }
      apart.faces[FaceOf(s)][CornerOf(s)] = vertex;
    }
    return apart;
  }

  // A fan can pass the same edge twice; then that edge is cut and the fans are found again.
  void SplitVertices() {
    const size_t doubled_before = counts_.non_manifold_vertices;
    for (;;) {
      counts_.non_manifold_vertices = doubled_before;
      Triangles apart = WithFansApart();
      bool cut = false;
      const std::vector<EdgeSide> sides = SortedSides(apart);
      ForEachEdge(sides, [&](size_t begin, size_t end) {
        for (size_t i = begin; end - begin > 2 && i < end; ++i)
          if (partner_[sides[i].side] != kNoSide) {
            Cut(sides[i].side);
            cut = true;
          }
      });
      if (cut) continue;
      mesh_ = std::move(apart);
      return;
    }
  }

  Triangles& mesh_;
  RepairCounts& counts_;
  std::vector<Side> partner_;  // the side of the neighbour over the same edge
  std::vector<int> piece_;     // of each face
  std::vector<int> fan_;       // union-find over corners
};

}  // namespace

void MakeManifold(Triangles& mesh, RepairCounts& counts) { ManifoldMaker(mesh, counts).Run(); }

}  // namespace millpose
