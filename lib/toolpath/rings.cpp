// SPDX-License-Identifier: GPL-3.0-or-later
// Rings and spirals around an axis, on faces across it (by radius) and on walls around it (by height).
#include "base/parallel.hpp"
#include "surface/cylinder_slices.hpp"
#include "surface/plane_slices.hpp"
#include "toolpath/ring_spiral.hpp"
#include "toolpath/stepover.hpp"

namespace millpose {
namespace {

double AreaOf(const Region::Patch& patch) {
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  for (size_t i = 1; i + 1 < patch.corners.size(); ++i)
    twice += (patch.corners[i] - patch.corners[0]).cross(patch.corners[i + 1] - patch.corners[0]);
  return twice.norm() / 2;
}

bool OnWalls(const Region& region, const ToolpathOptions& options) {
  if (options.ring_surface != RingSurface::kAuto) return options.ring_surface == RingSurface::kWalls;
  double walls = 0, faces = 0;
  for (const Region::Patch& patch : region.Patches()) {
    const double across = std::abs(region.mesh().FaceNormal(patch.face).dot(options.axis_direction));
    (across < std::sqrt(0.5) ? walls : faces) += AreaOf(patch);
  }
  return walls > faces;
}

// Whether a spiral must turn left-handed about the axis to have what is not milled on the wanted side: it
// winds on to greater radii or heights, so its sense decides. (Rings are turned one by one.)
bool IsLeftHanded(const Region& region, const ToolpathOptions& options, bool walls) {
  if (!options.spiral ||
      (options.direction != Direction::kClimb && options.direction != Direction::kConventional))
    return false;
  const RingFrame frame(options, false);
  const Eigen::Vector3d& axis = options.axis_direction;
  double right = 0;  // of a right-handed turn lies what comes next
  for (const Region::Patch& patch : region.Patches()) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : patch.corners) centre += p / static_cast<double>(patch.corners.size());
    const Eigen::Vector3d radial = frame.Radial(centre).normalized();
    const Eigen::Vector3d side = axis.cross(radial).cross(region.mesh().FaceNormal(patch.face));
    right += AreaOf(patch) * side.dot(walls ? axis : radial);
  }
  return (right > 0) != (options.direction == Direction::kClimb);
}

class RingMaker {
 public:
  RingMaker(const Region& region, const ToolpathOptions& options, std::stop_token stop)
      : region_(region),
        options_(options),
        stop_(std::move(stop)),
        walls_(OnWalls(region, options)),
        frame_(options, IsLeftHanded(region, options, walls_)) {}

  Layout Run() {
    if (!Measure()) return std::move(layout_);
    if (options_.spiral && scale_->count() > 1) {
      layout_.lanes.push_back(MakeSpiral({region_, options_, frame_, walls_, *scale_,
                                          [this](double position) { return Slices({position})[0]; }},
                                         stop_));
    } else {
      double seam = 0;
      for (auto& curves : Slices(scale_->Positions())) {
        AddRings(std::move(curves), seam);
        seam += options_.seam_step;
      }
    }
    return std::move(layout_);
  }

 private:
  double Position(const Eigen::Vector3d& p) const {
    return walls_ ? frame_.Height(p) : frame_.axis().Radius(p);
  }

  bool Measure() {
    StepoverRule rule(region_.mesh(), options_);
    std::vector<Stretch> stretches;
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    double rising = 0;  // area times the position's rise on it
    for (const Region::Patch& patch : region_.Patches()) {
      Stretch stretch{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0};
      for (const Eigen::Vector3d& p : patch.corners) {
        stretch.lower = std::min(stretch.lower, Position(p));
        stretch.upper = std::max(stretch.upper, Position(p));
        const Eigen::Vector3d radial = frame_.Radial(p);
        if (!walls_ && radial.norm() == 0) continue;
        const Eigen::Vector3d gradient = walls_ ? frame_.axis().direction : radial.normalized();
        stretch.density = std::max(stretch.density, rule.Density(patch.face, gradient));
      }
      if (!walls_) stretch.lower = frame_.LeastRadius(patch.corners);
      stretches.push_back(stretch);
      const double across = std::abs(region_.mesh().FaceNormal(patch.face).dot(options_.axis_direction));
      rising +=
          AreaInside(region_, patch) * (walls_ ? std::sqrt(std::max(0.0, 1 - across * across)) : across);
      lower = std::min(lower, stretch.lower);
      upper = std::max(upper, stretch.upper);
    }
    if (lower > upper) return false;
    rule.AddNotes(layout_.notes);
    const double rim = options_.region.rim_distance;
    if (upper - lower > 2 * rim) {
      lower += walls_ || lower > 0 ? rim : 0;
      upper -= rim;
    }
    scale_.emplace(stretches, lower, upper);
    CheckBudget(options_,
                {scale_->wanted(), upper > lower ? rising * scale_->wanted() / (upper - lower) : 0});
    return true;
  }

  std::vector<std::vector<Curve>> Slices(const std::vector<double>& positions) const {
    if (!walls_) return SliceByCylinders(region_.mesh(), frame_.axis(), positions, stop_);
    std::vector<double> offsets;
    for (const double height : positions)
      offsets.push_back(frame_.axis().direction.dot(frame_.axis().point) + height);
    return SliceByPlanes(region_.mesh(), frame_.axis().direction, offsets, stop_);
  }

  void AddRings(std::vector<Curve> curves, double seam) {
    Lane lane;
    for (const Curve& curve : curves) {
      lane.curves.push_back(frame_.Turned(curve));
      frame_.MoveSeam(lane.curves.back(), seam);
    }
    lane.progress = [frame = frame_, seam](const Eigen::Vector3d& p) { return frame.Angle(p, seam); };
    lane.advance = [frame = frame_, walls = walls_](const Eigen::Vector3d& p) {
      return walls ? frame.Height(p) : frame.axis().Radius(p);
    };
    lane.backwards = layout_.lanes.size() % 2 == 1;
    layout_.lanes.push_back(std::move(lane));
  }

  const Region& region_;
  const ToolpathOptions& options_;
  std::stop_token stop_;
  bool walls_;
  RingFrame frame_;
  std::optional<PassScale> scale_;
  Layout layout_;
};

class Rings : public Strategy {
 public:
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override {
    return RingMaker(region, options, std::move(stop)).Run();
  }
};

}  // namespace

std::unique_ptr<Strategy> MakeRings() { return std::make_unique<Rings>(); }

}  // namespace millpose
