// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/decompositions.hpp"
#include "machine/collision/fcl_part.hpp"

namespace millpose {
namespace {

bool Positive(double value) { return std::isfinite(value) && value > 0; }

std::string PointsProblem(const std::vector<Eigen::Vector3d>& points) {
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) return fmt::format("point {} is not finite", i + 1);
  }
  return {};
}

/// Whether the points span a volume: the least extent of their scatter is not negligible.
bool SpansVolume(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d extent = EigenOfSymmetric3(scatter).values;
  return extent[0] > 1e-12 * extent[2];
}

struct ProblemOf {
  std::string operator()(const Box& box) const {
    if (box.size.array().isFinite().all() && box.size.minCoeff() > 0) return {};
    return fmt::format("box of {} × {} × {} mm: all three sizes must be positive", box.size.x(), box.size.y(),
                       box.size.z());
  }
  std::string operator()(const Sphere& sphere) const {
    if (Positive(sphere.radius)) return {};
    return fmt::format("sphere of radius {} mm: must be positive", sphere.radius);
  }
  std::string operator()(const Cylinder& c) const {
    if (Positive(c.radius) && Positive(c.length)) return {};
    return fmt::format("cylinder of radius {} mm and length {} mm: both must be positive", c.radius,
                       c.length);
  }
  std::string operator()(const Capsule& c) const {
    if (Positive(c.radius) && Positive(c.length)) return {};
    return fmt::format("capsule of radius {} mm and length {} mm: both must be positive", c.radius, c.length);
  }
  std::string operator()(const Cone& c) const {
    const bool radii = std::isfinite(c.radius_bottom) && std::isfinite(c.radius_top) &&
                       c.radius_bottom >= 0 && c.radius_top >= 0 && c.radius_bottom + c.radius_top > 0;
    if (radii && Positive(c.length)) return {};
    return fmt::format(
        "cone of radii {} mm and {} mm and length {} mm: the length and one radius must be positive",
        c.radius_bottom, c.radius_top, c.length);
  }
  std::string operator()(const Convex& convex) const {
    if (std::string problem = PointsProblem(convex.points); !problem.empty()) return problem;
    if (convex.points.size() >= 4 && SpansVolume(convex.points)) return {};
    return fmt::format("convex shape of {} points: at least four that span a volume are needed",
                       convex.points.size());
  }
  std::string operator()(const Triangles& mesh) const {
    if (mesh.faces.empty()) return "mesh without triangles";
    if (std::string problem = PointsProblem(mesh.vertices); !problem.empty()) return problem;
    for (size_t i = 0; i < mesh.faces.size(); ++i) {
      for (int v : mesh.faces[i]) {
        if (v < 0 || v >= static_cast<int>(mesh.vertices.size())) {
          return fmt::format("triangle {} names vertex {} of {}", i + 1, v, mesh.vertices.size());
        }
      }
    }
    return {};
  }
};

}  // namespace

std::string ShapeProblem(const Shape& shape) { return std::visit(ProblemOf{}, shape); }

}  // namespace millpose
