// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice/cylinder_slices.hpp"

#include <numbers>

#include "base/parallel.hpp"
#include "base/trig.hpp"
#include "geometry/mesh/triangle.hpp"
#include "geometry/slice/link_chains.hpp"

namespace millpose {
namespace {

// A crossing of an edge with the cylinder: known by its edge and which root it is, so that both faces at the
// edge speak of the same point.
struct Crossing {
  int low = 0, high = 0, root = 0;
  double along = 0;  // 0..1 from the low to the high vertex
  Eigen::Vector3d position;
  bool leaves = false;  // going round the face counter-clockwise, the edge leaves the cylinder here

  std::tuple<int, int, int> Key() const { return {low, high, root}; }
};

struct FoundPiece {
  CurvePiece piece;
  std::tuple<int, int, int> from, to;
};

// One cylinder against all faces. A vertex on the cylinder counts as outside: the crossings of an edge then
// follow from its end points alone, and every face has as many ways in as out.
class CylinderCut {
 public:
  CylinderCut(const Mesh& mesh, const Axis& axis, const std::vector<double>& squared_radii, double radius)
      : mesh_(mesh),
        axis_(axis),
        squared_radii_(squared_radii),
        radius_(radius),
        u_(axis.direction.unitOrthogonal()),
        v_(axis.direction.cross(u_)) {}

  std::vector<Curve> Run() {
    for (int face = 0; face < mesh_.face_count(); ++face) CutFace(face);
    return Chains();
  }

 private:
  bool Inside(int vertex) const { return squared_radii_[vertex] < radius_ * radius_; }

  void CutFace(int face) {
    const auto& corners = mesh_.triangles().faces[face];
    std::vector<Crossing> crossings;
    for (int k = 0; k < 3; ++k) AddCrossings(corners[k], corners[(k + 1) % 3], crossings);
    if (crossings.empty()) {
      if (!Inside(corners[0])) AddWholeEllipse(face);
      return;
    }
    // What lies in the cylinder is convex: behind a way out the border follows the arc to the next way in.
    for (size_t i = 0; i < crossings.size(); ++i)
      if (crossings[i].leaves) AddArc(face, crossings[i], crossings[(i + 1) % crossings.size()]);
  }

  // The roots of |q + s d|² = r² over the edge, q and d seen along the axis, in the order from → to.
  void AddCrossings(int from, int to, std::vector<Crossing>& crossings) const {
    const int low = std::min(from, to), high = std::max(from, to);
    const bool low_inside = Inside(low), high_inside = Inside(high);
    if (low_inside && high_inside) return;
    const Eigen::Vector3d &p = mesh_.triangles().vertices[low], &q = mesh_.triangles().vertices[high];
    const Eigen::Vector3d offset = Flat(p - axis_.point), step = Flat(q - p);
    const double a = step.squaredNorm(), half_b = offset.dot(step);
    const double c = squared_radii_[low] - radius_ * radius_;
    const double discriminant = half_b * half_b - a * c;
    std::vector<Crossing> found;
    const auto add = [&](double s, int root) {
      s = std::clamp(s, 0.0, 1.0);
      found.push_back({low, high, root, s, p + s * (q - p), false});
    };
    const double sum = -half_b - std::copysign(std::sqrt(std::max(discriminant, 0.0)), half_b);
    const double r1 = a > 0 ? sum / a : 0, r2 = sum != 0 ? c / sum : 0;
    const double first = std::min(r1, r2), second = std::max(r1, r2);
    if (low_inside) {
      add(second, 0);
    } else if (high_inside) {
      add(first, 0);
    } else if (discriminant > 0 && a > 0 && half_b < 0 && -half_b < a) {
      add(first, 0);
      add(second, 1);
    }
    if (from == high) std::ranges::reverse(found);
    bool inside = Inside(from);
    for (Crossing& crossing : found) {
      crossing.leaves = inside;
      inside = !inside;
      crossings.push_back(crossing);
    }
  }

  Eigen::Vector3d Flat(const Eigen::Vector3d& d) const {
    return d - d.dot(axis_.direction) * axis_.direction;
  }

