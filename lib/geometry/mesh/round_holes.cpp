// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/round_holes.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/decompositions.hpp"
#include "base/units.hpp"
#include "geometry/mesh/circle_fit.hpp"
#include "geometry/mesh/corner_normals.hpp"

namespace millpose {
namespace {

constexpr double kWidestGap = DegToRad(61);  // between corners: less than half a wall is no hole
constexpr double kUpright = 0.02;            // sine of a wall facet's angle with the axis
constexpr size_t kLeastFaces = 8;

using Faces = std::vector<int>;

// The direction in which a set of vectors extends least.
Eigen::Vector3d LeastDirection(const Eigen::Matrix3d& scatter) {
  return EigenOfSymmetric3(scatter).vectors.col(0).normalized();
}

// Signs of eigenvectors mean nothing: the largest coordinate is made positive.
Eigen::Vector3d Signed(const Eigen::Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Eigen::Vector3d(-axis) : axis;
}

Eigen::Vector3d CentreOf(const Mesh& mesh, int face) {
  return (mesh.Corner(face, 0) + mesh.Corner(face, 1) + mesh.Corner(face, 2)) / 3;
}

std::vector<Eigen::Vector3d> CornersOf(const Mesh& mesh, const Faces& faces) {
  std::set<int> vertices;
  for (const int face : faces)
    for (const int vertex : mesh.triangles().faces[static_cast<size_t>(face)]) vertices.insert(vertex);
  std::vector<Eigen::Vector3d> corners;
  for (const int vertex : vertices) corners.push_back(mesh.triangles().vertices[static_cast<size_t>(vertex)]);
  return corners;
}

// Faces that hang together over edges which bend by at most `crease`.
class SmoothParts {
 public:
  SmoothParts(const Mesh& mesh, double crease) : part_of_(static_cast<size_t>(mesh.face_count()), -1) {
    for (int first = 0; first < mesh.face_count(); ++first) {
      if (part_of_[static_cast<size_t>(first)] >= 0) continue;
      const int number = static_cast<int>(parts_.size());
      Faces part{first};
      part_of_[static_cast<size_t>(first)] = number;
      for (size_t head = 0; head < part.size(); ++head)
        for (int k = 0; k < 3; ++k) {
          const int other = mesh.Neighbour(part[head], k);
          if (other < 0 || PartOf(other) >= 0 || BendAngle(mesh, part[head], k) > crease + 1e-6) continue;
          part_of_[static_cast<size_t>(other)] = number;
          part.push_back(other);
        }
      std::ranges::sort(part);
      parts_.push_back(std::move(part));
    }
  }

  const std::vector<Faces>& parts() const { return parts_; }
  int PartOf(int face) const { return part_of_[static_cast<size_t>(face)]; }

 private:
  std::vector<int> part_of_;
  std::vector<Faces> parts_;
};

// A cylinder that encloses a void, with its two ends along the axis.
struct Wall {
  Eigen::Vector3d axis, centre;
  double radius = 0, residual = 0;
  std::array<double, 2> end{};       // heights over the centre along the axis: lower, upper
  std::array<bool, 2> open{};        // no material ahead there
  std::array<int, 2> mouth{-1, -1};  // smooth part that lies over most of the end's edge
};

class HoleFinder {
 public:
  HoleFinder(const Mesh& mesh, double crease, double tolerance)
      : mesh_(mesh), tolerance_(tolerance), parts_(mesh, crease) {}

  std::vector<RoundHole> Find() {
    std::vector<RoundHole> holes;
    for (const Faces& part : parts_.parts())
      if (const auto wall = WallOf(part)) AddWall(*wall, part, holes);
    AddRims(holes);
    std::ranges::stable_sort(holes, {}, [](const RoundHole& hole) { return hole.faces.front(); });
    return holes;
  }

