// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/region.hpp"

#include "toolpath/region_term.hpp"

namespace millpose {
namespace {

// Sutherland and Hodgman 1974: the part of a polygon with normal · p ≥ offset.
std::vector<Eigen::Vector3d> Clipped(const std::vector<Eigen::Vector3d>& polygon,
                                     const Eigen::Vector3d& normal, double offset) {
  std::vector<Eigen::Vector3d> clipped;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = normal.dot(a) - offset, db = normal.dot(b) - offset;
    if (da >= 0) clipped.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) clipped.push_back(a + da / (da - db) * (b - a));
  }
  return clipped;
}

}  // namespace

Region::Region(const Mesh& mesh, const RegionOptions& options)
    : mesh_(mesh),
      options_(options),
      term_(std::make_shared<const RegionTerm>(mesh, options, true)),
      has_face_(mesh.face_count()) {
  for (int face = 0; face < mesh.face_count(); ++face)
    has_face_[face] = term_->Bound(face, true) >= 0 ? 1 : 0;
  borders_ = RegionBorders(mesh, [&](int face) { return HasFace(face); });
}

double Region::Margin(int face, const Eigen::Vector3d& p) const {
  const double margin = term_->Margin(face, p);
  return options_.rim_distance > 0 ? std::min(margin, BorderDistance(p) - options_.rim_distance) : margin;
}

std::vector<Region::Patch> Region::Patches() const {
  std::vector<Patch> patches;
  for (int face = 0; face < mesh_.face_count(); ++face) {
    if (!HasFace(face)) continue;
    std::vector<Eigen::Vector3d> polygon{mesh_.Corner(face, 0), mesh_.Corner(face, 1), mesh_.Corner(face, 2)};
    for (int axis = 0; options_.box && axis < 3; ++axis) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
      polygon = Clipped(polygon, unit, options_.box->lower[axis]);
      polygon = Clipped(polygon, -unit, -options_.box->upper[axis]);
    }
    if (options_.half_space)
      polygon = Clipped(polygon, options_.half_space->normal,
                        options_.half_space->normal.dot(options_.half_space->point));
    if (polygon.size() >= 3) patches.push_back({face, std::move(polygon)});
  }
  return patches;
}

Eigen::Vector3d Region::MeanNormal() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0;
  for (int face = 0; face < mesh_.face_count(); ++face) {
    if (!HasFace(face)) continue;
    const Eigen::Vector3d a = mesh_.Corner(face, 0);
    const Eigen::Vector3d twice = (mesh_.Corner(face, 1) - a).cross(mesh_.Corner(face, 2) - a);
    sum += twice;
    area += twice.norm();
  }
  return sum.norm() > 1e-6 * area ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::Zero();
}

}  // namespace millpose
