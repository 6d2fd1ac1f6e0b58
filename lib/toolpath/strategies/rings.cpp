// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rings.hpp"

#include "base/parallel.hpp"
#include "geometry/slice/cylinder_slices.hpp"
#include "geometry/slice/plane_slices.hpp"
#include "toolpath/strategies/ring_spiral.hpp"
#include "toolpath/strategies/stepover.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

double AreaOf(const Region::Patch& patch) {
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  for (size_t i = 1; i + 1 < patch.corners.size(); ++i)
    twice += (patch.corners[i] - patch.corners[0]).cross(patch.corners[i + 1] - patch.corners[0]);
  return twice.norm() / 2;
}

bool OnWalls(const Region& region, const Rings& rings) {
  if (rings.surface != RingSurface::kAuto) return rings.surface == RingSurface::kWalls;
  double walls = 0, faces = 0;
  for (const Region::Patch& patch : region.Patches()) {
    const double across = std::abs(region.mesh().FaceNormal(patch.face).dot(rings.axis_direction));
    (across < std::sqrt(0.5) ? walls : faces) += AreaOf(patch);
  }
  return walls > faces;
}

RingFrame Frame(const Rings& rings, const ToolpathOptions& options, bool left_handed) {
  return {{rings.axis_point, rings.axis_direction}, options.rotation_reference, left_handed};
}

// Whether a spiral must turn left-handed about the axis to have what is not milled on the wanted side: it
// winds on to greater radii or heights, so its sense decides. (Rings are turned one by one.)
bool IsLeftHanded(const Region& region, const Rings& rings, const ToolpathOptions& options, bool walls) {
  if (rings.path != RingPath::kSpiral ||
      (options.direction != Direction::kClimb && options.direction != Direction::kConventional))
    return false;
  const RingFrame frame = Frame(rings, options, false);
  const Eigen::Vector3d& axis = rings.axis_direction;
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
  RingMaker(const Region& region, const Rings& rings, const ToolpathOptions& options, std::stop_token stop)
      : region_(region),
        rings_(rings),
        options_(options),
        stop_(std::move(stop)),
        walls_(OnWalls(region, rings)),
        frame_(Frame(rings, options, IsLeftHanded(region, rings, options, walls_))) {}

  Layout Run() {
    if (!Measure()) return std::move(layout_);
    if (rings_.path == RingPath::kSpiral && scale_->count() > 1) {
      layout_.lanes.push_back(MakeSpiral({region_, options_, frame_, walls_, *scale_,
                                          [this](double position) { return Slices({position})[0]; }},
                                         stop_));
    } else {
      double seam = rings_.start.value_or(0);
      for (auto& curves : Slices(scale_->Positions())) {
        AddRings(std::move(curves), seam);
        seam += rings_.seam_step;
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
      const double across = std::abs(region_.mesh().FaceNormal(patch.face).dot(rings_.axis_direction));
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
    CurveGroup lane;
    for (const Curve& curve : curves) {
      lane.curves.push_back(frame_.Turned(curve));
      frame_.MoveSeam(lane.curves.back(), seam);
    }
    lane.progress = [frame = frame_, seam](const Eigen::Vector3d& p) { return frame.Angle(p, seam); };
    lane.advance = [frame = frame_, walls = walls_](const Eigen::Vector3d& p) {
      return walls ? frame.Height(p) : frame.axis().Radius(p);
    };
    lane.backwards = layout_.lanes.size() % 2 == 1;
    if (rings_.path == RingPath::kOpen)
      lane.opening = rings_.start ? RingOpening::kAtStart : RingOpening::kAnywhere;
    layout_.lanes.push_back(std::move(lane));
  }

  const Region& region_;
  const Rings& rings_;
  const ToolpathOptions& options_;
  std::stop_token stop_;
  bool walls_;
  RingFrame frame_;
  std::optional<PassScale> scale_;
  Layout layout_;
};

}  // namespace

Layout Rings::Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const {
  RequireUnit(axis_direction, "the rings' axis");
  return RingMaker(region, *this, options, std::move(stop)).Run();
}

StrategyEntry RingsEntry() {
  using S = Rings;
  using namespace yaml;
  return EntryOf<S>(
      "rings", "Strategy rings: around an axis.",
      Section<S>({Key<S>("point_mm", MILLPOSE_AT(axis_point), yaml::Coordinates(),
                         "A point of the axis, in the workpiece frame.")
                      .Required(),
                  Key<S>("axis", MILLPOSE_AT(axis_direction), yaml::Direction(),
                         "Direction of the axis, in the workpiece frame.")
                      .Required(),
                  Key<S>("on", MILLPOSE_AT(surface),
                         ChoiceOf<RingSurface>({{"auto", RingSurface::kAuto},
                                                {"faces", RingSurface::kFaces},
                                                {"walls", RingSurface::kWalls}}),
                         "Rings by radius (faces across the axis) or by height (walls around it); "
                         "auto: what suits most of the region."),
                  Key<S>("path", MILLPOSE_AT(path),
                         ChoiceOf<RingPath>({{"closed", RingPath::kClosed},
                                             {"open", RingPath::kOpen},
                                             {"spiral", RingPath::kSpiral}}),
                         "A pass per ring, which ends in the pose in which it began (closed) or need not "
                         "(open: with leads, and its end runs on over its beginning); or one pass that winds "
                         "on from ring to ring."),
                  Key<S>("start_deg", MILLPOSE_AT(start), AutoOr(Real(kDeg, Between(-360, 360))),
                         "Angle about the axis at which the first ring begins, from the rotation reference "
                         "on; auto: there, and with `path: open` where that costs least."),
                  Key<S>("seam_step_deg", MILLPOSE_AT(seam_step), Real(kDeg, Between(-360, 360)),
                         "Angle by which each ring begins after the one before.")}));
}

}  // namespace millpose
