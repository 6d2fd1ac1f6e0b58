// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/stepover.hpp"

#include "base/decompositions.hpp"
#include "base/trig.hpp"

namespace millpose {
namespace {

constexpr double kMaxSlope = 20;         // a surface within 2.9° of the passes has no useful step-over
constexpr double kCurvatureStep = 1e-5;  // 1/mm

}  // namespace

double Curvature(const Mesh& mesh, const CornerNormals& normals, int face, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d u = (mesh.Corner(face, 1) - mesh.Corner(face, 0)).normalized();
  const Eigen::Vector3d v = mesh.FaceNormal(face).cross(u);
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Eigen::Vector3d e = mesh.Corner(face, next) - mesh.Corner(face, k);
    const Eigen::Vector3d d = normals.OfFace(face)[next] - normals.OfFace(face)[k];
    const double x = e.dot(u), y = e.dot(v);
    for (const auto& [row, value] :
         {std::pair(Eigen::Vector3d(x, y, 0), d.dot(u)), std::pair(Eigen::Vector3d(0, x, y), d.dot(v))}) {
      A += row * row.transpose();
      b += value * row;
    }
  }
  const Eigen::Vector3d form = SolveSymmetric3(A, b);
  const double x = direction.dot(u), y = direction.dot(v);
  return form[0] * x * x + 2 * form[1] * x * y + form[2] * y * y;
}

StepoverRule::StepoverRule(const Mesh& mesh, const ToolpathOptions& options)
    : mesh_(mesh),
      options_(options),
      scallops_(options.cutter, options.lead, options.tilt, options.direction == Direction::kZigzag) {
  if (options.scallop > 0) normals_.emplace(mesh, options.crease, options.normal_smoothing);
}

double StepoverRule::Wanted(int face, const Eigen::Vector3d& across) {
  if (!normals_) return options_.stepover;
  // Rounded towards the smaller step-over.
  const long step = static_cast<long>(std::ceil(Curvature(mesh_, *normals_, face, across) / kCurvatureStep));
  const auto [entry, added] = known_.try_emplace(step, 0.0);
  if (added)
    entry->second = std::min(options_.stepover, scallops_.Stepover(options_.scallop, kCurvatureStep * step));
  return entry->second;
}

double StepoverRule::Density(int face, const Eigen::Vector3d& gradient) {
  if (!options_.stepover_on_surface && !normals_) return 1 / options_.stepover;
  const Eigen::Vector3d& n = mesh_.FaceNormal(face);
  const Eigen::Vector3d across = gradient - gradient.dot(n) * n;
  const double rise = across.norm();  // of the position, per mm on the face
  if (rise < 1 / kMaxSlope) {
    const Eigen::Vector3d a = mesh_.Corner(face, 0);
    steep_[face] = (mesh_.Corner(face, 1) - a).cross(mesh_.Corner(face, 2) - a).norm() / 2;
  }
  const Eigen::Vector3d direction = rise > 1e-9 ? Eigen::Vector3d(across / rise) : n.unitOrthogonal();
  return std::min(kMaxSlope, 1 / std::max(rise, 1e-9)) / Wanted(face, direction);
}

void StepoverRule::AddNotes(std::vector<std::string>& notes) const {
  double area = 0;
  for (const auto& [face, own] : steep_) area += own;
  if (area > 0)
    notes.push_back(fmt::format(
        "{:.1f} mm² of the region lie within {:.1f}° of the planes (cylinders) of the passes, where the "
        "step-over on the surface exceeds the wanted one; turn the passes or narrow the region",
        area, RadToDeg(Asin(1 / kMaxSlope))));
}

}  // namespace millpose
