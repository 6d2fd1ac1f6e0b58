// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/trim_contour.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/corner_normals.hpp"
#include "geometry/mesh/fitted_normals.hpp"
#include "geometry/mesh/triangle.hpp"
#include "toolpath/lost_faces.hpp"

namespace millpose {
namespace {

constexpr double kSamePlace = 1e-6;  // mm

// A closed border of a region as sides (face, corner) of its faces, which lie on the left of their way.
using Loop = std::vector<std::pair<int, int>>;

class BorderFinder {
 public:
  explicit BorderFinder(const Region& region) : region_(region), mesh_(region.mesh()) {}

  std::vector<Loop> Loops() const {
    std::vector<Loop> loops;
    std::vector<std::array<char, 3>> seen(static_cast<size_t>(mesh_.face_count()));
    for (int face = 0; face < mesh_.face_count(); ++face)
      for (int k = 0; k < 3; ++k) {
        if (!IsBorder(face, k) || seen[static_cast<size_t>(face)][static_cast<size_t>(k)] != 0) continue;
        Loop& loop = loops.emplace_back();
        for (std::pair<int, int> at{face, k};
             seen[static_cast<size_t>(at.first)][static_cast<size_t>(at.second)]++ == 0; at = Next(at))
          loop.push_back(at);
      }
    return loops;
  }

 private:
  bool IsBorder(int face, int k) const {
    const int other = mesh_.Neighbour(face, k);
    return region_.HasFace(face) && (other < 0 || !region_.HasFace(other));
  }

  int Vertex(int face, int k) const {
    return mesh_.triangles().faces[static_cast<size_t>(face)][static_cast<size_t>(k)];
  }

  // The border's side that begins where this one ends, found by going round that corner through the region.
  std::pair<int, int> Next(std::pair<int, int> at) const {
    auto [face, k] = at;
    k = (k + 1) % 3;
    const int corner = Vertex(face, k);
    while (!IsBorder(face, k)) {
      face = mesh_.Neighbour(face, k);
      k = 0;
      while (Vertex(face, k) != corner) ++k;
    }
    return {face, k};
  }

