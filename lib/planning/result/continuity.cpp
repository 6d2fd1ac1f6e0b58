// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/continuity.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "base/units.hpp"
#include "machine/motion/cut_feed.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

/// The samples of a piece; a closed one ends with its first point again.
struct Cut {
  std::vector<CutSample> samples;
  std::vector<int> points;  ///< of each sample, into PassResult::points
};

/// The external axes where they move along; where they stand nothing follows from them.
Eigen::Vector3d AlongOf(const PlannedPoint& point) {
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (size_t k = 0; point.external && k < point.external->size(); ++k)
    along[static_cast<Eigen::Index>(k)] = (*point.external)[k];
  return along;
}

Cut CutOf(const PassResult& pass, const Segment& piece) {
  constexpr double kSamePlace = 1e-9;  // mm
  Cut cut;
  for (int i = piece.first; i <= piece.last; ++i) {
    const PlannedPoint& point = pass.points[i];
    const CutSample sample{point.q, point.point.arc_length, point.point.feed_rate, AlongOf(point)};
    if (!cut.samples.empty() && sample.arc_length < cut.samples.back().arc_length + kSamePlace) continue;
    cut.samples.push_back(sample);
    cut.points.push_back(i);
  }
  if (piece.closed && cut.samples.size() > 1) {
    const PlannedPoint &first = pass.points[piece.first], &last = pass.points[piece.last];
    const double way = (first.point.position - last.point.position).norm();
    if (way > kSamePlace) {
      const Joints q = NearestEquivalent(last.q, first.q);
      cut.samples.push_back({q, cut.samples.back().arc_length + way, first.point.feed_rate, AlongOf(first)});
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

/// What carries the tool along the cuts of a pass.
class Carriers {
 public:
  Carriers(const PlanResult& plan, const PassResult& pass)
      : plan_(plan), pass_(pass), standing_{plan.arm, BaseAt(plan, pass.external), plan.X_FT} {}

  /// From one sample of a cut to the next, `end`.
  Carrier To(const Cut& cut, size_t end) const {
    const auto external = [&](size_t i) { return ExternalAt(pass_, static_cast<size_t>(cut.points[i])); };
    const PlannedPoint& point = pass_.points[static_cast<size_t>(cut.points[end])];
    if (!point.external || external(end - 1) == external(end)) {
      if (!point.external) return standing_;
      return {plan_.arm, BaseAt(plan_, *point.external), plan_.X_FT};
    }
    return {plan_.arm, plan_.X_WB, plan_.X_FT,
            std::make_shared<const CoordinatedMotion>(CoordinatedMotion{
                Mechanism(plan_.external_axes), plan_.X_WB, plan_.X_WP, external(end - 1), external(end)})};
  }

 private:
  const PlanResult& plan_;
  const PassResult& pass_;
  Carrier standing_;
};

/// `share`: of the speeds of the external axes.
ExternalBounds BoundsOf(const PlanResult& plan, double share) {
  ExternalBounds bounds;
  for (size_t k = 0; k < plan.external_axes.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    bounds.speed[i] = share * plan.external_axes[k].speed;
    bounds.acceleration[i] = plan.external_axes[k].acceleration;
  }
  return bounds;
}

void AddCut(const Cut& cut, const Arm& arm, const Carriers& carriers, ContinuityFigures& figures,
            SquareSum& squares) {
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
    const Deviation deviation = HalfwayDeviation(carriers.To(cut, i), cut.samples[i - 1].q, q);
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
    const Carriers carriers(plan, pass);
    for (const Segment& piece : pass.pieces) {
      const Cut cut = CutOf(pass, piece);
      AddCut(cut, plan.arm, carriers, figures, squares);
      for (const FeedShortfall& s :
           FindShortfalls(cut.samples, plan.arm.speed, plan.arm.acceleration, BoundsOf(plan, 1))) {
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
  for (const Segment& piece : pass.pieces) {
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
/// The same of external axes, which go evenly from point to point whatever the joints do.
constexpr double kExternalSpeedUsed = 0.99;

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

/// The feed at which an external axis uses as much of its speed as it may, and which: 6 and on.
std::pair<double, int> ExternalCap(const CutSample& from, const CutSample& to, const ExternalBounds& bounds) {
  int axis = 0;
  const double worst = (to.external - from.external).cwiseAbs().cwiseQuotient(bounds.speed).maxCoeff(&axis);
  const double length = to.arc_length - from.arc_length;
  return {worst > 0 ? length / worst : std::numeric_limits<double>::infinity(), 6 + axis};
}

/// The limits of a cut's samples by themselves; lowers their feeds to what straight motions allow.
std::vector<Limit> CapFeeds(Cut& cut, const Arm& arm, const Carriers& carriers,
                            const ExternalBounds& bounds) {
  std::vector<Limit> limits(cut.samples.size());
  for (const FeedShortfall& s :
       FindShortfalls(cut.samples, kJointSpeedUsed * arm.speed, arm.acceleration, bounds))
    limits[s.sample] = {s.joint, s.by_acceleration, s.feed_possible};
  for (size_t i = 1; i < cut.samples.size(); ++i) {
    auto [cap, joint] = StraightCap(cut.samples[i - 1], cut.samples[i], carriers.To(cut, i));
    const auto [external, axis] = ExternalCap(cut.samples[i - 1], cut.samples[i], bounds);
    if (external < cap) cap = external, joint = axis;
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

std::string AxisName(const std::vector<ExternalAxis>& external, int axis) {
  return axis < 6 ? fmt::format("A{}", axis + 1) : external.at(static_cast<size_t>(axis - 6)).name;
}

FeedReduction ReduceFeeds(PlanResult& plan) {
  FeedReduction reduction;
  const ExternalBounds bounds = BoundsOf(plan, kExternalSpeedUsed);
  size_t first_point = 0;
  for (PassResult& pass : plan.passes) {
    const Carriers carriers(plan, pass);
    for (const Segment& piece : pass.pieces) {
      Cut cut = CutOf(pass, piece);
      std::vector<double> wanted;
      for (const CutSample& sample : cut.samples) wanted.push_back(sample.feed);
      const std::vector<Limit> limits = CapFeeds(cut, plan.arm, carriers, bounds);
      const std::vector<double> feeds =
          ReducedFeeds(cut.samples, kJointSpeedUsed * plan.arm.speed, plan.arm.acceleration, bounds);
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
