// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of equal distance from the region's rims, one inside the other.
#include "base/parallel.hpp"
#include "toolpath/spread.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

using Edge = std::pair<int, int>;  // ascending

Edge EdgeOf(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// The region's faces cut into triangles no longer than a length, each with the face it lies in. Edges are
// halved the same way from both sides, so there are no cracks.
struct FineMesh {
  std::vector<Eigen::Vector3d> vertices;
  struct Triangle {
    std::array<int, 3> corners;
    int face;
  };
  std::vector<Triangle> triangles;
};

class Refiner {
 public:
  Refiner(const Mesh& mesh, const Region& region, double longest) : longest_(longest) {
    fine_.vertices = mesh.triangles().vertices;
    for (int face = 0; face < mesh.face_count(); ++face)
      if (region.HasFace(face)) fine_.triangles.push_back({mesh.triangles().faces[face], face});
  }

  FineMesh Run(const std::stop_token& stop) {
    for (bool split = true; split;) {
      CheckStop(stop);
      split = false;
      middles_.clear();
      std::vector<FineMesh::Triangle> before;
      before.swap(fine_.triangles);
      for (const auto& triangle : before) split = Split(triangle) || split;
    }
    return std::move(fine_);
  }

 private:
  // The vertex in the middle of an edge, or -1 when the edge is short enough.
  int Middle(int a, int b) {
    if ((fine_.vertices[a] - fine_.vertices[b]).norm() <= longest_) return -1;
    const auto [entry, added] = middles_.try_emplace(EdgeOf(a, b), static_cast<int>(fine_.vertices.size()));
    if (added) fine_.vertices.push_back((fine_.vertices[a] + fine_.vertices[b]) / 2);
    return entry->second;
  }

  void Add(int a, int b, int c, int face) { fine_.triangles.push_back({{a, b, c}, face}); }

  bool Split(const FineMesh::Triangle& triangle) {
    std::array<int, 3> corner = triangle.corners, middle{};
    for (int k = 0; k < 3; ++k) middle[k] = Middle(corner[k], corner[(k + 1) % 3]);
    const int halved = static_cast<int>(std::ranges::count_if(middle, [](int m) { return m >= 0; }));
    // Turn it so that side 0 is halved and, of two, side 1 is the other.
    for (int turn = 0;
         halved < 3 && halved > 0 && turn < 3 && !(middle[0] >= 0 && (halved == 1 || middle[1] >= 0));
         ++turn) {
      std::ranges::rotate(corner, corner.begin() + 1);
      std::ranges::rotate(middle, middle.begin() + 1);
    }
    const auto [a, b, c] = corner;
    if (halved == 0) {
      fine_.triangles.push_back(triangle);
    } else if (halved == 1) {
      Add(a, middle[0], c, triangle.face);
      Add(middle[0], b, c, triangle.face);
    } else if (halved == 2) {
      Add(middle[0], b, middle[1], triangle.face);
      Add(a, middle[0], middle[1], triangle.face);
      Add(a, middle[1], c, triangle.face);
    } else {
      for (int k = 0; k < 3; ++k) Add(corner[k], middle[k], middle[(k + 2) % 3], triangle.face);
      Add(middle[0], middle[1], middle[2], triangle.face);
    }
    return halved > 0;
  }

  double longest_;
  FineMesh fine_;
  std::map<Edge, int> middles_;
};

// One line of equal distance: marches through the triangles, crossings are found on the edges by bisection.
class LevelLine {
 public:
  LevelLine(const FineMesh& fine, const std::vector<double>& distance, const Region& region, double level,
            double tolerance)
      : fine_(fine), distance_(distance), region_(region), level_(level), tolerance_(tolerance) {}

  std::vector<Curve> Run() {
    for (const auto& triangle : fine_.triangles) Cross(triangle);
    return Chains();
  }

 private:
  struct Part {
    CurvePiece piece;
    Edge from, to;
  };

  // The higher distances lie on the left of the line, seen against the normal.
  void Cross(const FineMesh::Triangle& triangle) {
    Edge from, to;
    int crossings = 0;
    for (int k = 0; k < 3; ++k) {
      const int a = triangle.corners[k], b = triangle.corners[(k + 1) % 3];
      const bool in_a = distance_[a] >= level_, in_b = distance_[b] >= level_;
      if (in_a == in_b) continue;
      (in_a ? from : to) = EdgeOf(a, b);
      ++crossings;
    }
    if (crossings == 2) parts_.push_back({LinePiece(triangle.face, Crossing(from), Crossing(to)), from, to});
  }

  Eigen::Vector3d Crossing(const Edge& edge) {
    const auto [entry, added] = crossings_.try_emplace(edge);
    if (added) {
      Eigen::Vector3d low = fine_.vertices[edge.first], high = fine_.vertices[edge.second];
      if (distance_[edge.first] >= level_) std::swap(low, high);
      for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d middle = (low + high) / 2;
        (region_.BorderDistance(middle) >= level_ ? high : low) = middle;
      }
      entry->second = high;
    }
    return entry->second;
  }

  // A line with a corner or a bend between two edges: points are added where the chord misses the level.
  void AddRefined(int face, const Eigen::Vector3d& a, const Eigen::Vector3d& b, int depth,
                  Curve& curve) const {
    if (a == b) return;
    Eigen::Vector3d middle = (a + b) / 2;
    if (depth > 0 && std::abs(region_.BorderDistance(middle) - level_) > tolerance_ &&
        MoveToLevel(face, b - a, middle)) {
      AddRefined(face, a, middle, depth - 1, curve);
      AddRefined(face, middle, b, depth - 1, curve);
    } else {
      curve.pieces.push_back(LinePiece(face, a, b));
    }
  }

  // Moves p across the way, within its face, to where the level is; false when it is not found there.
  bool MoveToLevel(int face, const Eigen::Vector3d& way, Eigen::Vector3d& p) const {
    const Mesh& mesh = region_.mesh();
    // The distance grows to the left of the way.
    Eigen::Vector3d across = mesh.FaceNormal(face).cross(way);
    if (region_.BorderDistance(p) >= level_) across = -across;
    const bool inside = region_.BorderDistance(p) >= level_;
    Eigen::Vector3d near = p, far = p + across;
    if ((region_.BorderDistance(far) >= level_) == inside) return false;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d middle = (near + far) / 2;
      ((region_.BorderDistance(middle) >= level_) == inside ? near : far) = middle;
    }
    if (mesh.ClosestOnFace(near, face).distance > 1e-9) return false;
    p = near;
    return true;
  }

  std::vector<Curve> Chains() const {
    std::map<Edge, size_t> starting;
    std::map<Edge, size_t> ending;
    for (size_t i = 0; i < parts_.size(); ++i) {
      starting[parts_[i].from] = i;
      ending[parts_[i].to] = i;
    }
    std::vector<char> used(parts_.size(), 0);
    std::vector<Curve> curves;
    const auto follow = [&](size_t at, bool closed) {
      Curve curve;
      curve.closed = closed;
      while (used[at] == 0) {
        used[at] = 1;
        const CurvePiece& piece = parts_[at].piece;
        AddRefined(piece.face, piece.start, piece.end, 8, curve);
        const auto next = starting.find(parts_[at].to);
        if (next != starting.end()) at = next->second;
      }
      if (!curve.pieces.empty()) curves.push_back(std::move(curve));
    };
    for (size_t i = 0; i < parts_.size(); ++i)
      if (!ending.contains(parts_[i].from)) follow(i, false);
    for (size_t i = 0; i < parts_.size(); ++i)
      if (used[i] == 0) follow(i, true);
    return curves;
  }

  const FineMesh& fine_;
  const std::vector<double>& distance_;
  const Region& region_;
  double level_, tolerance_;
  std::vector<Part> parts_;
  std::map<Edge, Eigen::Vector3d> crossings_;
};

