// SPDX-License-Identifier: GPL-3.0-or-later
// Rings and spirals around an axis, on faces across it (by radius) and on walls around it (by height).
#include "base/parallel.hpp"
#include "surface/cylinder_slices.hpp"
#include "surface/plane_slices.hpp"
#include "surface/triangle.hpp"
#include "toolpath/level_lines.hpp"
#include "toolpath/spread.hpp"
#include "toolpath/stepover.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

// The axis with the directions from which angles about it count.
struct Frame {
  Axis axis;
  Eigen::Vector3d zero, quarter;

  /// Rings begin in the direction of the rotation reference, seen along the axis.
  explicit Frame(const ToolpathOptions& options) : axis{options.axis_point, options.axis_direction} {
    const Eigen::Vector3d& d = axis.direction;
    const Eigen::Vector3d flat = options.rotation_reference - options.rotation_reference.dot(d) * d;
    zero = flat.norm() > 1e-6 ? Eigen::Vector3d(flat.normalized()) : d.unitOrthogonal();
    quarter = d.cross(zero);
  }

  Eigen::Vector3d Radial(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = p - axis.point;
    return d - d.dot(axis.direction) * axis.direction;
  }
  double Height(const Eigen::Vector3d& p) const { return (p - axis.point).dot(axis.direction); }
  /// 0..2π, from `seam` on.
  double Angle(const Eigen::Vector3d& p, double seam) const {
    const Eigen::Vector3d d = p - axis.point;
    const double angle = std::atan2(d.dot(quarter), d.dot(zero)) - seam;
    return angle - 2 * kPi * std::floor(angle / (2 * kPi));
  }
};

// Smallest distance of a convex polygon's points from the axis: 0 where the axis passes through it, else on a
// side.
double LeastRadius(const std::vector<Eigen::Vector3d>& polygon, const Frame& frame) {
  double least = std::numeric_limits<double>::infinity();
  bool left = true, right = true;  // the axis lies on one side of all sides
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d a = frame.Radial(polygon[i]), b = frame.Radial(polygon[(i + 1) % polygon.size()]);
    const double t = ClosestOnSegment(Eigen::Vector3d::Zero(), a, b);
    least = std::min(least, (a + t * (b - a)).norm());
    const double side = frame.axis.direction.dot(a.cross(b));
    left = left && side > 0;
    right = right && side < 0;
  }
  return left || right ? 0.0 : least;
}

bool OnWalls(const Region& region, const ToolpathOptions& options) {
  if (options.ring_surface != RingSurface::kAuto) return options.ring_surface == RingSurface::kWalls;
  double walls = 0, faces = 0;
  for (const Region::Patch& patch : region.Patches()) {
    Eigen::Vector3d twice = Eigen::Vector3d::Zero();
    for (size_t i = 1; i + 1 < patch.corners.size(); ++i)
      twice += (patch.corners[i] - patch.corners[0]).cross(patch.corners[i + 1] - patch.corners[0]);
    const double across = std::abs(region.mesh().FaceNormal(patch.face).dot(options.axis_direction));
    (across < std::sqrt(0.5) ? walls : faces) += twice.norm();
  }
  return walls > faces;
}

class RingMaker {
 public:
  RingMaker(const Region& region, const ToolpathOptions& options, std::stop_token stop)
      : region_(region),
        options_(options),
        stop_(std::move(stop)),
        frame_(options),
        walls_(OnWalls(region, options)) {}

