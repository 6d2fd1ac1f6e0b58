// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/under_load.hpp"

#include <limits>

#include "plan/station.hpp"
#include "robot/kinematics.hpp"
#include "verify/compare.hpp"
#include "verify/stations.hpp"

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
  Vector3d Place(const Vector3d& place, const ExternalPosition& there) const {
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

/// The way of the tip along one cut.
class TipWay {
 public:
  TipWay(const MotionProgram& program, const Replay& replay, const FeedRun& run, const OnPart& part) {
    for (size_t i = run.first == 0 ? 0 : run.first - 1; i <= run.last; ++i)
      tips_.push_back(part.Tip(replay.targets[i], program.motions[i].external));
    place_ = tips_.front();
  }

  double FromStart(const Vector3d& tip) const { return (tip - tips_.front()).norm(); }

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
  std::vector<Vector3d> tips_;
  size_t segment_ = 0;
  Vector3d place_;
};

const Piece* FindPiece(const PassResult& pass, int number) {
  const auto found = std::ranges::find(pass.pieces, number, &Piece::piece);
  return found == pass.pieces.end() ? nullptr : &*found;
}

}  // namespace

UnderLoad ReplayUnderLoad(const MotionProgram& program, const Cell& cell, const PlanResult& plan) {
  std::vector<Finding> said;  // Verify() has told them
  const Replay replay = ReplayTargets(program, cell, said);
  const std::vector<FeedRun> runs = FeedRuns(program);
  UnderLoad result;
  size_t run = 0;
  for (const Gap& gap : plan.gaps) {
    if (gap.to_pass < 0 || run == runs.size()) continue;
    const PassResult& pass = plan.passes[static_cast<size_t>(gap.to_pass)];
    const Piece* piece = FindPiece(pass, gap.to_piece);
    if (!piece) continue;
    const OnPart part(cell, pass.external);
    TipWay way(program, replay, runs[run++], part);
    std::optional<double> reach;
    for (int i = piece->first; i <= piece->last; ++i) {
      const auto index = static_cast<size_t>(i);
      const PlannedPoint& point = pass.points[index];
      if (!point.compensation) continue;
      const ExternalPosition& external = ExternalAt(pass, index);
      const Vector3d commanded = part.Tip(point.compensation->q, external);
      // The approach comes first, and a ring comes by once more at its end.
      if (!reach) reach = 1.5 * way.FromStart(commanded) + 1;
      if (i > piece->first) {
        const Vector3d before =
            part.Place(pass.points[index - 1].point.position, ExternalAt(pass, index - 1));
        reach = 2 * (part.Place(point.point.position, external) - before).norm() + 1;
      }
      const double off = std::abs(
          (way.Nearest(commanded, *reach) - commanded).dot(part.Direction(point.point.normal, external)));
      if (off > result.largest) result = {off, pass.pass, i};
    }
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