class Contours : public Strategy {
 public:
  std::vector<Lane> Lanes(const Mesh& mesh, const Region& region, const ToolpathOptions& options,
                          std::stop_token stop) const override {
    if (!region.HasBorders()) return {};
    const FineMesh fine = Refiner(mesh, region, options.stepover / 2).Run(stop);
    std::vector<double> distance(fine.vertices.size(), 0.0);
    double largest = 0;
    std::vector<char> used(fine.vertices.size(), 0);
    for (const auto& triangle : fine.triangles)
      for (const int v : triangle.corners) used[v] = 1;
    for (size_t v = 0; v < distance.size(); ++v) {
      if (used[v] == 0) continue;
      if (v % 4096 == 0) CheckStop(stop);
      distance[v] = region.BorderDistance(fine.vertices[v]);
      largest = std::max(largest, distance[v]);
    }
    std::vector<Lane> lanes;
    if (largest <= options.region.rim_distance) return lanes;
    for (const double level : SpreadEvenly(options.region.rim_distance, largest, options.stepover)) {
      CheckStop(stop);
      lanes.push_back({LevelLine(fine, distance, region, level, options.chord_tolerance).Run(),
                       [](const Eigen::Vector3d&) { return 0.0; }, false});
    }
    return lanes;
  }
};

}  // namespace

std::unique_ptr<Strategy> MakeContours() { return std::make_unique<Contours>(); }

}  // namespace millpose
