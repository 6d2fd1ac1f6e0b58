// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/weld.hpp"

#include <bit>

namespace millpose {
namespace {

using Cell = std::array<int64_t, 3>;

uint64_t Mix(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

uint64_t Hash(const Cell& cell) {
  uint64_t hash = 0;
  for (const int64_t index : cell) hash = Mix(hash + static_cast<uint64_t>(index) + 0x9e3779b97f4a7c15ULL);
  return hash;
}

// Open hashing from grid cells to chains of the vertices in them. Looked up, never iterated.
class Grid {
 public:
  Grid(size_t capacity, double edge, const Eigen::Vector3d& origin)
      : edge_(edge), origin_(origin), heads_(std::bit_ceil(2 * capacity + 1), -1) {}

  // The kept vertex of a body nearest to p within the tolerance (the lowest index on a tie), or -1.
  int Nearest(const Eigen::Vector3d& p, int body, double tolerance,
              const std::vector<Eigen::Vector3d>& kept) const {
    int nearest = -1;
    double best = tolerance * tolerance;
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(tolerance);
    const Cell low = CellOf(p - reach), high = CellOf(p + reach);
    Cell cell;
    for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0])
      for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1])
        for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2])
          for (int v = heads_[Slot(cell)]; v >= 0; v = next_[v]) {
            if (body_[v] != body) continue;
            const double distance = (kept[v] - p).squaredNorm();
            if (distance < best || (distance == best && (nearest < 0 || v < nearest))) {
              best = distance;
              nearest = v;
            }
          }
    return nearest;
  }

  // The kept vertex of a body at the very place, if it is among those added last; else -1. A file repeats its
  // vertices mostly soon.
  int Recent(const Eigen::Vector3d& p, int body, const std::vector<Eigen::Vector3d>& kept) const {
    const int vertex = recent_[RecentSlot(p)];
    return vertex >= 0 && kept[vertex] == p && body_[vertex] == body ? vertex : -1;
  }

  void Add(int vertex, int body, const Eigen::Vector3d& p) {
    recent_[RecentSlot(p)] = vertex;
    const size_t slot = Slot(CellOf(p));
    next_.push_back(heads_[slot]);
    body_.push_back(body);
    heads_[slot] = vertex;
  }

 private:
  Cell CellOf(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d scaled = (p - origin_) / edge_;
    return {static_cast<int64_t>(std::floor(scaled.x())), static_cast<int64_t>(std::floor(scaled.y())),
            static_cast<int64_t>(std::floor(scaled.z()))};
  }
  static size_t RecentSlot(const Eigen::Vector3d& p) {
    const auto bits = [&](int k) { return std::bit_cast<uint64_t>(p[k]); };
    return Mix(bits(0) + 3 * bits(1) + 5 * bits(2)) % kRecent;
  }
  size_t Slot(const Cell& cell) const { return Hash(cell) & (heads_.size() - 1); }

  static constexpr size_t kRecent = 1 << 14;

  double edge_;
  Eigen::Vector3d origin_;
  std::vector<int> heads_;
  std::vector<int> recent_ = std::vector<int>(kRecent, -1);
  std::vector<int> next_, body_;  // by vertex
};

}  // namespace

Triangles Weld(const Triangles& soup, double tolerance, size_t* joined, const std::vector<int>& body_of) {
  Triangles welded;
  if (soup.faces.empty()) return welded;
  Eigen::AlignedBox3d box;
  for (const auto& p : soup.vertices) box.extend(p);
  // Cells of four tolerances seldom have to look at a neighbour; the second bound keeps indices within 2^40.
  const double edge = std::max({4 * tolerance, box.diagonal().maxCoeff() * 0x1p-40, 1e-300});
  Grid grid(soup.vertices.size() / 2 + 1, edge, box.min());
  std::vector<int> target(soup.vertices.size(), -1);
  welded.faces.reserve(soup.faces.size());
  welded.source = soup.source;
  welded.source_faces = soup.source_faces;
  std::vector<Eigen::Vector3d> moved;  // what differs in some bit from the vertex it goes to
  for (size_t f = 0; f < soup.faces.size(); ++f) {
    const std::array<int, 3>& face = soup.faces[f];
    const int body = body_of.empty() ? -1 : body_of[f];
    std::array<int, 3> out{};
    for (int corner = 0; corner < 3; ++corner) {
      int& to = target[face[corner]];
      const Eigen::Vector3d& p = soup.vertices[face[corner]];
      if (to < 0) {
        to = grid.Recent(p, body, welded.vertices);
        if (to < 0) to = grid.Nearest(p, body, tolerance, welded.vertices);
        if (to < 0) {
          to = static_cast<int>(welded.vertices.size());
          grid.Add(to, body, p);
          welded.vertices.push_back(p);
        } else if (welded.vertices[to] != p) {
          moved.push_back(p);
        }
      }
      out[corner] = to;
    }
    welded.faces.push_back(out);
  }
  if (joined == nullptr) return welded;
  const auto key = [](const Eigen::Vector3d& p) { return std::tuple(p.x(), p.y(), p.z()); };
  std::ranges::sort(moved, {}, key);
  *joined = static_cast<size_t>(std::unique(moved.begin(), moved.end()) - moved.begin());
  return welded;
}

}  // namespace millpose
