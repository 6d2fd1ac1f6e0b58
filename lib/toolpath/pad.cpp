// SPDX-License-Identifier: GPL-3.0-or-later
// Facing of a plane pad: a zigzag whose lines are joined along the border, or rings from the border inwards
// joined to a spiral. The tool keeps its offset from border and islands.
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "surface/plane_slices.hpp"
#include "toolpath/level_lines.hpp"
#include "toolpath/spread.hpp"
#include "toolpath/strategy.hpp"
#include "toolpath/track.hpp"

namespace millpose {
namespace {

constexpr double kPlaneWithin = 0.1;  // mm

// A closed line with lengths along it.
class Loop {
 public:
  explicit Loop(Curve curve) : curve_(std::move(curve)) {
    for (const CurvePiece& piece : curve_.pieces) begins_.push_back(begins_.back() + piece.LengthBound(0, 1));
  }
  const Curve& curve() const { return curve_; }
  double length() const { return begins_.back(); }

  /// Distance of p from the line and where along it the nearest point lies.
  std::pair<double, double> Nearest(const Eigen::Vector3d& p) const {
    std::pair<double, double> nearest{std::numeric_limits<double>::infinity(), 0};
    for (size_t i = 0; i < curve_.pieces.size(); ++i) {
      const CurvePiece& piece = curve_.pieces[i];
      const Eigen::Vector3d way = piece.end - piece.start;
      const double t = std::clamp((p - piece.start).dot(way) / way.squaredNorm(), 0.0, 1.0);
      const double distance = (piece.start + t * way - p).norm();
      if (distance < nearest.first) nearest = {distance, begins_[i] + t * way.norm()};
    }
    return nearest;
  }

  /// The way from one length to another in the line's direction, over its start where needed.
  std::vector<CurvePiece> Part(double from, double to) const {
    std::vector<CurvePiece> part;
    if (to < from) {
      part = Part(from, length());
      from = 0;
    }
    for (size_t i = 0; i < curve_.pieces.size(); ++i) {
      const double begin = begins_[i], own = begins_[i + 1] - begin;
      const double t0 = std::max(0.0, (from - begin) / own), t1 = std::min(1.0, (to - begin) / own);
      if (t1 > t0 + 1e-12) part.push_back(curve_.pieces[i].Part(t0, t1));
    }
    return part;
  }

  /// The whole line from a length round to it again.
  std::vector<CurvePiece> Round(double from) const {
    std::vector<CurvePiece> round = Part(from, length());
    const std::vector<CurvePiece> rest = from > 0 ? Part(0, from) : std::vector<CurvePiece>{};
    round.insert(round.end(), rest.begin(), rest.end());
    return round;
  }

 private:
  Curve curve_;
  std::vector<double> begins_{0.0};
};

void Append(Curve& curve, const std::vector<CurvePiece>& pieces) {
  if (pieces.empty()) return;
  if (!curve.pieces.empty()) {
    const Eigen::Vector3d &end = curve.pieces.back().end, &start = pieces.front().start;
    if ((start - end).norm() > 1e-9) curve.pieces.push_back(LinePiece(pieces.front().face, end, start));
  }
  curve.pieces.insert(curve.pieces.end(), pieces.begin(), pieces.end());
}

class PadMaker {
 public:
  PadMaker(const Region& region, const ToolpathOptions& options, std::stop_token stop)
      : region_(region),
        options_(options),
        stop_(std::move(stop)),
        lines_(region, Field(region), options.stepover / 2, options.chord_tolerance, stop_) {}

