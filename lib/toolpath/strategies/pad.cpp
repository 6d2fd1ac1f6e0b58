// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/pad.hpp"

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "geometry/slice/plane_slices.hpp"
#include "toolpath/strategies/level_lines.hpp"
#include "toolpath/strategies/pad_rings.hpp"
#include "toolpath/strategies/spread.hpp"
#include "toolpath/strategy_entry.hpp"
#include "toolpath/track.hpp"

namespace millpose {
namespace {

constexpr double kPlaneWithin = 0.1;  // mm

class PadMaker {
 public:
  PadMaker(const Region& region, const Pad& pad, const ToolpathOptions& options, std::stop_token stop)
      : region_(region),
        pad_(pad),
        options_(options),
        stop_(std::move(stop)),
        lines_(region, Field(region), options.stepover / 2, options.chord_tolerance, stop_) {}

  Layout Run() {
    if (!(lines_.largest() > 0)) return {};
    CheckPlane();
    layout_.normal = normal_;
    if (pad_.spiral) {
      AddSpiral();
    } else {
      AddLines();
    }
    return std::move(layout_);
  }

 private:
  // How far inside the region less its distance from the borders.
  static LevelField Field(const Region& region) {
    LevelField field;
    field.value = [&region](int face, const Eigen::Vector3d& p) { return region.Margin(face, p); };
    return field;
  }

  void CheckPlane() {
    normal_ = region_.MeanNormal();
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Region::Patch& patch : region_.Patches())
      for (const Eigen::Vector3d& p : patch.corners) {
        low = std::min(low, normal_.dot(p));
        high = std::max(high, normal_.dot(p));
      }
    if (normal_.norm() < 0.5 || high - low > kPlaneWithin)
      throw InputError({}, fmt::format("toolpath: strategy pad needs a plane region; this one is {:.3f} mm "
                                       "deep (allowed: {} mm); narrow it by facing or connected, or use "
                                       "strategy contours or parallel_planes",
                                       high - low, kPlaneWithin));
  }

  std::function<double(const Eigen::Vector3d&)> Inwards() const {
    return [&region = region_](const Eigen::Vector3d& p) { return region.BorderDistance(p); };
  }

  std::vector<Loop> Loops(double level) {
    std::vector<Loop> loops;
    for (Curve& curve : lines_.At(level, stop_))
      if (curve.closed) loops.emplace_back(std::move(curve));
    return loops;
  }

  CurveGroup& AddLane(Curve curve) {
    CurveGroup& lane = layout_.lanes.emplace_back();
    lane.curves.push_back(std::move(curve));
    lane.clipped = true;
    return lane;
  }

  // The innermost ring lies half a step-over from the middle line, where the rings of both sides meet.
  void AddSpiral() {
    const int count =
        std::max(1, static_cast<int>(std::ceil(lines_.largest() / options_.stepover + 0.5 - 1e-9)));
    const double step = lines_.largest() / (count - 0.5);
    std::vector<PadRing> rings;
    for (int level = 0; level < count; ++level)
      for (Loop& loop : Loops(level * step)) rings.push_back({std::move(loop), level});
    const bool climb = options_.direction == Direction::kClimb;
    for (Curve& curve :
         JoinRings(std::move(rings), step, climb, [this](const Eigen::Vector3d&a, const Eigen::Vector3d&b) {
           return IsFree(a, Inside(a), b, Inside(b));
         }))
      AddLane(std::move(curve)).oriented = true;
  }

  // How far inside a point near the pad's plane lies; negative over openings.
  double Inside(const Eigen::Vector3d& p) const {
    const SurfacePoint below = region_.mesh().Closest(p);
    if (below.distance > kPlaneWithin || !region_.HasFace(below.face)) return -kPlaneWithin;
    return region_.Margin(below.face, below.position);
  }

  // Whether the straight way between two points stays inside: between places that are farther inside than the
  // way is long there is nothing to find.
  bool IsFree(const Eigen::Vector3d& a, double at_a, const Eigen::Vector3d& b, double at_b) const {
    const double tolerance = 2 * options_.chord_tolerance;
    if (std::min(at_a, at_b) < -tolerance) return false;
    if (at_a + at_b + 2 * tolerance > (b - a).norm()) return true;
    const Eigen::Vector3d middle = (a + b) / 2;
    const double at_middle = Inside(middle);
    return IsFree(a, at_a, middle, at_middle) && IsFree(middle, at_middle, b, at_b);
  }

  // Where an end of a line lies on a border.
  struct End {
    size_t border = std::numeric_limits<size_t>::max();
    double at = 0;
  };

  struct Line {
    Curve curve;
    size_t row = 0;
    bool used = false;
    std::array<End, 2> ends;  // of its start and its end
  };