 private:
  std::optional<Wall> WallOf(const Faces& part) const {
    if (part.size() < kLeastFaces) return std::nullopt;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    double area = 0;
    for (const int face : part) {
      const Eigen::Vector3d& n = mesh_.FaceNormal(face);
      scatter += AreaOf(mesh_, face) * n * n.transpose();
      area += AreaOf(mesh_, face);
    }
    Wall wall;
    wall.axis = Signed(LeastDirection(scatter));
    if (wall.axis.dot(scatter * wall.axis) > kUpright * kUpright * area) return std::nullopt;
    const std::vector<Eigen::Vector3d> corners = CornersOf(mesh_, part);
    const auto fit = FitCircle(corners, wall.axis);
    if (!fit || fit->residual > tolerance_ || fit->widest_gap > kWidestGap) return std::nullopt;
    wall.centre = fit->centre;
    wall.radius = fit->radius;
    wall.residual = fit->residual;
    for (const int face : part) {
      const Eigen::Vector3d out = CentreOf(mesh_, face) - wall.centre;
      if (mesh_.FaceNormal(face).dot(out - out.dot(wall.axis) * wall.axis) >= 0) return std::nullopt;
    }
    FindEnds(part, corners, wall);
    return wall;
  }

  double Height(const Wall& wall, const Eigen::Vector3d& p) const { return wall.axis.dot(p - wall.centre); }

  double Beside(const Wall& wall, const Eigen::Vector3d& p) const {
    return (p - wall.centre - Height(wall, p) * wall.axis).norm();
  }

  // An end is open where the surface beyond its edge runs away from the axis.
  void FindEnds(const Faces& part, const std::vector<Eigen::Vector3d>& corners, Wall& wall) const {
    wall.end = {Height(wall, corners.front()), Height(wall, corners.front())};
    for (const Eigen::Vector3d& p : corners) {
      wall.end[0] = std::min(wall.end[0], Height(wall, p));
      wall.end[1] = std::max(wall.end[1], Height(wall, p));
    }
    std::array<double, 2> outwards{}, inwards{};
    std::array<std::map<int, double>, 2> beyond;  // length of edge by smooth part
    const int own = parts_.PartOf(part.front());
    for (const int face : part)
      for (int k = 0; k < 3; ++k) {
        const int other = mesh_.Neighbour(face, k);
        if (other >= 0 && parts_.PartOf(other) == own) continue;
        const Eigen::Vector3d a = mesh_.Corner(face, k), b = mesh_.Corner(face, (k + 1) % 3);
        const size_t end = Height(wall, (a + b) / 2) > (wall.end[0] + wall.end[1]) / 2 ? 1 : 0;
        const bool outside = other < 0 || Beside(wall, CentreOf(mesh_, other)) > Beside(wall, (a + b) / 2);
        (outside ? outwards : inwards)[end] += (b - a).norm();
        if (other >= 0) beyond[end][parts_.PartOf(other)] += (b - a).norm();
      }
    for (const size_t end : {0, 1}) {
      wall.open[end] = outwards[end] > inwards[end];
      double most = 0;
      for (const auto& [number, length] : beyond[end])
        if (length > most) most = length, wall.mouth[end] = number;
    }
  }

  // How far a cone that widens from the wall's end goes on, mm; 0 without one.
  double MouthDepth(const Wall& wall, size_t end) const {
    if (wall.mouth[end] < 0) return 0;
    const Faces& part = parts_.parts()[static_cast<size_t>(wall.mouth[end])];
    const double up = end == 1 ? 1 : -1;
    double widest = wall.radius, depth = 0;
    const std::vector<Eigen::Vector3d> corners = CornersOf(mesh_, part);
    for (const Eigen::Vector3d& p : corners) widest = std::max(widest, Beside(wall, p));
    for (const Eigen::Vector3d& p : corners) {
      const double radius = Beside(wall, p);
      if (std::min(radius - wall.radius, widest - radius) > tolerance_) return 0;
      if (widest - radius <= tolerance_) depth = std::max(depth, up * (Height(wall, p) - wall.end[end]));
    }
    for (const int face : part) {
      const Eigen::Vector3d out = CentreOf(mesh_, face) - wall.centre;
      const double along = up * mesh_.FaceNormal(face).dot(wall.axis);
      const bool cone = along > kUpright && along < 1 - kUpright * kUpright / 2 &&
                        mesh_.FaceNormal(face).dot(out - out.dot(wall.axis) * wall.axis) < 0;
      if (!cone) return 0;
    }
    return depth;
  }

