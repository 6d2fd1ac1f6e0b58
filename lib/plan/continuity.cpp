// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/continuity.hpp"

#include "base/units.hpp"
#include "motion/cut_feed.hpp"
#include "motion/line.hpp"
#include "robot/angles.hpp"
#include "robot/kinematics.hpp"

namespace millpose {
namespace {

/// The samples of a piece; a closed one ends with its first point again.
struct Cut {
  std::vector<CutSample> samples;
  std::vector<int> points;  ///< of each sample, into PassResult::points
};

Cut CutOf(const PassResult& pass, const Piece& piece) {
  constexpr double kSamePlace = 1e-9;  // mm
  Cut cut;
  for (int i = piece.first; i <= piece.last; ++i) {
    const PlannedPoint& point = pass.points[i];
    const CutSample sample{point.q, point.point.arc_length, point.point.feed_rate};
    if (!cut.samples.empty() && sample.arc_length < cut.samples.back().arc_length + kSamePlace) continue;
    cut.samples.push_back(sample);
    cut.points.push_back(i);
  }
  if (piece.closed && cut.samples.size() > 1) {
    const PlannedPoint &first = pass.points[piece.first], &last = pass.points[piece.last];
    const double way = (first.point.position - last.point.position).norm();
    if (way > kSamePlace) {
      const Joints q = Beside(last.q, first.q);
      cut.samples.push_back({q, cut.samples.back().arc_length + way, first.point.feed_rate});
      cut.points.push_back(piece.first);
    }
  }
  return cut;
}

/// s, at the points' feeds.
double TimeOf(const Cut& cut) {
  double time = 0;
  for (size_t i = 1; i < cut.samples.size(); ++i) {
    const CutSample &from = cut.samples[i - 1], &to = cut.samples[i];
    time += (to.arc_length - from.arc_length) / (0.5 * (from.feed + to.feed));
  }
  return time;
}

/// Squares of the accelerations summed over time, for the mean over all cuts.
struct SquareSum {
  Joints sum = Joints::Zero();
  double time = 0;
};

void AddCut(const Cut& cut, const Carrier& carrier, ContinuityFigures& figures, SquareSum& squares) {
  const Arm& arm = carrier.arm;
  const JointRates rates = RatesAlong(cut.samples);
  const double time = TimeOf(cut);
  for (size_t i = 0; i < cut.samples.size(); ++i) {
    const Joints& q = cut.samples[i].q;
    figures.speed_share = figures.speed_share.cwiseMax(rates.speed[i].cwiseAbs().cwiseQuotient(arm.speed));
    figures.acceleration_share =
        figures.acceleration_share.cwiseMax(rates.acceleration[i].cwiseAbs().cwiseQuotient(arm.acceleration));
    const SingularityDistance singular = DistanceToSingularity(arm, q);
    figures.wrist = std::min(figures.wrist, singular.wrist);
    figures.elbow = std::min(figures.elbow, singular.elbow);
    figures.shoulder =
        figures.shoulder == 0 ? singular.shoulder : std::min(figures.shoulder, singular.shoulder);
    if (i == 0) continue;
    const Deviation deviation = HalfwayDeviation(carrier, cut.samples[i - 1].q, q);
    figures.halfway_deviation = std::max(figures.halfway_deviation, deviation.position);
    figures.halfway_axis = std::max(figures.halfway_axis, deviation.axis);
  }
  squares.sum += time * TimeRms(cut.samples, rates.acceleration).cwiseAbs2();
  squares.time += time;
}

}  // namespace

ContinuityFigures AnalyseContinuity(const PlanResult& plan) {
  const Carrier carrier{plan.arm, plan.X_WB, plan.X_FT};
  ContinuityFigures figures;
  SquareSum squares;
  size_t first_point = 0;
  for (const PassResult& pass : plan.passes) {
    for (const Piece& piece : pass.pieces) {
      const Cut cut = CutOf(pass, piece);
      AddCut(cut, carrier, figures, squares);
      for (const FeedShortfall& s : FindShortfalls(cut.samples, plan.arm.speed, plan.arm.acceleration)) {
        figures.feed_not_held.push_back({pass.pass, first_point + static_cast<size_t>(cut.points[s.sample]),
                                         s.joint, s.by_acceleration, cut.samples[s.sample].feed,
                                         s.feed_possible});
      }
    }
    first_point += pass.points.size();
  }
  if (squares.time > 0) figures.acceleration_rms = (squares.sum / squares.time).cwiseSqrt();
  return figures;
}

double SquaredAcceleration(const PassResult& pass) {
  double square = 0;
  for (const Piece& piece : pass.pieces) {
    const Cut cut = CutOf(pass, piece);
    const Joints rms = TimeRms(cut.samples, RatesAlong(cut.samples).acceleration);
    square += TimeOf(cut) * rms.squaredNorm();
  }
  return square;
}

FeedReduction ReduceFeeds(PlanResult& plan) {
  FeedReduction reduction;
  for (PassResult& pass : plan.passes) {
    for (const Piece& piece : pass.pieces) {
      const Cut cut = CutOf(pass, piece);
      const std::vector<double> feeds = ReducedFeeds(cut.samples, plan.arm.speed, plan.arm.acceleration);
      for (size_t i = 0; i < feeds.size(); ++i) {
        double& feed = pass.points[cut.points[i]].point.feed_rate;
        if (feeds[i] >= feed) continue;
        feed = feeds[i];
        ++reduction.points;
        reduction.least = reduction.least == 0 ? feed : std::min(reduction.least, feed);
      }
    }
  }
  return reduction;
}

}  // namespace millpose