  Layout Run() {
    if (!Measure()) return std::move(layout_);
    if (options_.spiral && scale_->count() > 1) {
      AddSpiral();
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
    return walls_ ? frame_.Height(p) : frame_.axis.Radius(p);
  }

  bool Measure() {
    StepoverRule rule(region_.mesh(), options_);
    std::vector<Stretch> stretches;
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const Region::Patch& patch : region_.Patches()) {
      Stretch stretch{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0};
      for (const Eigen::Vector3d& p : patch.corners) {
        stretch.lower = std::min(stretch.lower, Position(p));
        stretch.upper = std::max(stretch.upper, Position(p));
        const Eigen::Vector3d radial = frame_.Radial(p);
        if (!walls_ && radial.norm() == 0) continue;
        const Eigen::Vector3d gradient = walls_ ? frame_.axis.direction : radial.normalized();
        stretch.density = std::max(stretch.density, rule.Density(patch.face, gradient));
      }
      if (!walls_) stretch.lower = LeastRadius(patch.corners, frame_);
      stretches.push_back(stretch);
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
    return true;
  }

  std::vector<std::vector<Curve>> Slices(const std::vector<double>& positions) const {
    if (!walls_) return SliceByCylinders(region_.mesh(), frame_.axis, positions, stop_);
    std::vector<double> offsets;
    for (const double height : positions)
      offsets.push_back(frame_.axis.direction.dot(frame_.axis.point) + height);
    return SliceByPlanes(region_.mesh(), frame_.axis.direction, offsets, stop_);
  }

  // Counter-clockwise about the axis, whatever side the surface looks to.
  Curve Turned(Curve curve) const {
    double turning = 0;
    for (const CurvePiece& piece : curve.pieces)
      turning += frame_.axis.direction.dot(frame_.Radial(piece.start).cross(piece.end - piece.start));
    return turning < 0 ? Reversed(curve) : curve;
  }

  // Parameter at which a piece passes the half-plane of the seam, counter-clockwise.
  std::optional<double> SeamOn(const CurvePiece& piece, double seam) const {
    const Eigen::Vector3d out = std::cos(seam) * frame_.zero + std::sin(seam) * frame_.quarter;
    const Eigen::Vector3d side = frame_.axis.direction.cross(out);
    const auto beyond = [&](double t) { return side.dot(piece.At(t) - frame_.axis.point) >= 0; };
    if (beyond(0) || !beyond(1) || out.dot(piece.start - frame_.axis.point) <= 0) return std::nullopt;
    double low = 0, high = 1;
    for (int i = 0; i < 50; ++i) {
      const double middle = (low + high) / 2;
      (beyond(middle) ? high : low) = middle;
    }
    return high;
  }

  // Turns a closed curve so that it begins at the seam.
  void MoveSeam(Curve& curve, double seam) const {
    for (size_t i = 0; curve.closed && i < curve.pieces.size(); ++i) {
      const std::optional<double> at = SeamOn(curve.pieces[i], seam);
      if (!at) continue;
      std::rotate(curve.pieces.begin(), curve.pieces.begin() + static_cast<std::ptrdiff_t>(i),
                  curve.pieces.end());
      const CurvePiece whole = curve.pieces.front();
      if (*at > 1 - 1e-9) {
        std::rotate(curve.pieces.begin(), curve.pieces.begin() + 1, curve.pieces.end());
      } else {
        curve.pieces.front() = whole.Part(*at, 1);
        curve.pieces.push_back(whole.Part(0, *at));
      }
      return;
    }
  }

  void AddRings(std::vector<Curve> curves, double seam) {
    Lane lane;
    for (const Curve& curve : curves) {
      lane.curves.push_back(Turned(curve));
      MoveSeam(lane.curves.back(), seam);
    }
    lane.progress = [frame = frame_, seam](const Eigen::Vector3d& p) { return frame.Angle(p, seam); };
    lane.advance = [frame = frame_, walls = walls_](const Eigen::Vector3d& p) {
      return walls ? frame.Height(p) : frame.axis.Radius(p);
    };
    lane.backwards = layout_.lanes.size() % 2 == 1;
    layout_.lanes.push_back(std::move(lane));
  }

  // A ring, the turns, a ring: without the rings the first and last turn would leave a crescent.
  void AddSpiral() {
    const int count = scale_->count();
    std::vector<Curve> parts;
    const auto add_ring = [&](double passes) {
      const auto slices = Slices({scale_->PositionAt(passes)});
      for (const Curve& slice : slices[0]) {
        Curve curve = Turned(slice);
        MoveSeam(curve, 0);
        curve.closed = false;
        parts.push_back(std::move(curve));
      }
    };
    add_ring(0.5);
    for (Curve& curve : Turns(count)) parts.push_back(std::move(curve));
    add_ring(count - 0.5);
    Lane lane;
    lane.curves = Joined(std::move(parts));
    // By turns; of the rings, which are one turn each, by the angle.
    lane.progress = [scale = *scale_, frame = frame_, walls = walls_](const Eigen::Vector3d& p) {
      const double position = walls ? frame.Height(p) : frame.axis.Radius(p);
      return scale.PassesAt(position) + 1e-3 * frame.Angle(p, 0);
    };
    lane.advance = [frame = frame_, walls = walls_](const Eigen::Vector3d& p) {
      return walls ? frame.Height(p) : frame.axis.Radius(p);
    };
    layout_.lanes.push_back(std::move(lane));
  }

  // The lines passes = ½ + turns + angle ÷ 2π between the first ring and the last.
  std::vector<Curve> Turns(int count) const {
    // In mm, so that tolerances mean what they say.
    const double pitch = (scale_->PositionAt(count - 0.5) - scale_->PositionAt(0.5)) / (count - 1);
    LevelField field;
    field.period = pitch;
    field.value = [this, pitch](int, const Eigen::Vector3d& p) {
      return pitch * (scale_->PassesAt(Position(p)) - 0.5 - frame_.Angle(p, 0) / (2 * kPi));
    };
    double least = pitch;
    for (int i = 1; i < count; ++i)
      least = std::min(least, scale_->PositionAt(i + 0.5) - scale_->PositionAt(i - 0.5));
    LevelLines lines(region_, field, least / 4, options_.chord_tolerance, stop_);
    std::vector<Curve> turns;
    for (const Curve& line : lines.At(0, stop_)) {
      const Curve curve = Turned(line);
      Curve kept;
      const auto finish = [&] {
        if (!kept.pieces.empty()) turns.push_back(std::move(kept));
        kept = {};
      };
      for (const CurvePiece& piece : curve.pieces) {
        const auto between = [&](const Eigen::Vector3d& p) {
          const double passes = scale_->PassesAt(Position(p));
          return passes > 0.5 && passes < count - 0.5;
        };
        const std::optional<double> seam = SeamOn(piece, 0);
        const auto keep = [&](const CurvePiece& part) {
          if (between(part.At(0.5))) {
            kept.pieces.push_back(part);
          } else {
            finish();
          }
        };
        if (seam && *seam > 1e-9 && *seam < 1 - 1e-9) {
          keep(piece.Part(0, *seam));
          keep(piece.Part(*seam, 1));
        } else {
          keep(piece);
        }
      }
      finish();
    }
    return turns;
  }

  // Curves that begin where another ends (to the lines' tolerance) become one.
  std::vector<Curve> Joined(std::vector<Curve> parts) const {
    const double near = 4 * options_.chord_tolerance;
    std::vector<Curve> joined;
    for (Curve& part : parts) {
      const Eigen::Vector3d& start = part.pieces.front().start;
      const auto before = std::ranges::find_if(
          joined, [&](const Curve& curve) { return (curve.pieces.back().end - start).norm() <= near; });
      if (before == joined.end()) {
        joined.push_back(std::move(part));
        continue;
      }
      const Eigen::Vector3d end = before->pieces.back().end;
      if ((start - end).norm() > 1e-9) before->pieces.push_back(LinePiece(part.pieces[0].face, end, start));
      before->pieces.insert(before->pieces.end(), part.pieces.begin(), part.pieces.end());
    }
    return joined;
  }

  const Region& region_;
  const ToolpathOptions& options_;
  std::stop_token stop_;
  Frame frame_;
  bool walls_;
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
