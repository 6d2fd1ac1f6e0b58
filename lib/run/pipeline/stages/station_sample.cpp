// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/station_sample.hpp"

#include <algorithm>
#include <limits>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr size_t kSample = 7;  // points of a pass
constexpr size_t kLooks = 72;  // at a point on one branch for interference
constexpr double kRotationStep = DegToRad(5);

}  // namespace

Pass SampleOf(const Pass& pass) {
  Pass sample = pass;
  std::erase_if(sample.points, [](const MillingPoint& point) { return point.gouge > 0; });
  const size_t count = sample.points.size();
  if (count <= kSample) return sample;
  std::vector<MillingPoint> points;
  for (size_t i = 0; i < kSample; ++i) points.push_back(sample.points[i * (count - 1) / (kSample - 1)]);
  sample.points = std::move(points);
  return sample;
}

SampledPoint::SampledPoint(const Station& station, Checker& checker, const RetractOptions& leave,
                           const MillingPoint& point, const Eigen::Vector3d& rotation_reference, bool end)
    : checker_(checker),
      leave_(leave),
      carrier_{station.problem.arm, station.problem.X_WB, station.problem.X_FT},
      table_(CandidateTable::OfStep(PointScorer(station.problem, point, rotation_reference), kRotationStep)),
      end_(end) {}

double SampledPoint::Best(size_t branch) const {
  std::vector<const CandidateTable::Entry*> entries;
  for (const CandidateTable::Entry& entry : table_.entries())
    if (entry.branch == static_cast<int>(branch)) entries.push_back(&entry);
  std::ranges::stable_sort(entries, {}, &CandidateTable::Entry::objective);
  for (size_t i = 0; i < std::min(entries.size(), kLooks); ++i) {
    const Joints& q = entries[i]->q;
    if (checker_.Blocked(q, Phase::kCutting) || (end_ && !CanLeave(checker_, carrier_, q, leave_))) continue;
    return entries[i]->objective;
  }
  return std::numeric_limits<double>::infinity();
}

StationScore ScoreOf(size_t count, const std::function<double(size_t, size_t)>& best) {
  StationScore least{count, 0, 0};
  for (size_t branch = 0; branch < 8; ++branch) {
    StationScore score;
    for (size_t t = 0; t < count && score.lost <= least.lost; ++t) {
      const double value = best(t, branch);
      if (!std::isfinite(value)) {
        ++score.lost;
        continue;
      }
      score.worst = std::max(score.worst, value);
      score.sum += value;
    }
    if (score < least) least = score;
  }
  return least;
}

}  // namespace millpose