  double AngleOf(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = p - axis_.point;
    return Atan2(d.dot(v_), d.dot(u_));
  }

  // The ellipse in which the face's plane meets the cylinder, over the angle about the axis.
  CurvePiece Ellipse(int face) const {
    const Eigen::Vector3d& n = mesh_.FaceNormal(face);
    const double slope = n.dot(axis_.direction);
    CurvePiece piece;
    piece.face = face;
    piece.arc = true;
    piece.centre = axis_.point + n.dot(mesh_.Corner(face, 0) - axis_.point) / slope * axis_.direction;
    piece.u = radius_ * (u_ - n.dot(u_) / slope * axis_.direction);
    piece.v = radius_ * (v_ - n.dot(v_) / slope * axis_.direction);
    return piece;
  }

  void AddArc(int face, const Crossing& out, const Crossing& in) {
    const double slope = mesh_.FaceNormal(face).dot(axis_.direction);
    CurvePiece piece = LinePiece(face, out.position, in.position);
    // On a facet (nearly) parallel to the axis the arc is a line to well below rounding.
    if (std::abs(slope) > 1e-6 && out.position != in.position) {
      CurvePiece arc = Ellipse(face);
      arc.start = out.position;
      arc.end = in.position;
      arc.angle0 = AngleOf(out.position);
      arc.angle1 = AngleOf(in.position);
      const double turn = 2 * std::numbers::pi;
      if (slope > 0 && arc.angle1 < arc.angle0) arc.angle1 += turn;
      if (slope < 0 && arc.angle1 > arc.angle0) arc.angle1 -= turn;
      // Where the cylinder only nicks a corner, rounding can swap the ends; then the way round leaves the
      // face.
      if (mesh_.ClosestOnFace(arc.At(0.5), face).distance < 1e-6) piece = arc;
    }
    pieces_.push_back({piece, out.Key(), in.Key()});
  }

  void AddWholeEllipse(int face) {
    const double slope = mesh_.FaceNormal(face).dot(axis_.direction);
    if (std::abs(slope) <= 1e-6) return;
    CurvePiece piece = Ellipse(face);
    if (mesh_.ClosestOnFace(piece.centre, face).distance > 1e-9 * (1 + radius_)) return;
    piece.angle1 = slope > 0 ? 2 * std::numbers::pi : -2 * std::numbers::pi;
    piece.start = piece.end = piece.centre + piece.u;
    const std::tuple<int, int, int> own{-1, face, 0};
    pieces_.push_back({piece, own, own});
  }

  // Pieces end to end; open chains first found first, then closed ones.
  std::vector<Curve> Chains() const {
    std::vector<Curve> curves;
    for (const LinkChain& chain : ChainLinks<std::map<std::tuple<int, int, int>, size_t>>(pieces_)) {
      Curve curve;
      curve.closed = chain.closed;
      for (const size_t i : chain.links)
        if (pieces_[i].piece.arc || pieces_[i].piece.start != pieces_[i].piece.end)
          curve.pieces.push_back(pieces_[i].piece);
      if (!curve.pieces.empty()) curves.push_back(std::move(curve));
    }
    return curves;
  }

  const Mesh& mesh_;
  const Axis& axis_;
  const std::vector<double>& squared_radii_;  // of the vertices
  double radius_;
  Eigen::Vector3d u_, v_;  // with the axis' direction a right-handed frame
  std::vector<FoundPiece> pieces_;
};

}  // namespace

std::vector<std::vector<Curve>> SliceByCylinders(const Mesh& mesh, const Axis& axis,
                                                 const std::vector<double>& radii, std::stop_token stop) {
  std::vector<double> squared;
  squared.reserve(mesh.triangles().vertices.size());
  for (const Eigen::Vector3d& p : mesh.triangles().vertices) {
    const double r = axis.Radius(p);
    squared.push_back(r * r);
  }
  std::vector<std::vector<Curve>> slices;
  for (const double radius : radii) {
    CheckStop(stop);
    slices.push_back(CylinderCut(mesh, axis, squared, radius).Run());
  }
  return slices;
}

}  // namespace millpose
