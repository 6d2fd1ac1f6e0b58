// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/under_load.hpp"

#include <limits>

#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"
#include "program/verify/compare.hpp"
#include "program/verify/stations.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// A cut as the part sees it, which stands where it does with the external axes at one position.
class OnPart {
 public:
  OnPart(const Cell& cell, const ExternalPosition& external) : cell_(cell), external_(external) {}

  /// The tip with the external axes at `there`.
  Vector3d Tip(const Joints& q, const ExternalPosition& there) const {
    const Pose X_WB =
        there == external_ ? BaseInWorld(cell_, there) : PartInWorld(external_) * BaseInPart(cell_, there);
    return (X_WB * ForwardFlange(cell_.arm, q) * cell_.X_FT).translation();
  }
  /// What is at `place` in W with the external axes at `there`, and a direction.
  Vector3d SourceLocation(const Vector3d& place, const ExternalPosition& there) const {
    return there == external_ ? place : Vector3d(From(there) * place);
  }
  Vector3d Direction(const Vector3d& direction, const ExternalPosition& there) const {
    return there == external_ ? direction : Vector3d(From(there).linear() * direction);
  }

 private:
  Pose PartInWorld(const ExternalPosition& there) const {
    return Mechanism(cell_.external_axes).Moved(Carries::kWorkpiece, there) * cell_.X_WP;
  }
  Pose From(const ExternalPosition& there) const {
    return PartInWorld(external_) * PartInWorld(there).inverse(Eigen::Isometry);
  }

  const Cell& cell_;
  const ExternalPosition& external_;
};

/// The way of the tip along one cut, without approach and retract: they lead through places above a point
/// that is too deep.
class TipPath {
 public:
  /// From the stop at `first` to that at `last`, both as commanded.
  TipPath(const MotionProgram& program, const Replay& replay, const FeedRun& run, const OnPart& part,
          const Vector3d& first, const Vector3d& last) {
    std::vector<size_t> stops;  // indices of tips
    for (size_t i = run.first; i <= run.last; ++i) {
      if (program.motions[i].exact) stops.push_back(tips_.size());
      tips_.push_back(part.Tip(replay.targets[i], program.motions[i].external));
    }
    const size_t begin = FirstAt(stops, first), end = FirstAt({stops.rbegin(), stops.rend()}, last);
    if (begin <= end)
      tips_ = {tips_.begin() + static_cast<long>(begin), tips_.begin() + static_cast<long>(end) + 1};
    place_ = tips_.front();
  }

  const Vector3d& Begin() const { return tips_.front(); }
  const Vector3d& End() const { return tips_.back(); }

  /// The place of the way nearest to `tip`, from where the last answer was on and within `reach` (mm) of way.
  Vector3d Nearest(const Vector3d& tip, double reach) {
    double best = std::numeric_limits<double>::infinity();
    double way = -(place_ - tips_[segment_]).norm();  // from the last answer to the segment's begin
    for (size_t k = segment_; k + 1 < tips_.size() && way <= reach; ++k) {
      const Vector3d along = tips_[k + 1] - tips_[k];
      const double square = along.squaredNorm();
      const double share = square > 0 ? std::clamp((tip - tips_[k]).dot(along) / square, 0.0, 1.0) : 0;
      const Vector3d here = tips_[k] + share * along;
      way += std::sqrt(square);
      if (const double distance = (here - tip).norm(); distance < best) {
        best = distance;
        place_ = here;
        segment_ = k;
      }
    }
    return place_;
  }

 private:
  /// The first of the stops that is hardly farther from `place` than the nearest: a ring stops twice there.
  size_t FirstAt(const std::vector<size_t>& stops, const Vector3d& place) const {
    constexpr double kHardly = 0.05;  // mm
    double nearest = std::numeric_limits<double>::infinity();
    for (const size_t stop : stops) nearest = std::min(nearest, (tips_[stop] - place).norm());
    for (const size_t stop : stops)
      if ((tips_[stop] - place).norm() <= nearest + kHardly) return stop;
    return 0;
  }

  std::vector<Vector3d> tips_;
  size_t segment_ = 0;
  Vector3d place_;
};

/// The points of a piece that have a commanded pose.
std::vector<int> PointsOf(const PassResult& pass, const Segment& piece) {
  std::vector<int> points;
  for (int i = piece.first; i <= piece.last; ++i)
    if (pass.points[static_cast<size_t>(i)].compensation) points.push_back(i);
  return points;
}

const Segment* FindSegment(const PassResult& pass, int number) {
  const auto found = std::ranges::find(pass.pieces, number, &Segment::piece);
  return found == pass.pieces.end() ? nullptr : &*found;
}

/// How far the points of one cut are off, into `result` where that is more.
void LookAlong(const MotionProgram& program, const Replay& replay, const FeedRun& run, const Cell& cell,
               const PassResult& pass, const Segment& piece, UnderLoad& result) {
  const OnPart part(cell, pass.external);
  std::vector<int> points = PointsOf(pass, piece);
  if (points.empty()) return;
  if (piece.closed) points.push_back(points.front());  // where a ring comes by once more at its end
  const auto commanded = [&](int point) {
    const auto i = static_cast<size_t>(point);
    return part.Tip(pass.points[i].compensation->q, ExternalAt(pass, i));
  };
  const auto nominal = [&](int point) {
    const auto i = static_cast<size_t>(point);
    return part.SourceLocation(pass.points[i].point.position, ExternalAt(pass, i));
  };
  TipPath way(program, replay, run, part, commanded(points.front()), commanded(points.back()));
  for (size_t k = 0; k < points.size(); ++k) {
    const auto i = static_cast<size_t>(points[k]);
    const Vector3d wanted = commanded(points[k]);
    const double step = k > 0 ? (nominal(points[k]) - nominal(points[k - 1])).norm() : 0;
    const bool end = k + 1 == points.size();
    const Vector3d there = k == 0 ? way.Begin() : end ? way.End() : way.Nearest(wanted, 2 * step + 1);
    const double off =
        std::abs((there - wanted).dot(part.Direction(pass.points[i].point.normal, ExternalAt(pass, i))));
    if (off > result.largest) result = {off, pass.pass, points[k]};
  }
}

}  // namespace

UnderLoad ReplayUnderLoad(const MotionProgram& program, const Cell& cell, const PlanResult& plan) {
  std::vector<Finding> said;  // Verify() has told them
  const Replay replay = ReplayTargets(program, cell, said);
  const std::vector<FeedRun> runs = FeedRuns(program);
  UnderLoad result;
  size_t run = 0;
  for (const LinkMove& gap : plan.gaps) {
    if (gap.to_pass < 0 || run == runs.size()) continue;
    const PassResult& pass = plan.passes[static_cast<size_t>(gap.to_pass)];
    const Segment* piece = FindSegment(pass, gap.to_piece);
    if (!piece) continue;
    LookAlong(program, replay, runs[run++], cell, pass, *piece, result);
  }
  return result;
}

void CheckUnderLoad(const UnderLoad& found, double chord, std::vector<Finding>& findings) {
  constexpr double kText = 1e-3;  // mm, that the text of a program may round away and more
  if (found.largest <= chord + kText) return;
  findings.push_back(
      {"", 0,
       fmt::format("pass {} point {}: the compensated tip is commanded {:.2f} µm off along the "
                   "normal; allowed: {:.2f} µm",
                   found.pass, found.point, 1e3 * found.largest, 1e3 * (chord + kText)),
       Cause::kPath});
}

}  // namespace millpose