  void AddWall(Wall wall, const Faces& part, std::vector<RoundHole>& holes) const {
    if (!wall.open[0] && !wall.open[1]) return;
    for (const size_t end : {0, 1})
      if (wall.open[end]) wall.end[end] += (end == 1 ? 1 : -1) * MouthDepth(wall, end);
    RoundHole& hole = holes.emplace_back();
    hole.kind = wall.open[0] && wall.open[1] ? HoleKind::kThrough : HoleKind::kBlind;
    const size_t mouth = wall.open[1] ? 1 : 0;
    hole.entrance = wall.centre + wall.end[mouth] * wall.axis;
    hole.axis = mouth == 1 ? wall.axis : Eigen::Vector3d(-wall.axis);
    hole.diameter = 2 * wall.radius;
    hole.depth = wall.end[1] - wall.end[0];
    hole.residual = wall.residual;
    hole.faces = part;
  }

  // Rims are closed: of every vertex on one, a side of a face begins there and one ends.
  void AddRims(std::vector<RoundHole>& holes) const {
    std::map<int, std::pair<int, int>> side_from;  // by its first vertex: face and corner
    for (int face = 0; face < mesh_.face_count(); ++face)
      for (int k = 0; k < 3; ++k)
        if (mesh_.Neighbour(face, k) < 0) side_from[Vertex(face, k)] = {face, k};
    std::set<int> seen;
    for (const auto& [first, unused] : side_from) {
      std::vector<std::pair<int, int>> rim;
      for (int at = first; seen.insert(at).second;) {
        const auto next = side_from.find(at);
        if (next == side_from.end()) break;
        rim.push_back(next->second);
        at = Vertex(next->second.first, (next->second.second + 1) % 3);
      }
      if (rim.size() >= kLeastFaces) AddRim(rim, holes);
    }
  }

  int Vertex(int face, int k) const {
    return mesh_.triangles().faces[static_cast<size_t>(face)][static_cast<size_t>(k)];
  }

  void AddRim(const std::vector<std::pair<int, int>>& rim, std::vector<RoundHole>& holes) const {
    std::vector<Eigen::Vector3d> corners;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    for (const auto& [face, k] : rim) {
      corners.push_back(mesh_.Corner(face, k));
      mean += corners.back() / static_cast<double>(rim.size());
      normal += (mesh_.Corner(face, (k + 1) % 3) - corners.back()).norm() * mesh_.FaceNormal(face);
    }
    if (!(normal.norm() > 1e-9)) return;
    normal.normalize();
    // A plane rim has an axis of its own, to all digits; one on a curved sheet that of the sheet beside it.
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : corners) scatter += (p - mean) * (p - mean).transpose();
    Eigen::Vector3d axis = LeastDirection(scatter);
    if (axis.dot(normal) < 0) axis = -axis;
    const bool plane = std::ranges::all_of(
        corners, [&](const Eigen::Vector3d& p) { return std::abs(axis.dot(p - mean)) <= tolerance_; });
    if (!plane) axis = normal;
    const auto fit = FitCircle(corners, axis);
    if (!fit || fit->residual > tolerance_ || fit->widest_gap > kWidestGap) return;
    RoundHole hole;
    hole.kind = HoleKind::kRim;
    hole.axis = axis;
    hole.diameter = 2 * fit->radius;
    hole.residual = fit->residual;
    double highest = 0, outwards = 0;
    for (size_t i = 0; i < rim.size(); ++i) {
      const Eigen::Vector3d to_middle = CentreOf(mesh_, rim[i].first) - fit->centre;
      const Eigen::Vector3d edge = (corners[i] + corners[(i + 1) % corners.size()]) / 2 - fit->centre;
      outwards += (to_middle - to_middle.dot(axis) * axis).norm() - (edge - edge.dot(axis) * axis).norm();
      highest = std::max(highest, axis.dot(corners[i] - fit->centre));
      hole.faces.push_back(rim[i].first);
    }
    if (!(outwards > tolerance_)) return;  // a disc's border, or the end of a tube
    hole.entrance = fit->centre + highest * axis;
    std::ranges::sort(hole.faces);
    hole.faces.erase(std::unique(hole.faces.begin(), hole.faces.end()), hole.faces.end());
    holes.push_back(std::move(hole));
  }

  const Mesh& mesh_;
  double tolerance_;
  SmoothParts parts_;
};

}  // namespace

std::vector<RoundHole> FindRoundHoles(const Mesh& mesh, double crease, double tolerance) {
  return HoleFinder(mesh, crease, tolerance).Find();
}

}  // namespace millpose
