// SPDX-License-Identifier: GPL-3.0-or-later
#include <numeric>

#include "geometry/import/edge_pairs.hpp"
#include "geometry/import/repair.hpp"
#include "geometry/mesh/pieces.hpp"

namespace millpose {
namespace {

class ManifoldMaker {
 public:
  ManifoldMaker(Triangles& mesh, RepairCounts& counts)
      : mesh_(mesh),
        counts_(counts),
        partner_(3 * mesh.faces.size(), kNoSide),
        piece_(mesh.faces.size(), -1) {}

  void Run() {
    const std::vector<EdgeSide> sides = SortedSides(mesh_);
    // What hangs together over plain edges is oriented first: only then edges of more triangles can tell
    // material.
    PairPlain(sides);
    Turn(Orientations());
    if (crowded_) {
      PairOthers();
      Turn(Orientations());
    }
    SplitVertices();
  }

  /// The side over the same edge, by side, of what Run() has left.
  const std::vector<Side>& partners() const { return partner_; }

 private:
  void PairPlain(const std::vector<EdgeSide>& sides) {
    ForEachEdge(sides, [&](size_t begin, size_t end) {
      crowded_ = crowded_ || end - begin > 2;
      if (end - begin != 2) return;
      partner_[sides[begin].side] = sides[begin + 1].side;
      partner_[sides[begin + 1].side] = sides[begin].side;
    });
  }

  void PairOthers() {
    const std::vector<EdgeSide> sides = SortedSides(mesh_);
    ForEachEdge(sides, [&](size_t begin, size_t end) {
      if (end - begin <= 2) return;
      ++counts_.non_manifold_edges;
      PairAround(mesh_, std::span(sides).subspan(begin, end - begin), piece_, partner_);
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
    std::ranges::fill(piece_, -1);
    int pieces = 0;
    std::vector<int> queue;
    for (size_t seed = 0; seed < mesh_.faces.size(); ++seed) {
      if (piece_[seed] >= 0) continue;
      const int piece = pieces++;
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

  // A fan can pass the same edge twice: two vertices then share two edges, which a mesh cannot hold. All
  // pairs of sides there but the first get a vertex in their middle, so that nothing opens, and the fans are
  // found again.
  void SplitVertices() {
    const size_t doubled_before = counts_.non_manifold_vertices;
    for (;;) {
      counts_.non_manifold_vertices = doubled_before;
      Triangles apart = WithFansApart();
      std::vector<Side> crowded;
      const std::vector<EdgeSide> sides = crowded_ ? SortedSides(apart) : std::vector<EdgeSide>();
      ForEachEdge(sides, [&](size_t begin, size_t end) {
        if (end - begin <= 2) return;
        bool keeps = true;  // the edge is the first pair's, or an open side's
        for (size_t i = begin; i < end; ++i) keeps = keeps && partner_[sides[i].side] != kNoSide;
        for (size_t i = begin; i < end; ++i) {
          const Side side = sides[i].side;
          if (partner_[side] == kNoSide || partner_[side] < side) continue;
          if (!keeps) crowded.push_back(side);
          keeps = false;
        }
      });
      if (crowded.empty()) {
        mesh_ = std::move(apart);
        return;
      }
      for (const Side side : crowded) SplitPair(side);
    }
  }

  // A vertex in the middle of an edge, for one pair of sides only: (a, b, c) and (b, a, d) become (a, m, c),
  // (m, b, c), (b, m, d) and (m, a, d).
  void SplitPair(Side side) {
    const int middle = static_cast<int>(mesh_.vertices.size());
    mesh_.vertices.emplace_back(0.5 * (mesh_.vertices[Start(side)] + mesh_.vertices[Start(NextSide(side))]));
    const Side other = partner_[side];
    const Side beyond = SplitFace(side, middle), beyond_other = SplitFace(other, middle);
    Link(side, beyond_other);
    Link(other, beyond);
  }

  // The near half (up to `middle`) keeps the face's number; returns the side of the far half along the same
  // edge.
  Side SplitFace(Side side, int middle) {
    const int face = FaceOf(side), k = CornerOf(side), far = static_cast<int>(mesh_.faces.size());
    std::array<int, 3> half = mesh_.faces[face];
    half[k] = middle;
    mesh_.faces.push_back(half);
    mesh_.faces[face][(k + 1) % 3] = middle;
    piece_.push_back(piece_[face]);
    if (!mesh_.source.empty()) mesh_.source.push_back(mesh_.source[face]);
    partner_.resize(partner_.size() + 3, kNoSide);
    const Side far_side = 3 * far + k, next = NextSide(side), far_next = NextSide(far_side);
    if (const Side old = partner_[next]; old != kNoSide) Link(far_next, old);
    Link(next, NextSide(far_next));
    return far_side;
  }

  void Link(Side a, Side b) {
    partner_[a] = b;
    partner_[b] = a;
  }

  Triangles& mesh_;
  RepairCounts& counts_;
  std::vector<Side> partner_;  // the side of the neighbour over the same edge
  std::vector<int> piece_;     // of each face
  bool crowded_ = false;       // edges of more than two triangles: where there are none, none come
  std::vector<int> fan_;       // union-find over corners
};

}  // namespace

void MakeManifold(Triangles& mesh, RepairCounts& counts) {
  ManifoldMaker maker(mesh, counts);
  maker.Run();
  counts.turned_pieces += TurnPiecesOutside(maker.partners(), mesh);
}

}  // namespace millpose
