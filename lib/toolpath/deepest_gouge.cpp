// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/deepest_gouge.hpp"

#include "base/trig.hpp"

namespace millpose {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

struct Depth {
  double value;
  Eigen::Vector3d slope;  // a supergradient
};

// Depth of a point given in the tool's frame: negative distance from the rounded cylinder.
Depth DepthAt(const CutterShape& cutter, const Eigen::Vector3d& p) {
  const double r = cutter.corner_radius, distance = Hypot(p.x(), p.y());
  const double out = distance - (cutter.radius - r), down = r - p.z();
  const Eigen::Vector3d outwards =
      distance > 0 ? Eigen::Vector3d(p.x() / distance, p.y() / distance, 0) : Eigen::Vector3d::UnitX();
  if (out > 0 && down > 0) {
    const double length = Hypot(out, down);
    return {r - length, (down * Eigen::Vector3d::UnitZ() - out * outwards) / length};
  }
  return out > down ? Depth{r - out, -outwards} : Depth{r - down, Eigen::Vector3d::UnitZ()};
}

/// Branch and bound over triangles in the tool's frame.
class DeepestPoint {
 public:
  DeepestPoint(const CutterShape& cutter, double tolerance) : cutter_(cutter), best_(tolerance) {}

  /// Returns whether a deeper place was found; with `any`, at the first one.
  bool Look(const Corners& triangle, bool any) {
    bool found = false;
    stack_.assign(1, triangle);
    while (!stack_.empty() && !(any && found)) {
      const Corners corner = stack_.back();
      stack_.pop_back();
      const Eigen::Vector3d centre = (corner[0] + corner[1] + corner[2]) / 3;
      const Depth depth = DepthAt(cutter_, centre);
      found = Try(centre, depth.value) || found;
      double bound = -std::numeric_limits<double>::infinity();
      for (const Eigen::Vector3d& p : corner)
        bound = std::max(bound, depth.value + depth.slope.dot(p - centre));
      if (bound <= best_ + std::max(1e-4, 1e-3 * best_)) continue;
      for (const Eigen::Vector3d& p : corner) found = Try(p, DepthAt(cutter_, p).value) || found;
      Halve(corner);
    }
    return found;
  }

  double best() const { return best_; }
  const Eigen::Vector3d& place() const { return place_; }

 private:
  bool Try(const Eigen::Vector3d& p, double depth) {
    if (!(depth > best_)) return false;
    best_ = depth;
    place_ = p;
    return true;
  }

  void Halve(const Corners& corner) {
    int longest = 0;
    std::array<double, 3> length;
    for (int k = 0; k < 3; ++k) {
      length[k] = (corner[(k + 1) % 3] - corner[k]).squaredNorm();
      if (length[k] > length[longest]) longest = k;
    }
    const Eigen::Vector3d &a = corner[longest], &b = corner[(longest + 1) % 3],
                          &c = corner[(longest + 2) % 3];
    const Eigen::Vector3d middle = (a + b) / 2;
    stack_.push_back({a, middle, c});
    stack_.push_back({middle, b, c});
  }

  const CutterShape& cutter_;
  double best_;
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
  std::vector<Corners> stack_;
};

// The part of a triangle that is not above the cutter: none, one or two triangles.
std::vector<Corners> Below(const Corners& corner, double length) {
  std::vector<Eigen::Vector3d> polygon;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d &a = corner[k], &b = corner[(k + 1) % 3];
    if (a.z() <= length) polygon.push_back(a);
    if ((a.z() < length && b.z() > length) || (a.z() > length && b.z() < length))
      polygon.push_back(a + (length - a.z()) / (b.z() - a.z()) * (b - a));
  }
  std::vector<Corners> parts;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) parts.push_back({polygon[0], polygon[i], polygon[i + 1]});
  return parts;
}

// The deepest place, or with `any` the first one found.
Gouge Search(const Mesh& mesh, const CutterShape& cutter, const Eigen::Vector3d& tip,
             const Eigen::Vector3d& axis, double tolerance, bool any) {
  Eigen::Matrix3d R;  // rows: the tool's axes
  R.row(0) = axis.unitOrthogonal();
  R.row(2) = axis;
  R.row(1) = axis.cross(R.row(0).transpose());
  DeepestPoint deepest(cutter, tolerance);
  Gouge gouge;
  const double reach = Hypot(cutter.radius, cutter.length / 2);
  // No place is deeper than it is high over the tip, so most faces cannot be deeper than the best so far.
  constexpr double kRounding = 1e-9;
  const auto height = [&](int face, int k) { return axis.dot(mesh.Corner(face, k) - tip); };
  for (const int face : mesh.FacesNear(tip + axis * cutter.length / 2, reach)) {
    if (std::max({height(face, 0), height(face, 1), height(face, 2)}) <= deepest.best() - kRounding) continue;
    Corners corner;
    for (int k = 0; k < 3; ++k) corner[k] = R * (mesh.Corner(face, k) - tip);
    for (const Corners& part : Below(corner, cutter.length)) {
      if (deepest.Look(part, any)) gouge = {deepest.best(), tip + R.transpose() * deepest.place(), face};
      if (any && gouge.face >= 0) return gouge;
    }
  }
  return gouge;
}

}  // namespace

Gouge DeepestGouge(const Mesh& mesh, const CutterShape& cutter, const Eigen::Vector3d& tip,
                   const Eigen::Vector3d& axis, double tolerance) {
  return Search(mesh, cutter, tip, axis, tolerance, false);
}

bool Gouges(const Mesh& mesh, const CutterShape& cutter, const Eigen::Vector3d& tip,
            const Eigen::Vector3d& axis, double tolerance) {
  return Search(mesh, cutter, tip, axis, tolerance, true).face >= 0;
}

}  // namespace millpose
