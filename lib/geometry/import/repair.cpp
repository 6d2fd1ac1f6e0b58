// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/repair.hpp"

#include <span>

#include "geometry/import/t_junctions.hpp"
#include "geometry/mesh/edges.hpp"

namespace millpose {
namespace {

// Removes the faces for which `out(face)` holds, asked in ascending order; keeps the order of the others.
template <typename Out>
size_t EraseFaces(Triangles& mesh, Out out) {
  size_t next = 0;
  const size_t count = mesh.faces.size();
  for (size_t f = 0; f < count; ++f)
    if (!out(f)) {
      mesh.faces[next] = mesh.faces[f];
      if (!mesh.source.empty()) mesh.source[next] = mesh.source[f];
      ++next;
    }
  mesh.faces.resize(next);
  if (!mesh.source.empty()) mesh.source.resize(next);
  return count - next;
}

bool HasRepeatedVertex(const std::array<int, 3>& face) {
  return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
}

// A triangle's longest side and its height over it.
struct Flatness {
  int side = 0;
  double height = 0;
};

Flatness FlatnessOf(const Triangles& mesh, const std::array<int, 3>& face) {
  const auto corner = [&](int k) -> const Eigen::Vector3d& { return mesh.vertices[face[k % 3]]; };
  Flatness flatness;
  double longest = -1;
  for (int k = 0; k < 3; ++k) {
    const double length = (corner(k + 1) - corner(k)).norm();
    if (length > longest) {
      longest = length;
      flatness.side = k;
    }
  }
  const Eigen::Vector3d edge = corner(flatness.side + 1) - corner(flatness.side);
  flatness.height = edge.cross(corner(flatness.side + 2) - corner(flatness.side)).norm() / longest;
  return flatness;
}

// One round over the flat triangles; those whose neighbour was changed in this round wait for the next.
class FlatRemoval {
 public:
  // The first `originals` faces are (what is left of) those that were read; halves made here come behind
  // them.
  FlatRemoval(Triangles& mesh, double tolerance, size_t originals)
      : mesh_(mesh),
        tolerance_(tolerance),
        originals_(originals),
        count_(mesh.faces.size()),
        done_(count_, 0),
        removed_(count_, 0) {}

  struct Outcome {
    size_t removed = 0, originals_removed = 0;
  };

  Outcome Run() {
    std::vector<std::pair<int, int>> flat;  // face, longest side
    for (size_t f = 0; f < count_; ++f)
      if (const Flatness flatness = FlatnessOf(mesh_, mesh_.faces[f]); flatness.height <= tolerance_)
        flat.emplace_back(static_cast<int>(f), flatness.side);
    if (flat.empty()) return {};
    sides_ = SortedSides(mesh_);
    for (const auto& [face, side] : flat)
      if (done_[face] == 0 && Prepare(face, side)) removed_[face] = done_[face] = 1;
    Outcome outcome;
    for (size_t f = 0; f < count_; ++f) {
      outcome.removed += removed_[f];
      outcome.originals_removed += f < originals_ ? removed_[f] : 0;
    }
    EraseFaces(mesh_, [&](size_t f) { return f < count_ && removed_[f] != 0; });
    return outcome;
  }

 private:
  // The sides on the edge of a face's side.
  std::span<const EdgeSide> SidesOn(int face, int side) const {
    const std::array<int, 3>& f = mesh_.faces[face];
    const auto [low, high] = std::minmax(f[side], f[(side + 1) % 3]);
    const std::pair<int, int> edge(low, high);
    const auto edge_of = [](const EdgeSide& s) { return std::pair(s.low, s.high); };
    return {std::ranges::lower_bound(sides_, edge, {}, edge_of),
            std::ranges::upper_bound(sides_, edge, {}, edge_of)};
  }

  // Whether the mesh is closed better without the face: its long edge and another one have a side too many.
  bool IsFlap(int face, int side) const {
    const auto odd = [&](int k) { return SidesOn(face, k % 3).size() % 2 == 1; };
    return odd(side) && (odd(side + 1) || odd(side + 2));
  }

  // Prepares for the removal of a flat face. False when it must wait.
  bool Prepare(int face, int side) {
    if (!IsFlap(face, side)) return SplitNeighbour(face, side);
    for (int k = 0; k < 3; ++k)
      for (const EdgeSide& other : SidesOn(face, k))
        if (done_[FaceOf(other.side)] != 0) return false;
    return true;
  }

