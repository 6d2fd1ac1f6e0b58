// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/region_term.hpp"

#include "base/error.hpp"
#include "surface/corner_normals.hpp"

namespace millpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<char> Facing(const Mesh& mesh, const Eigen::Vector3d& direction, double within) {
  std::vector<char> facing(mesh.face_count());
  for (int face = 0; face < mesh.face_count(); ++face)
    facing[face] = mesh.FaceNormal(face).dot(direction) >= std::cos(within) - 1e-12 ? 1 : 0;
  return facing;
}

std::vector<char> Connected(const Mesh& mesh, const ConnectedFaces& options) {
  std::vector<char> reached(mesh.face_count(), 0);
  std::vector<int> queue{mesh.Closest(options.seed).face};
  reached[queue[0]] = 1;
  for (size_t head = 0; head < queue.size(); ++head)
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.Neighbour(queue[head], k);
      if (other < 0 || reached[other] != 0 || BendAngle(mesh, queue[head], k) > options.crease) continue;
      reached[other] = 1;
      queue.push_back(other);
    }
  return reached;
}

std::vector<char> FromSource(const Mesh& mesh, const std::vector<std::string>& wanted) {
  const Triangles& triangles = mesh.triangles();
  if (triangles.source_faces.empty())
    throw InputError({}, "toolpath: a region names step_faces, and the part comes from no STEP file");
  std::vector<char> chosen(triangles.source_faces.size(), 0);
  std::vector<std::string> known;
  for (const SourceFace& face : triangles.source_faces) {
    known.push_back(face.id);
    if (!face.name.empty()) known.push_back(face.name);
  }
  std::vector<Problem> problems;
  for (const std::string& name : wanted) {
    bool found = false;
    for (size_t i = 0; i < chosen.size(); ++i)
      if (const SourceFace& face = triangles.source_faces[i];
          name == std::to_string(i + 1) || name == face.id || name == face.name)
        chosen[i] = found = true;
    if (!found)
      problems.push_back(
          {{},
           fmt::format("toolpath: the part has no STEP face \"{}\"; there are 1 to {}, nearest known: {}",
                       name, chosen.size(), NearestName(name, known))});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  std::vector<char> in(mesh.face_count());
  for (int face = 0; face < mesh.face_count(); ++face) in[face] = chosen[triangles.source[face]];
  return in;
}

double Area(const std::vector<Eigen::Vector2d>& corners) {
  double twice = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

}  // namespace

RegionTerm::RegionTerm(const Mesh& mesh, const RegionOptions& options, bool outermost) : options_(options) {
  if (options.facing) facing_ = Facing(mesh, *options.facing, options.facing_within);
  if (options.connected) connected_ = Connected(mesh, *options.connected);
  if (!options.source_faces.empty()) source_ = FromSource(mesh, options.source_faces);
  if (options.polygon) {
    u_ = options.polygon->direction.unitOrthogonal();
    v_ = options.polygon->direction.cross(u_);
    for (const Eigen::Vector3d& p : options.polygon->points) corners_.emplace_back(u_.dot(p), v_.dot(p));
    if (corners_.size() < 3 || !(Area(corners_) > 0))
      throw InputError({}, "toolpath: a region's polygon has no area seen along its direction");
  }
  for (const RegionOptions& child : options.all) all_.emplace_back(mesh, child);
  for (const RegionOptions& child : options.any) any_.emplace_back(mesh, child);
  for (const RegionOptions& child : options.none) none_.emplace_back(mesh, child);
  if (options.rim_distance > 0 && !outermost)
    borders_ = RegionBorders(mesh, [&](int face) { return Bound(face, true) >= 0; });
}

double RegionTerm::FaceMargin(int face) const {
  const bool in = (facing_.empty() || facing_[face] != 0) && (connected_.empty() || connected_[face] != 0) &&
                  (source_.empty() || source_[face] != 0);
  return in ? kInfinity : -kInfinity;
}

// Distance to the outline, positive inside (even-odd rule).
double RegionTerm::PolygonMargin(const Eigen::Vector3d& p) const {
  const Eigen::Vector2d q(u_.dot(p), v_.dot(p));
  double squared = kInfinity;
  bool inside = false;
  for (size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d &a = corners_[i], ab = corners_[(i + 1) % corners_.size()] - a, aq = q - a;
    const double t = std::clamp(aq.dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    if (ab.squaredNorm() > 0) squared = std::min(squared, (aq - t * ab).squaredNorm());
    const double by = a.y() + ab.y();
    if ((a.y() > q.y()) != (by > q.y()) && aq.x() < ab.x() * aq.y() / ab.y()) inside = !inside;
  }
  return inside ? std::sqrt(squared) : -std::sqrt(squared);
}

double RegionTerm::PointMargin(const Eigen::Vector3d& p) const {
  double margin = kInfinity;
  if (options_.box) {
    const auto& [lower, upper] = *options_.box;
    margin = std::min((p - lower).minCoeff(), (upper - p).minCoeff());
  }
  if (options_.half_space)
    margin = std::min(margin, options_.half_space->normal.dot(p - options_.half_space->point));
  if (options_.polygon) margin = std::min(margin, PolygonMargin(p));
  if (!borders_.empty()) margin = std::min(margin, borders_.Distance(p) - options_.rim_distance);
  return margin;
}

double RegionTerm::Margin(int face, const Eigen::Vector3d& p) const {
  double margin = std::min(FaceMargin(face), PointMargin(p));
  for (const RegionTerm& term : all_) margin = std::min(margin, term.Margin(face, p));
  for (const RegionTerm& term : none_) margin = std::min(margin, -term.Margin(face, p));
  double best = any_.empty() ? kInfinity : -kInfinity;
  for (const RegionTerm& term : any_) best = std::max(best, term.Margin(face, p));
  return std::min(margin, best);
}

double RegionTerm::Bound(int face, bool upper) const {
  double margin = FaceMargin(face);
  if (!upper && HasPointConditions()) margin = -kInfinity;
  for (const RegionTerm& term : all_) margin = std::min(margin, term.Bound(face, upper));
  for (const RegionTerm& term : none_) margin = std::min(margin, -term.Bound(face, !upper));
  double best = any_.empty() ? kInfinity : -kInfinity;
  for (const RegionTerm& term : any_) best = std::max(best, term.Bound(face, upper));
  return std::min(margin, best);
}

}  // namespace millpose
