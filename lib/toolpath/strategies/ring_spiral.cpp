// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/ring_spiral.hpp"

#include "toolpath/strategies/level_lines.hpp"
#include "toolpath/strategies/loop.hpp"

namespace millpose {
namespace {

class SpiralMaker {
 public:
  explicit SpiralMaker(const SpiralPlan& plan) : plan_(plan), count_(plan.scale.count()) {}

  std::vector<Curve> Run(const std::stop_token& stop) {
    AddRing(0.5);
    for (const Curve& line : Lines(stop)) AddTurns(plan_.frame.Turned(line));
    AddRing(count_ - 0.5);
    return Joined();
  }

 private:
  double Passes(const Eigen::Vector3d& p) const { return plan_.scale.PassesAt(plan_.Position(p)); }

  void AddRing(double passes) {
    for (const Curve& slice : plan_.slice(plan_.scale.PositionAt(passes))) {
      Curve curve = plan_.frame.Turned(slice);
      plan_.frame.MoveSeam(curve, 0);
      curve.closed = false;
      parts_.push_back(std::move(curve));
    }
  }

  // Where passes = ½ + turns + angle ÷ 2π, as a function in mm, so that tolerances mean what they say.
  std::vector<Curve> Lines(const std::stop_token& stop) const {
    const double pitch = (plan_.scale.PositionAt(count_ - 0.5) - plan_.scale.PositionAt(0.5)) / (count_ - 1);
    LevelField field;
    field.period = pitch;
    field.winding = [this, pitch](const Eigen::Vector3d& p) { return pitch * Passes(p); };
    field.value = [this, pitch](int, const Eigen::Vector3d& p) {
      return pitch * (Passes(p) - 0.5 - plan_.frame.Angle(p, 0) / (2 * kPi));
    };
    return LevelLines(plan_.region, field, pitch / 4, plan_.options.chord_tolerance, stop).At(0, stop);
  }

  // What of a line lies between the first ring and the last, in parts that end at the seam.
  void AddTurns(const Curve& line) {
    Curve kept;
    const auto finish = [&] {
      if (!kept.pieces.empty()) parts_.push_back(std::move(kept));
      kept = {};
    };
    const auto keep = [&](const CurvePiece& part) {
      const double passes = Passes(part.At(0.5));
      if (passes > 0.5 && passes < count_ - 0.5) {
        kept.pieces.push_back(part);
      } else {
        finish();
      }
    };
    for (const CurvePiece& piece : line.pieces) {
      const std::optional<double> seam = plan_.frame.SeamOn(piece, 0);
      if (seam && *seam > 1e-9 && *seam < 1 - 1e-9) {
        keep(piece.Part(0, *seam));
        keep(piece.Part(*seam, 1));
      } else {
        keep(piece);
      }
    }
    finish();
  }

  // Curves that begin where another ends (to the lines' tolerance) become one.
  std::vector<Curve> Joined() {
    const double near = 4 * plan_.options.chord_tolerance;
    std::vector<Curve> joined;
    for (Curve& part : parts_) {
      const Eigen::Vector3d& start = part.pieces.front().start;
      const auto before = std::ranges::find_if(
          joined, [&](const Curve& curve) { return (curve.pieces.back().end - start).norm() <= near; });
      if (before == joined.end()) {
        joined.push_back(std::move(part));
        continue;
      }
      Append(*before, part.pieces);
    }
    return joined;
  }

  const SpiralPlan& plan_;
  int count_;
  std::vector<Curve> parts_;
};

}  // namespace

CurveGroup MakeSpiral(const SpiralPlan& plan, const std::stop_token& stop) {
  CurveGroup lane;
  lane.curves = SpiralMaker(plan).Run(stop);
  lane.oriented = true;
  // By turns; of the rings, which are one turn each, by the angle.
  lane.progress = [scale = plan.scale, frame = plan.frame, walls = plan.walls](const Eigen::Vector3d& p) {
    return scale.PassesAt(walls ? frame.Height(p) : frame.axis().Radius(p)) + 1e-3 * frame.Angle(p, 0);
  };
  return lane;
}

}  // namespace millpose