  // Splits the neighbour over the long side of a flat face at the face's middle vertex. False when it must
  // wait.
  bool SplitNeighbour(int face, int side) {
    const std::array<int, 3> flat = mesh_.faces[face];
    // A neighbour that runs the other way bounds the same material: splitting it keeps a closed mesh closed,
    // at edges of more than two triangles as well.
    Side other = kNoSide;
    bool opposite = false;
    for (const EdgeSide& beside : SidesOn(face, side)) {
      if (FaceOf(beside.side) == face) continue;
      if (done_[FaceOf(beside.side)] != 0) return false;
      const bool runs_back = mesh_.faces[FaceOf(beside.side)][CornerOf(beside.side)] != flat[side];
      if (other != kNoSide && (opposite || !runs_back)) continue;
      other = beside.side;
      opposite = runs_back;
    }
    if (other == kNoSide) return true;  // a rim
    const std::array<int, 3> neighbour = mesh_.faces[FaceOf(other)];
    const int p = neighbour[CornerOf(other)], q = neighbour[(CornerOf(other) + 1) % 3];
    const int apex = neighbour[(CornerOf(other) + 2) % 3], middle = flat[(side + 2) % 3];
    done_[FaceOf(other)] = 1;
    if (apex == middle) {  // folded onto itself: both go
      removed_[FaceOf(other)] = 1;
      return true;
    }
    mesh_.faces[FaceOf(other)] = {p, middle, apex};
    mesh_.faces.push_back({middle, q, apex});
    if (!mesh_.source.empty()) mesh_.source.push_back(mesh_.source[FaceOf(other)]);
    return true;
  }

  Triangles& mesh_;
  double tolerance_;
  size_t originals_;
  size_t count_;
  std::vector<char> done_;     // removed or changed in this round
  std::vector<char> removed_;  // in this round
  std::vector<EdgeSide> sides_;
};

// Removes flat triangles in rounds; whether there were any. The first `originals` faces are those that were
// read.
bool RemoveFlat(Triangles& mesh, double tolerance, size_t& originals, RepairCounts& counts) {
  constexpr int kRounds = 256;  // chains of flat triangles need one each; what is left then is only removed
  const size_t before = originals;
  for (int round = 0; round < kRounds; ++round) {
    const auto [removed, originals_removed] = FlatRemoval(mesh, tolerance, originals).Run();
    originals -= originals_removed;
    if (removed == 0) {
      counts.degenerate += before - originals;
      return round > 0;
    }
  }
  size_t left = originals;
  EraseFaces(mesh, [&](size_t f) {
    const bool flat = FlatnessOf(mesh, mesh.faces[f]).height <= tolerance;
    if (f < originals && flat) --left;
    return flat;
  });
  originals = left;
  counts.degenerate += before - originals;
  return true;
}

}  // namespace

void RemoveDegenerate(Triangles& mesh, double tolerance, RepairCounts& counts) {
  counts.degenerate += EraseFaces(mesh, [&](size_t f) { return HasRepeatedVertex(mesh.faces[f]); });
  constexpr int kPasses = 8;  // a crack may show when the flat triangles beside it are gone
  size_t originals = mesh.faces.size();
  bool changed = true;  // since cracks were looked for
  for (int pass = 0; pass < kPasses && changed; ++pass) {
    const size_t split = CloseTJunctions(mesh, tolerance);
    counts.t_junctions += split;
    if (pass > 0 && split == 0) return;
    changed = RemoveFlat(mesh, tolerance, originals, counts) || split > 0;
  }
}

namespace {

// The faces with three vertices in common, by number.
std::vector<std::vector<int>> SameFaces(const Triangles& mesh) {
  std::vector<std::pair<std::array<int, 3>, int>> sorted;
  sorted.reserve(mesh.faces.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    std::array<int, 3> key = mesh.faces[f];
    std::ranges::sort(key);
    sorted.emplace_back(key, static_cast<int>(f));
  }
  std::ranges::sort(sorted);
  std::vector<std::vector<int>> same;
  for (size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].first != sorted[i - 1].first) continue;
    if (same.empty() || same.back().back() != sorted[i - 1].second) same.push_back({sorted[i - 1].second});
    same.back().push_back(sorted[i].second);
  }
  return same;
}

// Whether every edge has an even number of triangles: then the triangles bound something everywhere.
bool IsClosed(const Triangles& mesh) {
  bool closed = true;
  ForEachEdge(SortedSides(mesh),
              [&](size_t begin, size_t end) { closed = closed && (end - begin) % 2 == 0; });
  return closed;
}

}  // namespace

void RemoveDuplicates(Triangles& mesh, RepairCounts& counts) {
  const std::vector<std::vector<int>> same = SameFaces(mesh);
  if (same.empty()) return;
  // In a closed mesh two triangles in one place are a wall without thickness: both go, or the mesh would
  // open. A mesh that is hardly anything else was written twice, or is a sheet drawn from both sides: one of
  // each is enough.
  const bool walls = 3 * same.size() < mesh.faces.size() && IsClosed(mesh);
  std::vector<char> removed(mesh.faces.size(), 0);
  for (const std::vector<int>& faces : same) {
    const bool cancels = walls && faces.size() % 2 == 0;
    for (size_t i = cancels ? 0 : 1; i < faces.size(); ++i) removed[faces[i]] = 1;
  }
  counts.duplicate += EraseFaces(mesh, [&](size_t f) { return removed[f] != 0; });
}

void DropUnusedVertices(Triangles& mesh) {
  std::vector<int> moved(mesh.vertices.size(), -1);
  for (const auto& face : mesh.faces)
    for (const int v : face) moved[v] = 0;
  int next = 0;
  for (size_t v = 0; v < moved.size(); ++v)
    if (moved[v] == 0) {
      mesh.vertices[next] = mesh.vertices[v];
      moved[v] = next++;
    }
  mesh.vertices.resize(next);
  for (auto& face : mesh.faces)
    for (int& v : face) v = moved[v];
}

}  // namespace millpose