  const Region& region_;
  const Mesh& mesh_;
};

double DistanceTo(const Contour& contour, size_t segment, const Eigen::Vector3d& p, double* along = nullptr) {
  const Eigen::Vector3d &a = contour.From(segment).place, &b = contour.To(segment).place;
  const double t = ClosestOnSegment(p, a, b);
  if (along != nullptr) *along = t;
  return (a + t * (b - a) - p).norm();
}

// Where along the contour p lies nearest: segment + share.
double Along(const Contour& contour, const Eigen::Vector3d& p) {
  double best = std::numeric_limits<double>::infinity(), found = 0;
  for (size_t i = 0; i < contour.Segments(); ++i) {
    double share = 0;
    const double distance = DistanceTo(contour, i, p, &share);
    if (distance < best) best = distance, found = static_cast<double>(i) + share;
  }
  return found;
}

ContourPoint At(const Contour& contour, double along) {
  const size_t segment = std::min(static_cast<size_t>(along), contour.Segments() - 1);
  const double share = along - static_cast<double>(segment);
  const ContourPoint &a = contour.From(segment), &b = contour.To(segment);
  return {a.place + share * (b.place - a.place), (a.axis + share * (b.axis - a.axis)).normalized()};
}

// A closed contour's part from one place to another, in its own way.
Contour StretchOf(const Contour& contour, double from, double to) {
  const auto count = static_cast<double>(contour.points.size());
  if (to <= from) to += count;
  Contour part;
  part.points.push_back(At(contour, from));
  for (double i = std::floor(from) + 1; i < to; ++i)
    part.points.push_back(contour.points[static_cast<size_t>(std::fmod(i, count))]);
  part.points.push_back(At(contour, std::fmod(to, count)));
  return part;
}

// Points at one place become one.
void DropRepeated(Contour& contour) {
  std::vector<ContourPoint> kept;
  for (const ContourPoint& point : contour.points)
    if (kept.empty() || (point.place - kept.back().place).norm() > kSamePlace) kept.push_back(point);
  while (contour.closed && kept.size() > 1 && (kept.back().place - kept.front().place).norm() <= kSamePlace)
    kept.pop_back();
  contour.points = std::move(kept);
}

std::string Listed(const std::vector<Contour>& contours) {
  std::vector<std::string> texts;
  for (const Contour& contour : contours) {
    double length = 0;
    for (size_t i = 0; i < contour.Segments(); ++i)
      length += (contour.To(i).place - contour.From(i).place).norm();
    const Eigen::Vector3d& p = contour.points[0].place;
    texts.push_back(
        fmt::format("{:.1f} mm long through ({:.3f}, {:.3f}, {:.3f})", length, p.x(), p.y(), p.z()));
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

Contour FromBorder(const TrimBorder& border, const StrategyInputs& inputs) {
  RefuseLostFaces(inputs.mesh, inputs.options.region);
  const Region region(inputs.mesh, inputs.options.region);
  const CornerNormals normals(inputs.mesh, inputs.options.crease);
  const FittedNormals fitted(
      inputs.mesh, [&](int face) { return region.HasFace(face); }, inputs.options.crease);
  std::vector<Contour> contours;
  for (const Loop& loop : BorderFinder(region).Loops()) {
    Contour& contour = contours.emplace_back();
    contour.closed = true;
    for (auto side = loop.rbegin(); side != loop.rend(); ++side) {  // the part on the right
      const int end = (side->second + 1) % 3;
      const Eigen::Vector3d& place = inputs.mesh.Corner(side->first, end);
      const Eigen::Vector3d normal =
          fitted.At(place, side->first, normals.OfFace(side->first)[static_cast<size_t>(end)]);
      contour.points.push_back({place, ToolAxisAt(inputs.options.tool_axis, place, normal)});
    }
    DropRepeated(contour);
  }
  if (contours.empty())
    throw InputError({},
                     "toolpath.trim.border: the region has no border: neither a rim nor an edge to a face "
                     "that is out of it");
  size_t chosen = 0;
  if (!border.near && contours.size() > 1)
    throw InputError({}, fmt::format("toolpath.trim.border.near_mm: missing; the region has {} borders: {}",
                                     contours.size(), Listed(contours)));
  double best = std::numeric_limits<double>::infinity();
  for (size_t i = 0; border.near && i < contours.size(); ++i)
    for (size_t k = 0; k < contours[i].Segments(); ++k)
      if (const double distance = DistanceTo(contours[i], k, *border.near); distance < best)
        best = distance, chosen = i;
  const Contour& whole = contours[chosen];
  if (border.between.size() != 2) return whole;
  const double a = Along(whole, border.between[0]), b = Along(whole, border.between[1]);
  const double middle = Along(whole, *border.near);
  const auto within = [&](double from, double to) {
    return from < to ? from < middle && middle < to : middle > from || middle < to;
  };
  Contour stretch = within(a, b) ? StretchOf(whole, a, b) : StretchOf(whole, b, a);
  DropRepeated(stretch);
  return stretch;
}

// The region's faces alone, to take normals from: beside an edge the nearest face of a part may be a wall.
class SurfaceNormals {
 public:
  SurfaceNormals(const SurfaceNormals&) = delete;
  SurfaceNormals& operator=(const SurfaceNormals&) = delete;
  SurfaceNormals(const Mesh& mesh, const ToolpathOptions& options)
      : mesh_(mesh),
        region_(mesh, options.region),
        normals_(mesh, options.crease),
        fitted_(
            mesh, [this](int face) { return region_.HasFace(face); }, options.crease) {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (int face = 0; face < mesh.face_count(); ++face) {
      if (!region_.HasFace(face)) continue;
      faces_.push_back(face);
      boxes.emplace_back(mesh.Corner(face, 0));
      boxes.back().extend(mesh.Corner(face, 1)).extend(mesh.Corner(face, 2));
    }
    if (faces_.empty())
      throw InputError({}, "toolpath.region: holds no face that the trim's line could take its axis from");
    tree_ = Bvh(boxes);
  }

  Eigen::Vector3d At(const Eigen::Vector3d& p) const {
    const auto on = [&](int i) { return mesh_.ClosestOnFace(p, faces_[static_cast<size_t>(i)]); };
    const int nearest = tree_
                            .Nearest(p, std::numeric_limits<double>::infinity(),
                                     [&](int i) { return (on(i).position - p).squaredNorm(); })
                            .first;
    const int face = faces_[static_cast<size_t>(nearest)];
    return fitted_.At(on(nearest).position, face, normals_.At(face, on(nearest).barycentric));
  }

 private:
  const Mesh& mesh_;
  Region region_;
  CornerNormals normals_;
  FittedNormals fitted_;
  std::vector<int> faces_;
  Bvh tree_;
};

// Twice the area round which a closed line runs, seen against the mean axis: above 0 anticlockwise.
double Turning(const Contour& contour) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero(), area = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& first = contour.points[0].place;
  for (size_t i = 0; i < contour.Segments(); ++i) {
    axis += contour.From(i).axis;
    area += (contour.From(i).place - first).cross(contour.To(i).place - first);
  }
  return area.dot(axis);
}

Contour FromLine(const TrimLine& line, const StrategyInputs& inputs) {
  const ToolpathOptions& options = inputs.options;
  const bool by_normal =
      options.tool_axis.rule == AxisRule::kNormal || options.tool_axis.rule == AxisRule::kWall;
  if (by_normal && inputs.mesh.face_count() == 0)
    throw InputError({},
                     "toolpath.tool_axis: missing; without a part a trim's line has no normals to follow");
  std::optional<SurfaceNormals> normals;
  if (by_normal) normals.emplace(inputs.mesh, options);
  Contour contour;
  contour.closed = line.closed;
  for (const Eigen::Vector3d& p : line.points)
    contour.points.push_back(
        {p, ToolAxisAt(options.tool_axis, p, by_normal ? normals->At(p) : Eigen::Vector3d::UnitZ())});
  DropRepeated(contour);
  if (contour.points.size() < (line.closed ? 3U : 2U))
    throw InputError({}, "toolpath.trim.line.points_mm: the points lie at too few places");
  bool left = line.side == LineSide::kLeft;
  if (line.side == LineSide::kInside || line.side == LineSide::kOutside)
    left = (Turning(contour) > 0) == (line.side == LineSide::kInside);
  if (!left) std::ranges::reverse(contour.points);
  return contour;
}

}  // namespace

Contour ContourOf(const Trim& trim, const StrategyInputs& inputs) {
  return trim.border ? FromBorder(*trim.border, inputs) : FromLine(*trim.line, inputs);
}

}  // namespace millpose
