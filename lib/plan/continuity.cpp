// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/continuity.hpp"

#include <limits>
#include <utility>

#include "base/units.hpp"
#include "motion/cut_feed.hpp"
#include "motion/line.hpp"
#include "plan/station.hpp"
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
      const Joints q = NearestEquivalent(last.q, first.q);
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
  ContinuityFigures figures;
  SquareSum squares;
  size_t first_point = 0;
  for (const PassResult& pass : plan.passes) {
    const Carrier carrier{plan.arm, BaseAt(plan, pass.external), plan.X_FT};
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

namespace {

/// Share of a joint's largest speed that a reduced feed uses: verification, which allows all of it, follows
/// the motions of the program, and these leave out points.
constexpr double kJointSpeedUsed = 0.95;

/// The feed, mm/s, at which the straight motion from one sample to the next uses kJointSpeedUsed of a joint's
/// speed; the second value is that joint. Straight motions far from the limits are not followed.
std::pair<double, int> StraightCap(const CutSample& from, const CutSample& to, const Carrier& carrier) {
  constexpr double kFar = 0.5;  // of the limit, by the chord: within it no motion between is twice as fast
  const double length = to.arc_length - from.arc_length;
  const auto share = [&](const Joints& a, const Joints& b, double way, int* joint) {
    return ((b - a).cwiseAbs().cwiseQuotient(carrier.arm.speed)).maxCoeff(joint) / way;
  };
  int joint = 0;
  double worst = share(from.q, to.q, length, &joint);
  if (worst * to.feed > kFar) {
    const Pose X_WT = carrier.ToolPose(to.q);
    const LineMotion line =
        FollowLine(carrier, from.q, X_WT, Joints::Constant(-1e9), Joints::Constant(1e9), {0.1, 0.0017, 10});
    const double step = length / std::max<double>(1, static_cast<double>(line.joints.size()) - 1);
    for (size_t k = 1; k < line.joints.size() && line.problem.empty(); ++k) {
      int at = 0;
      const double here = share(line.joints[k - 1], line.joints[k], step, &at);
      if (here > worst) worst = here, joint = at;
    }
  }
  return {worst > 0 ? kJointSpeedUsed / worst : std::numeric_limits<double>::infinity(), joint};
}

/// What limits each sample's feed at most.
struct Limit {
  int joint = 0;
  bool by_acceleration = false;
  double feed = std::numeric_limits<double>::infinity();  // mm/s, possible
};

/// The limits of a cut's samples by themselves; lowers their feeds to what straight motions allow.
std::vector<Limit> CapFeeds(Cut& cut, const Carrier& carrier) {
  std::vector<Limit> limits(cut.samples.size());
  for (const FeedShortfall& s :
       FindShortfalls(cut.samples, kJointSpeedUsed * carrier.arm.speed, carrier.arm.acceleration))
    limits[s.sample] = {s.joint, s.by_acceleration, s.feed_possible};
  for (size_t i = 1; i < cut.samples.size(); ++i) {
    const auto [cap, joint] = StraightCap(cut.samples[i - 1], cut.samples[i], carrier);
    if (cap < limits[i].feed) limits[i] = {joint, false, cap};
    cut.samples[i].feed = std::min(cut.samples[i].feed, cap);
  }
  return limits;
}

/// The stretches of a cut whose feeds are now below kSlowShare of `wanted`.
void AddSlow(const Cut& cut, const std::vector<double>& wanted, const std::vector<double>& feeds,
             const std::vector<Limit>& limits, SlowStretch stretch, size_t first_point,
             std::vector<SlowStretch>& slow) {
  bool open = false;
  double tightest = 0;
  for (size_t i = 0; i < feeds.size(); ++i) {
    if (feeds[i] >= kSlowShare * wanted[i]) {
      open = false;
      continue;
    }
    const size_t point = first_point + static_cast<size_t>(cut.points[i]);
    if (!std::exchange(open, true)) {
      stretch.first = point;
      stretch.feed = std::numeric_limits<double>::infinity();
      tightest = std::numeric_limits<double>::infinity();
      slow.push_back(stretch);
    }
    SlowStretch& now = slow.back();
    now.last = point;
    if (feeds[i] < now.feed) now.feed = feeds[i], now.wanted = wanted[i];
    if (limits[i].feed < tightest) {
      tightest = limits[i].feed;
      now.joint = limits[i].joint;
      now.by_acceleration = limits[i].by_acceleration;
    }
  }
}

}  // namespace

FeedReduction ReduceFeeds(PlanResult& plan) {
  FeedReduction reduction;
  size_t first_point = 0;
  for (PassResult& pass : plan.passes) {
    const Carrier carrier{plan.arm, BaseAt(plan, pass.external), plan.X_FT};
    for (const Piece& piece : pass.pieces) {
      Cut cut = CutOf(pass, piece);
      std::vector<double> wanted;
      for (const CutSample& sample : cut.samples) wanted.push_back(sample.feed);
      const std::vector<Limit> limits = CapFeeds(cut, carrier);
      const std::vector<double> feeds =
          ReducedFeeds(cut.samples, kJointSpeedUsed * plan.arm.speed, plan.arm.acceleration);
      AddSlow(cut, wanted, feeds, limits, {pass.pass}, first_point, reduction.slow);
      for (size_t i = 0; i < feeds.size(); ++i) {
        double& feed = pass.points[cut.points[i]].point.feed_rate;
        if (feeds[i] >= feed) continue;
        feed = feeds[i];
        ++reduction.points;
        reduction.least = reduction.least == 0 ? feed : std::min(reduction.least, feed);
      }
    }
    first_point += pass.points.size();
  }
  return reduction;
}

}  // namespace millpose