  std::vector<Line> CutLines() const {
    const Eigen::Vector3d across = normal_.cross(pad_.along).normalized();
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const Region::Patch& patch : region_.Patches())
      for (const Eigen::Vector3d& p : patch.corners) {
        lower = std::min(lower, across.dot(p));
        upper = std::max(upper, across.dot(p));
      }
    const double rim = options_.region.rim_distance;
    if (upper - lower > 2 * rim) {
      lower += rim;
      upper -= rim;
    }
    const CornerNormals normals(region_.mesh(), options_.crease);
    const Eigen::Vector3d along = across.cross(normal_);
    std::vector<Line> lines;
    size_t row = 0;
    for (auto& slice :
         SliceByPlanes(region_.mesh(), across, SpreadEvenly(lower, upper, options_.stepover), stop_)) {
      std::vector<Line> own;
      for (const Curve& curve : slice)
        for (Curve& part :
             ClipToRegion(region_.mesh(), curve, region_, normals, options_.crease, options_.chord_tolerance))
          own.push_back({std::move(part), row, false, {}});
      std::ranges::sort(own, {}, [&](const Line& line) { return along.dot(line.curve.pieces[0].start); });
      std::ranges::move(own, std::back_inserter(lines));
      ++row;
    }
    return lines;
  }

  // Lines joined along the borders, then the borders themselves, where the lines have left a saw's edge.
  void AddLines() {
    if ((normal_.cross(pad_.along)).norm() < 1e-6)
      throw InputError({}, "toolpath: the pad's direction must not be normal to it");
    borders_ = Loops(0);
    std::vector<char> done(borders_.size(), 0);
    rows_ = CutLines();
    FindEnds();
    const bool zigzag = options_.direction == Direction::kZigzag;
    for (Line& first : rows_) {
      if (first.used) continue;
      Curve curve;
      End end = Take(first, zigzag && first.row % 2 == 1, curve);
      while (zigzag && JoinNext(end, curve)) {
      }
      if (zigzag && end.border < borders_.size() && done[end.border] == 0) {
        done[end.border] = 1;
        const Loop& border = borders_[end.border];
        Append(curve, border.Way(end.at, border.length()));
      }
      AddLane(std::move(curve)).advance = [across = normal_.cross(pad_.along)](const Eigen::Vector3d& p) {
        return across.dot(p);
      };
    }
    for (size_t i = 0; i < borders_.size(); ++i)
      if (done[i] == 0)  // what is left lies outwards
        AddLane(borders_[i].curve()).advance = [&region = region_](const Eigen::Vector3d& p) {
          return -region.BorderDistance(p);
        };
  }

  void FindEnds() {
    const double near = 4 * options_.chord_tolerance;
    for (Line& line : rows_)
      for (size_t i = 0; i < borders_.size(); ++i)
        for (const int k : {0, 1}) {
          const auto [off, at] =
              borders_[i].Nearest(k == 0 ? line.curve.pieces.front().start : line.curve.pieces.back().end);
          if (off <= near) line.ends[k] = {i, at};
        }
  }

  // Appends a line to the way; returns where that ends.
  static End Take(Line& line, bool turned, Curve& curve) {
    line.used = true;
    Append(curve, (turned ? Reversed(line.curve) : line.curve).pieces);
    return line.ends[turned ? 0 : 1];
  }

  // Goes along the border to the nearest end of a line that is left. Along the border there is material that
  // has to go anyway: a way of some step-overs there is shorter than lifting the tool.
  bool JoinNext(End& end, Curve& curve) {
    constexpr double kLongest = 10;  // step-overs
    if (end.border >= borders_.size()) return false;
    const Loop& border = borders_[end.border];
    double best = kLongest * options_.stepover;
    Line* next = nullptr;
    bool turned = false, forwards = false;
    for (Line& line : rows_)
      for (const int k : {0, 1}) {
        if (line.used || line.ends[k].border != end.border) continue;
        const double way = line.ends[k].at - end.at, ahead = way < 0 ? way + border.length() : way;
        if (std::min(ahead, border.length() - ahead) >= best - 1e-6) continue;
        forwards = ahead <= border.length() - ahead;
        best = forwards ? ahead : border.length() - ahead;
        next = &line;
        turned = k == 1;
      }
    if (next == nullptr) return false;
    Curve link;
    link.pieces = border.Way(forwards ? end.at : next->ends[turned ? 1 : 0].at, best);
    Append(curve, (forwards ? link : Reversed(link)).pieces);
    end = Take(*next, turned, curve);
    return true;
  }

  const Region& region_;
  const Pad& pad_;
  const ToolpathOptions& options_;
  std::stop_token stop_;
  LevelLines lines_;
  std::vector<Loop> borders_;
  std::vector<Line> rows_;
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  Layout layout_;
};

}  // namespace

// Never quite 0, so that there are lines along the borders.
double Pad::RimDistance(const ToolpathOptions& options) const {
  constexpr double kLeastOffset = 1e-3;  // mm
  return std::max({options.region.rim_distance, kLeastOffset, offset.value_or(options.cutter.radius)});
}

Layout Pad::Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const {
  return PadMaker(region, *this, options, std::move(stop)).Run();
}

StrategyEntry PadEntry() {
  using S = Pad;
  using namespace yaml;
  return EntryOf<S>(
      "pad", "Strategy pad: a plane region.",
      Section<S>(
          {Key<S>("pattern", MILLPOSE_AT(spiral), ChoiceOf<bool>({{"zigzag", false}, {"spiral", true}}),
                  "Lines joined along the border, or rings from the border inwards."),
           Key<S>("along", MILLPOSE_AT(along), yaml::Direction(),
                  "Direction of the zigzag's lines, in the workpiece frame."),
           Key<S>("offset_mm", MILLPOSE_AT(offset), Maybe(Real(kMm, UpTo(1000))),
                  "Distance of the tool from borders and islands; the cutter's radius by default.")}));
}

}  // namespace millpose
