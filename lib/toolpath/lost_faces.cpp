// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/lost_faces.hpp"

#include "base/error.hpp"
#include "geometry/import/mesh_import.hpp"
#include "toolpath/region_term.hpp"

namespace millpose {
namespace {

struct Face {
  const SourceFace& source;
  size_t number;  // from 0
  Eigen::AlignedBox3d box;

  /// `perhaps`: also by a place that may have been meant for it. What such a place chooses is another face,
  /// so none is certain.
  bool IsNamed(const std::vector<std::string>& names, bool perhaps) const {
    return std::ranges::any_of(names, [&](const std::string& name) {
      if (name == std::to_string(number + 1) || name == source.id || name == source.name) return true;
      const auto place = NearPlace(name);
      return perhaps && place && box.exteriorDistance(*place) <= kNearFace;
    });
  }

  // The largest (or smallest) height of the box above a plane.
  double Height(const HalfSpace& half, bool largest) const {
    const Eigen::Vector3d reach = box.sizes().cwiseProduct(half.normal.cwiseAbs()) / 2;
    return half.normal.dot(box.center() - half.point) + (largest ? 1 : -1) * reach.sum();
  }

  // Seen along the polygon's direction, as boxes about two axes across it.
  bool MayMeet(const ProjectedPolygon& polygon) const {
    const Eigen::Vector3d u = polygon.direction.unitOrthogonal(), v = polygon.direction.cross(u);
    for (const Eigen::Vector3d& axis : {u, v}) {
      const double middle = axis.dot(box.center()), reach = box.sizes().dot(axis.cwiseAbs()) / 2;
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Eigen::Vector3d& p : polygon.points) {
        low = std::min(low, axis.dot(p));
        high = std::max(high, axis.dot(p));
      }
      if (middle + reach < low || middle - reach > high) return false;
    }
    return true;
  }
};

// Whether all of the face certainly lies in the region.
bool LiesIn(const Face& face, const RegionOptions& region);

bool May(const Face& face, const RegionOptions& region) {
  const auto may = [&](const RegionOptions& child) { return May(face, child); };
  const auto lies = [&](const RegionOptions& child) { return LiesIn(face, child); };
  if (region.box && !face.box.intersects({region.box->lower, region.box->upper})) return false;
  if (region.half_space && face.Height(*region.half_space, true) < 0) return false;
  if (region.polygon && !face.MayMeet(*region.polygon)) return false;
  if (!region.source_faces.empty() && !face.IsNamed(region.source_faces, true)) return false;
  return std::ranges::all_of(region.all, may) &&
         (region.any.empty() || std::ranges::any_of(region.any, may)) &&
         std::ranges::none_of(region.none, lies);
}

bool LiesIn(const Face& face, const RegionOptions& region) {
  const auto may = [&](const RegionOptions& child) { return May(face, child); };
  const auto lies = [&](const RegionOptions& child) { return LiesIn(face, child); };
  if (region.polygon || region.facing || region.connected || region.rim_distance > 0) return false;
  if (region.box && !Eigen::AlignedBox3d(region.box->lower, region.box->upper).contains(face.box))
    return false;
  if (region.half_space && face.Height(*region.half_space, false) < 0) return false;
  if (!region.source_faces.empty() && !face.IsNamed(region.source_faces, false)) return false;
  return std::ranges::all_of(region.all, lies) &&
         (region.any.empty() || std::ranges::any_of(region.any, lies)) &&
         std::ranges::none_of(region.none, may);
}

}  // namespace

bool MayTouch(const SourceFace& face, size_t number, const RegionOptions& region) {
  return May({face, number, {face.lower, face.upper}}, region);
}

void RefuseLostFaces(const Mesh& mesh, const RegionOptions& region) {
  const std::vector<SourceFace>& faces = mesh.triangles().source_faces;
  std::vector<Problem> problems;
  for (size_t i = 0; i < faces.size(); ++i)
    if (faces[i].lost && MayTouch(faces[i], i, region))
      problems.push_back(
          {{},
           fmt::format(
               "toolpath: {}, and the region may hold points of it; leave it out with `region: {{none: "
               "[{{step_faces: [\"{}\"]}}]}}`, or give the part as a mesh",
               DescribeLost(mesh.triangles(), i), i + 1)});
  if (!problems.empty()) throw InputError(std::move(problems));
}

}  // namespace millpose
