// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/region_term.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "geometry/mesh/corner_normals.hpp"
#include "geometry/mesh/triangle.hpp"

namespace millpose {
namespace {

std::vector<char> Facing(const Mesh& mesh, const Eigen::Vector3d& direction, double within) {
  std::vector<char> facing(mesh.face_count());
  const double least = SinCos(within).cos - 1e-12;
  for (int face = 0; face < mesh.face_count(); ++face)
    facing[face] = mesh.FaceNormal(face).dot(direction) >= least ? 1 : 0;
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

/// The one face on which a place lies; −1 with what is wrong in `problem`.
int FaceAt(const Mesh& mesh, const Eigen::Vector3d& place, const std::string& name, std::string& problem) {
  const Triangles& triangles = mesh.triangles();
  std::vector<double> away(triangles.source_faces.size(), kInfinity);
  for (int face = 0; face < mesh.face_count(); ++face) {
    double& least = away[static_cast<size_t>(triangles.source[face])];
    least = std::min(least, (mesh.ClosestOnFace(place, face).position - place).norm());
  }
  const auto nearest = std::ranges::min_element(away);
  const auto first = static_cast<int>(nearest - away.begin());
  const double distance = *nearest;
  *nearest = kInfinity;
  const auto other = std::ranges::min_element(away);
  if (distance > kNearFace)
    problem = fmt::format(
        "toolpath: step_faces \"{}\": the nearest face, {}, is {:.3g} mm away; allowed: at most {} mm "
        "(places in the workpiece frame)",
        name, first + 1, distance, kNearFace);
  else if (*other <= kNearFace && *other < distance + 0.5)
    problem = fmt::format(
        "toolpath: step_faces \"{}\" is at the edge of faces {} and {}; allowed: a place on one of them, "
        "0.5 mm nearer to it",
        name, first + 1, other - away.begin() + 1);
  return problem.empty() ? first : -1;
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
    if (const auto place = NearPlace(name); place && !found) {
      std::string problem;
      const int at = FaceAt(mesh, *place, name, problem);
      if (at >= 0)
        chosen[static_cast<size_t>(at)] = 1;
      else
        problems.push_back({{}, problem});
    } else if (!found)
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

// The way on a face with the given normal to a plane that lies `distance` away in the direction of `limit`.
double OnFace(double distance, const Eigen::Vector3d& limit, const Eigen::Vector3d& face_normal) {
  constexpr double kParallel = 1e-6;  // sine
  constexpr double kFar = 1e9;        // mm
  const double sine = limit.cross(face_normal).norm();
  if (sine > kParallel) return distance / sine;
  return distance >= -1e-9 ? kFar : -kFar;
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

std::optional<Eigen::Vector3d> NearPlace(const std::string& name) {
  constexpr std::string_view kNear = "near ";
  if (!name.starts_with(kNear)) return std::nullopt;
  std::vector<double> numbers;
  for (std::string_view rest = std::string_view(name).substr(kNear.size()); !rest.empty();) {
    const size_t begin = rest.find_first_not_of(" ,"), end = rest.find_first_of(" ,", begin);
    if (begin == std::string_view::npos) break;
    const std::optional<double> number = ParseNumber(rest.substr(begin, end - begin));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end);
  }
  if (numbers.size() != 3) return std::nullopt;
  return Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
}

RegionTerm::RegionTerm(const Mesh& mesh, const RegionOptions& options, bool outermost)
    : mesh_(mesh), options_(options) {
  if (options.facing) facing_ = Facing(mesh, *options.facing, options.facing_within);
  if (options.connected) connected_ = Connected(mesh, *options.connected);
  if (!options.source_faces.empty()) source_ = FromSource(mesh, options.source_faces);
  if (options.polygon) {
    u_ = options.polygon->direction.unitOrthogonal();
    v_ = options.polygon->direction.cross(u_);
    std::vector<Eigen::Vector2d> corners;
    for (const Eigen::Vector3d& p : options.polygon->points) corners.emplace_back(u_.dot(p), v_.dot(p));
    if (corners.size() < 3 || !(Area(corners) > 0))
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

// Distance to the outline as it lies on the face's plane, positive inside (even-odd rule across the polygon's
// direction). On a face along that direction the distance counts across it.
double RegionTerm::PolygonMargin(const Eigen::Vector3d& p, const Eigen::Vector3d& face_normal) const {
  const ProjectedPolygon& polygon = *options_.polygon;
  const double slope = face_normal.dot(polygon.direction);
  const auto projected = [&](const Eigen::Vector3d& corner) -> Eigen::Vector3d {
    const double way =
        std::abs(slope) > 1e-6 ? face_normal.dot(p - corner) / slope : polygon.direction.dot(p - corner);
    return corner + way * polygon.direction - p;
  };
  double squared = kInfinity;
  bool inside = false;
  for (size_t i = 0; i < polygon.points.size(); ++i) {
    const Eigen::Vector3d a = projected(polygon.points[i]);
    const Eigen::Vector3d b = projected(polygon.points[(i + 1) % polygon.points.size()]);
    const double t = (b - a).squaredNorm() > 0 ? ClosestOnSegment(Eigen::Vector3d::Zero(), a, b) : 0.0;
    squared = std::min(squared, (a + t * (b - a)).squaredNorm());
    const double ax = u_.dot(a), ay = v_.dot(a), bx = u_.dot(b), by = v_.dot(b);
    if ((ay > 0) != (by > 0) && ax - ay * (bx - ax) / (by - ay) > 0) inside = !inside;
  }
  return inside ? std::sqrt(squared) : -std::sqrt(squared);
}

double RegionTerm::PointMargin(int face, const Eigen::Vector3d& p) const {
  const Eigen::Vector3d& normal = mesh_.FaceNormal(face);
  double margin = kInfinity;
  if (options_.box)
    for (int axis = 0; axis < 3; ++axis) {
      const auto& [lower, upper] = *options_.box;
      const double inside = std::min(p[axis] - lower[axis], upper[axis] - p[axis]);
      margin = std::min(margin, OnFace(inside, Eigen::Vector3d::Unit(axis), normal));
    }
  if (const auto& half = options_.half_space)
    margin = std::min(margin, OnFace(half->normal.dot(p - half->point), half->normal, normal));
  if (options_.polygon) margin = std::min(margin, PolygonMargin(p, normal));
  if (!borders_.empty()) margin = std::min(margin, borders_.Distance(p) - options_.rim_distance);
  return margin;
}

double RegionTerm::Margin(int face, const Eigen::Vector3d& p) const {
  double margin = std::min(FaceMargin(face), PointMargin(face, p));
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
