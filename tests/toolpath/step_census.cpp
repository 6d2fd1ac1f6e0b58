// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/toolpath/step_census.hpp"

#include "base/units.hpp"

namespace millpose {
namespace {

double Degrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

class Taker {
 public:
  Taker(const Pass& pass, const Mesh* mesh, StepCensus& census)
      : points_(pass.points), mesh_(mesh), census_(census) {
    count_ = points_.size() - (pass.closed ? 0 : 1);
    closed_ = pass.closed;
  }

  void Take() {
    for (size_t i = 0; i < count_; ++i) {
      const double step = Way(i).norm();
      const double turn = Degrees(points_[i].tool_axis, To(i).tool_axis) / std::max(step, 1e-9);
      ++census_.steps[step < 0.01 ? 0 : step < 0.05 ? 1 : step < 0.5 ? 2 : step < 5 ? 3 : 4];
      ++census_.turns[turn < 0.1 ? 0 : turn < 0.5 ? 1 : turn < 2 ? 2 : 3];
      if (step < 0.05 && !IsCorner(i) && !IsCorner(i + 1)) Tell(i, fmt::format("a step of {:.4f} mm", step));
      if (turn > 2 && !SurfaceTurns(i)) Tell(i, fmt::format("the axis turns by {:.2f}°/mm", turn));
    }
  }

 private:
  const MillingPoint& To(size_t i) const { return points_[(i + 1) % points_.size()]; }
  Eigen::Vector3d Way(size_t i) const { return To(i).position - points_[i].position; }

  // Where the step i begins.
  bool IsCorner(size_t i) const {
    if (!closed_ && (i == 0 || i >= count_)) return false;
    return Degrees(Way((i + count_ - 1) % count_), Way(i % count_)) >= 10;
  }

  // Whether facets within a mm of the step turn by as much.
  bool SurfaceTurns(size_t i) const {
    if (mesh_ == nullptr) return false;
    const Eigen::Vector3d middle = (points_[i].position + To(i).position) / 2;
    double most = 0;
    for (const int face : mesh_->FacesNear(middle, 1 + Way(i).norm() / 2))
      most = std::max(most, Degrees(mesh_->FaceNormal(face), points_[i].tool_axis));
    return most >= Degrees(points_[i].tool_axis, To(i).tool_axis) / 2;
  }

  void Tell(size_t i, const std::string& what) {
    const Eigen::Vector3d& p = points_[i].position;
    census_.uneven.push_back(fmt::format("{} at ({:.3f}, {:.3f}, {:.3f}), point {} of {}, kind {}", what,
                                         p.x(), p.y(), p.z(), i, points_.size(),
                                         static_cast<int>(points_[i].kind)));
  }

  const std::vector<MillingPoint>& points_;
  const Mesh* mesh_;
  StepCensus& census_;
  size_t count_ = 0;
  bool closed_ = false;
};

}  // namespace

StepCensus CensusOf(const Toolpath& toolpath, const Mesh* mesh) {
  StepCensus census;
  for (const Pass& pass : toolpath.passes)
    if (!pass.points.empty()) Taker(pass, mesh, census).Take();
  return census;
}

std::string ToText(const StepCensus& census) {
  return fmt::format(
      "steps below 0.01, 0.05, 0.5, 5 mm and longer: {}; turns below 0.1, 0.5, 2°/mm and more: {}",
      fmt::join(census.steps, " "), fmt::join(census.turns, " "));
}

}  // namespace millpose