  Layout Run() {
    if (!(lines_.largest() > 0)) return {};
    CheckPlane();
    if (options_.spiral) {
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

  void AddLane(Curve curve) {
    Lane lane;
    lane.curves.push_back(std::move(curve));
    lane.advance = Inwards();
    lane.clipped = true;
    layout_.lanes.push_back(std::move(lane));
  }

  // Rings, outermost first; each goes on where the next one in is nearest. The innermost lies half a
  // step-over from the middle line, where the rings of both sides meet.
  void AddSpiral() {
    const int count =
        std::max(1, static_cast<int>(std::ceil(lines_.largest() / options_.stepover + 0.5 - 1e-9)));
    const double step = lines_.largest() / (count - 0.5);
    std::vector<std::vector<Loop>> rings;
    for (int i = 0; i < count; ++i) rings.push_back(Loops(i * step));
    for (size_t level = 0; level < rings.size(); ++level)
      while (!rings[level].empty()) AddChain(rings, level, 1.5 * step);
  }

  void AddChain(std::vector<std::vector<Loop>>& rings, size_t level, double reach) {
    Curve curve;
    size_t ring = 0;
    double from = 0;
    for (;;) {
      Append(curve, rings[level][ring].Round(from));
      rings[level].erase(rings[level].begin() + static_cast<std::ptrdiff_t>(ring));
      if (++level == rings.size()) break;
      const Eigen::Vector3d end = curve.pieces.back().end;
      double nearest = reach;
      for (size_t i = 0; i < rings[level].size(); ++i)
        if (const auto [distance, at] = rings[level][i].Nearest(end); distance < nearest) {
          nearest = distance;
          ring = i;
          from = at;
        }
      if (!(nearest < reach)) break;
    }
    curve.closed = (curve.pieces.back().end - curve.pieces.front().start).norm() < 1e-9;
    AddLane(std::move(curve));
  }

  struct Line {
    Curve curve;
    size_t row;
    bool used = false;
  };

  std::vector<Line> CutLines() const {
    const Eigen::Vector3d across = normal_.cross(options_.pad_direction).normalized();
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
          own.push_back({std::move(part), row, false});
      std::ranges::sort(own, {}, [&](const Line& line) { return along.dot(line.curve.pieces[0].start); });
      std::ranges::move(own, std::back_inserter(lines));
      ++row;
    }
    return lines;
  }

  // Lines joined along the border, then the border itself, where the lines have left a saw's edge.
  void AddLines() {
    if ((normal_.cross(options_.pad_direction)).norm() < 1e-6)
      throw InputError({}, "toolpath: the pad's direction must not be normal to it");
    const std::vector<Loop> borders = Loops(0);
    std::vector<Line> lines = CutLines();
    for (Line& first : lines) {
      if (first.used) continue;
      first.used = true;
      const bool backwards = first.row % 2 == 1 && options_.direction == Direction::kZigzag;
      Curve curve = backwards ? Reversed(first.curve) : first.curve;
      size_t row = first.row;
      while (options_.direction == Direction::kZigzag && JoinNext(borders, lines, row, curve)) {
      }
      AddLane(std::move(curve));
      layout_.lanes.back().advance = [across = normal_.cross(options_.pad_direction)](
                                         const Eigen::Vector3d& p) { return across.dot(p); };
    }
    for (const Loop& border : borders) {
      AddLane(border.curve());  // what is left lies outwards
      layout_.lanes.back().advance = [inwards = Inwards()](const Eigen::Vector3d& p) { return -inwards(p); };
    }
  }

  // Goes along the border to the nearest end of a line in the next row.
  bool JoinNext(const std::vector<Loop>& borders, std::vector<Line>& lines, size_t& row, Curve& curve) const {
    const double near = 4 * options_.chord_tolerance, longest = 3 * options_.stepover;
    const Eigen::Vector3d end = curve.pieces.back().end;
    Line* next = nullptr;
    bool next_turned = false;
    std::vector<CurvePiece> link;
    double best = longest;
    for (const Loop& border : borders) {
      const auto [off, from] = border.Nearest(end);
      if (off > near) continue;
      for (Line& line : lines) {
        if (line.used || line.row != row + 1) continue;
        for (const bool turned : {false, true}) {
          const auto [other_off, to] =
              border.Nearest(turned ? line.curve.pieces.back().end : line.curve.pieces.front().start);
          if (other_off > near) continue;
          const double ahead = to >= from ? to - from : to - from + border.length();
          const bool forwards = ahead <= border.length() - ahead;
          const double way = forwards ? ahead : border.length() - ahead;
          if (way >= best) continue;
          best = way;
          next = &line;
          next_turned = turned;
          Curve part;
          part.pieces = forwards ? border.Part(from, to) : border.Part(to, from);
          link = (forwards ? part : Reversed(part)).pieces;
        }
      }
    }
    if (next == nullptr) return false;
    next->used = true;
    row = next->row;
    Append(curve, link);
    Append(curve, (next_turned ? Reversed(next->curve) : next->curve).pieces);
    return true;
  }

  const Region& region_;
  const ToolpathOptions& options_;
  std::stop_token stop_;
  LevelLines lines_;
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  Layout layout_;
};

class Pad : public Strategy {
 public:
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override {
    return PadMaker(region, options, std::move(stop)).Run();
  }
};

}  // namespace

std::unique_ptr<Strategy> MakePad() { return std::make_unique<Pad>(); }

}  // namespace millpose
