// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/moving_stations.hpp"

#include <map>
#include <tuple>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "machine/collision/station_path.hpp"
#include "planning/external/external_course.hpp"
#include "run/pipeline/stages/station_sample.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

constexpr size_t kPairs = 16;  // of a pass, by the worst point and by the sum each, that are scored in full

using OnBranches = std::array<double, 8>;

/// What one pass could gain by moving axes.
class MovingPassScorer {
 public:
  MovingPassScorer(const JobInputs& inputs, const MovingStations& moving, const Pass& pass)
      : moving_(moving),
        cell_(moving.stations.world().cell()),
        mechanism_(cell_.external_axes),
        leave_(MakeLinkMoveOptions(inputs.job).leave),
        bounds_{MakePathOptions(inputs.job).steps.speed_share},
        whole_(EndingWhereItBegan(pass)),
        sample_(SampleOf(whole_)),
        reference_(inputs.job.toolpath.world_reference.normalized()) {
    const double begin = whole_.points.front().arc_length;
    const double length = whole_.points.back().arc_length - begin;
    for (const MillingPoint& point : sample_.points)
      shares_.push_back(length > 0 ? (point.arc_length - begin) / length : 0);
    for (size_t s = 0; s < moving.positions.size(); ++s) index_[moving.positions[s]] = s;
  }

  std::vector<CourseScore> Score() {
    std::vector<CourseScore> pairs = Estimates(), chosen;
    const auto take = [&](const auto& key) {
      const size_t count = std::min(kPairs, pairs.size());
      std::ranges::partial_sort(pairs, pairs.begin() + static_cast<std::ptrdiff_t>(count), {}, key);
      for (size_t i = 0; i < count; ++i)
        if (std::ranges::none_of(chosen, [&](const CourseScore& known) {
              return known.from == pairs[i].from && known.to == pairs[i].to;
            }))
          chosen.push_back(pairs[i]);
    };
    take([](const CourseScore& c) {
      return std::tuple(c.score.lost, c.score.worst, c.score.sum, c.from, c.to);
    });
    take([](const CourseScore& c) {
      return std::tuple(c.score.lost, c.score.sum, c.score.worst, c.from, c.to);
    });
    const StationPath way(moving_.stations.world(), cell_.home, 1);
    std::erase_if(chosen, [&](const CourseScore& c) {
      return way.StandingBetween(moving_.positions[c.from], moving_.positions[c.to]).has_value();
    });
    for (CourseScore& c : chosen) {
      const ExternalCourse course = CourseOf(c.from, c.to);
      c.score = ScoreOf(sample_.points.size(),
                        [&](size_t t, size_t branch) { return At(t, course.At(shares_[t]))[branch]; });
    }
    return chosen;
  }

 private:
  ExternalCourse CourseOf(size_t from, size_t to) const {
    return {moving_.positions[from], moving_.positions[to]};
  }

  bool MayMove(const ExternalCourse& course) const {
    for (size_t i = 0; i < moving_.axes.size(); ++i)
      if (!moving_.axes[i].continuous && course.from[i] != course.to[i]) return false;
    return course.Moves() && IsSlowEnough(course, whole_, cell_.external_axes, bounds_);
  }

  /// All pairs, each point of the sample scored at the station that is nearest to where the axes are then.
  std::vector<CourseScore> Estimates() {
    std::vector<CourseScore> pairs;
    if (sample_.points.empty()) return pairs;
    for (size_t from = 0; from < moving_.positions.size(); ++from)
      for (size_t to = 0; to < moving_.positions.size(); ++to) {
        const ExternalCourse course = CourseOf(from, to);
        if (!MayMove(course)) continue;
        std::vector<const OnBranches*> near;
        for (size_t t = 0; t < shares_.size(); ++t) {
          const ExternalPosition nearest = Nearest(course.At(shares_[t]));
          if (!index_.contains(nearest)) break;  // something is in the way there
          near.push_back(&At(t, nearest));
        }
        if (near.size() < shares_.size()) continue;
        pairs.push_back(
            {from, to, ScoreOf(near.size(), [&](size_t t, size_t branch) { return (*near[t])[branch]; })});
      }
    return pairs;
  }

  ExternalPosition Nearest(ExternalPosition position) const {
    for (size_t i = 0; i < position.size(); ++i)
      position[i] = *std::ranges::min_element(moving_.axes[i].values, {},
                                              [&](double value) { return std::abs(value - position[i]); });
    return position;
  }

  /// Point t of the sample with the axes at `external`; worked out once.
  const OnBranches& At(size_t t, const ExternalPosition& external) {
    const auto [known, unknown] = known_.try_emplace({t, external});
    if (!unknown) return known->second;
    const std::shared_ptr<const Station> station = moving_.stations.Own(external);
    Pass one;
    one.points.push_back(sample_.points[t]);
    Transform(mechanism_.Moved(Carries::kWorkpiece, external) * cell_.X_WP, one);
    Checker checker(station->world);
    const SampledPoint point(*station, checker, leave_, one.points.front(), reference_,
                             t == 0 || t + 1 == sample_.points.size());
    for (size_t branch = 0; branch < 8; ++branch) known->second[branch] = point.Best(branch);
    return known->second;
  }

  const MovingStations& moving_;
  const Cell& cell_;
  Mechanism mechanism_;
  RetractOptions leave_;
  CoordinatedBounds bounds_;
  Pass whole_, sample_;  ///< in P
  Eigen::Vector3d reference_;
  std::vector<double> shares_;  ///< of the way, of each point of the sample
  std::map<ExternalPosition, size_t> index_;
  std::map<std::pair<size_t, ExternalPosition>, OnBranches> known_;
};

}  // namespace

std::vector<std::vector<CourseScore>> ScoreMoving(const JobInputs& inputs, const MovingStations& moving,
                                                  const Toolpath& toolpath, const Execution& execution) {
  std::vector<std::vector<CourseScore>> scores(toolpath.passes.size());
  if (std::ranges::none_of(moving.axes, &AxisPositions::continuous)) return scores;
  ParallelFor(scores.size(), execution.Threads(), execution.stop, [&](size_t p) {
    const Pass& pass = toolpath.passes[p];
    const bool left_open = pass.closed && pass.opening != RingOpening::kNone;
    if (pass.points.size() < 2 || left_open) return;
    scores[p] = MovingPassScorer(inputs, moving, pass).Score();
  });
  return scores;
}

}  // namespace millpose
