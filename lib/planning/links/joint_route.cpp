// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/links/joint_route.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "machine/motion/time_law.hpp"

namespace millpose {
namespace {

namespace ob = ompl::base;

/// Joints are planned in these multiples of a radian: what moves more of the arm counts more.
const Joints kWeights = (Joints() << 1, 1, 1, 0.4, 0.4, 0.2).finished();
/// Longest motion that RRTConnect adds at once, in weighted radians.
constexpr double kRange = 0.5;
/// Share of samples near the two ends rather than anywhere within the limits, and what near means.
constexpr double kNearShare = 0.7;
const double kNear = DegToRad(60);
constexpr int kShortcuts = 200, kVain = 40;  // tries; in a row without a gain

Joints ToJoints(const ob::State* state) {
  const double* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return Eigen::Map<const Joints>(values).cwiseQuotient(kWeights);
}

void FromJoints(const Joints& q, ob::State* state) {
  double* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  Eigen::Map<Joints>(values, 6) = q.cwiseProduct(kWeights);
}

/// Checks poses and motions and counts what was in the way.
class Judge {
 public:
  Judge(const World& world, const RouteOptions& options)
      : checker_(world, options.clearance_share), options_(options) {}

  bool Valid(const Joints& q) {
    if ((q.array() < options_.limits.lower.array() - 1e-12).any()) return false;
    if ((q.array() > options_.limits.upper.array() + 1e-12).any()) return false;
    // Of a straight motion in the joints between two poses that keep it every pose does.
    if (FirstBeyond(options_.limits.coupled, q, 1e-12) != nullptr) return false;
    return Count(checker_.Blocked(q, Phase::kFree));
  }
  /// The motion to `to`, with `to` itself, from a valid pose.
  bool ValidMotion(const Joints& from, const Joints& to) {
    return Valid(to) && Count(checker_.BlockedBetween(from, to, Phase::kFree, options_.resolution));
  }
  long long poses_checked() const { return checker_.poses_checked(); }
  /// The pairs found most often, for the report of a gap that cannot be planned.
  std::string Blockers() {
    struct Met {
      int count = 0;
      double nearest = 0;  // mm
    };
    std::map<std::string, Met> blocked;
    for (const ContactCandidate& sighting : sightings_) {
      const Interference found = checker_.Measure(sighting);
      Met& met = blocked[fmt::format("{} and {}", found.first, found.second)];
      met.nearest = met.count++ == 0 ? found.distance : std::min(met.nearest, found.distance);
    }
    std::vector<std::pair<int, std::string>> sorted;
    for (const auto& [pair, met] : blocked) sorted.emplace_back(-met.count, pair);
    std::sort(sorted.begin(), sorted.end());
    std::string text;
    for (size_t i = 0; i < std::min<size_t>(3, sorted.size()); ++i) {
      const double nearest = blocked.at(sorted[i].second).nearest;
      text += fmt::format(
          "{}{} ({} times, {})", i ? ", " : "", sorted[i].second, -sorted[i].first,
          nearest > 0 ? fmt::format("{:.1f} mm apart at the nearest", nearest) : std::string("touching"));
    }
    return text;
  }

 private:
  bool Count(const std::optional<ContactCandidate>& found) {
    if (found) sightings_.push_back(*found);
    return !found;
  }
  Checker checker_;
  const RouteOptions& options_;
  std::vector<ContactCandidate> sightings_;
};

/// OMPL's own samplers draw from a process-wide generator of seeds; this one from the gap's own stream, so
/// that gaps planned in parallel do not depend on each other.
class StreamSampler : public ob::StateSampler {
 public:
  StreamSampler(const ob::StateSpace* space, RandomStream& random, const RouteOptions& options,
                const Joints& from, const Joints& to)
      : StateSampler(space), random_(random), options_(options) {
    near_lower_ = (from.cwiseMin(to).array() - kNear).matrix().cwiseMax(options.limits.lower);
    near_upper_ = (from.cwiseMax(to).array() + kNear).matrix().cwiseMin(options.limits.upper);
  }
  void sampleUniform(ob::State* state) override {
    const bool near = random_.Uniform() < kNearShare;
    const Joints &lower = near ? near_lower_ : options_.limits.lower,
                 &upper = near ? near_upper_ : options_.limits.upper;
    Joints q;
    for (int i = 0; i < 6; ++i) q[i] = random_.Uniform(lower[i], upper[i]);
    FromJoints(q, state);
  }
  void sampleUniformNear(ob::State*, const ob::State*, double) override {
    assert(false && "RRTConnect samples uniformly");
  }
  void sampleGaussian(ob::State*, const ob::State*, double) override {
    assert(false && "RRTConnect samples uniformly");
  }

 private:
  RandomStream& random_;
  const RouteOptions& options_;
  Joints near_lower_, near_upper_;
};

class SweptValidator : public ob::MotionValidator {
 public:
  SweptValidator(const ob::SpaceInformationPtr& space, Judge& judge)
      : MotionValidator(space), judge_(judge) {}
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return judge_.ValidMotion(ToJoints(from), ToJoints(to));
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    last_valid.second = 0;
    return checkMotion(from, to);
  }

 private:
  Judge& judge_;
};

/// RRTConnect from one pose to another; empty when its iterations are used up.
std::vector<Joints> Connect(Judge& judge, const Joints& from, const Joints& to, const RouteOptions& options,
                            RandomStream& random) {
  static const bool silenced = (ompl::msg::setLogLevel(ompl::msg::LOG_NONE), true);
  (void)silenced;
  auto space = std::make_shared<ob::RealVectorStateSpace>(6);
  ob::RealVectorBounds bounds(6);
  for (int i = 0; i < 6; ++i) {
    bounds.setLow(static_cast<unsigned>(i), options.limits.lower[i] * kWeights[i]);
    bounds.setHigh(static_cast<unsigned>(i), options.limits.upper[i] * kWeights[i]);
  }
  space->setBounds(bounds);
  space->setStateSamplerAllocator(
      [&](const ob::StateSpace* s) { return std::make_shared<StreamSampler>(s, random, options, from, to); });
  auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker([&](const ob::State* state) { return judge.Valid(ToJoints(state)); });
  information->setMotionValidator(std::make_shared<SweptValidator>(information, judge));
  information->setup();
  auto problem = std::make_shared<ob::ProblemDefinition>(information);
  ob::ScopedState<> start(space), goal(space);
  FromJoints(from, start.get());
  FromJoints(to, goal.get());
  problem->setStartAndGoalStates(start, goal);
  ompl::geometric::RRTConnect planner(information);
  planner.setRange(kRange);
  planner.setNearestNeighbors<ompl::NearestNeighborsLinear>();  // the default draws random pivots
  planner.setProblemDefinition(problem);
  planner.setup();
  int looks = 0;
  const ob::PlannerTerminationCondition done(
      [&] { return ++looks > options.max_iterations || options.stop.stop_requested(); });
  const ob::PlannerStatus status = planner.solve(done);
  CheckStop(options.stop);
  if (status != ob::PlannerStatus::EXACT_SOLUTION) return {};
  std::vector<Joints> corners;
  for (const ob::State* state :
       problem->getSolutionPath()->as<ompl::geometric::PathGeometric>()->getStates()) {
    corners.push_back(ToJoints(state));
  }
  corners.front() = from;  // without the rounding of the weights
  corners.back() = to;
  return corners;
}

double Duration(const World& world, const std::vector<Joints>& corners, const RouteOptions& options) {
  const Arm& arm = world.cell().arm;
  return PathDuration(corners, options.speed_share * arm.speed, options.speed_share * arm.acceleration);
}

/// Drops corners and cuts them short wherever that saves time and touches nothing.
void Shorten(Judge& judge, const World& world, const RouteOptions& options, RandomStream& random,
             std::vector<Joints>& corners) {
  double duration = Duration(world, corners, options);
  for (int trial = 0, vain = 0; trial < kShortcuts && vain < kVain && corners.size() > 2; ++trial) {
    CheckStop(options.stop);
    ++vain;
    // First every single corner is tried, then random cuts.
    const int segments = static_cast<int>(corners.size()) - 1;
    int i = random.Below(segments), j = random.Below(segments);
    if (i > j) std::swap(i, j);
    const bool drop = trial < segments;
    const double s = drop ? 0 : random.Uniform(), t = drop ? 1 : random.Uniform();
    if (drop) i = trial, j = std::min(trial + 1, segments - 1);
    if (i == j) continue;
    const Joints from = corners[i] + s * (corners[i + 1] - corners[i]);
    const Joints to = corners[j] + t * (corners[j + 1] - corners[j]);
    std::vector<Joints> shorter(corners.begin(), corners.begin() + i + 1);
    if (s > 0) shorter.push_back(from);
    if (t < 1) shorter.push_back(to);
    shorter.insert(shorter.end(), corners.begin() + j + 1, corners.end());
    const double time = Duration(world, shorter, options);
    if (time >= duration || !judge.Valid(from) || !judge.ValidMotion(from, to)) continue;
    corners = std::move(shorter);
    duration = time;
    vain = 0;
  }
}

/// The whole route again, motion by motion: the corners of shortcuts were joined from checked parts.
bool Recheck(Judge& judge, const std::vector<Joints>& corners) {
  if (!judge.Valid(corners.front())) return false;
  for (size_t i = 1; i < corners.size(); ++i) {
    if (!judge.ValidMotion(corners[i - 1], corners[i])) return false;
  }
  return true;
}

}  // namespace

JointRoute FindRoute(const World& world, const Joints& from, const Joints& to, const RouteOptions& options,
                     RandomStream random) {
  Judge judge(world, options), fresh(world, options);
  JointRoute route;
  const auto done = [&](std::vector<Joints> corners, std::string problem) {
    route.corners = std::move(corners);
    route.problem = std::move(problem);
    route.poses_checked = judge.poses_checked() + fresh.poses_checked();
    return route;
  };
  if (!judge.Valid(from)) return done({}, fmt::format("the start is blocked: {}", judge.Blockers()));
  if (!judge.Valid(to)) return done({}, fmt::format("the goal is blocked: {}", judge.Blockers()));
  if (judge.ValidMotion(from, to)) return done({from, to}, {});
  std::vector<Joints> corners = Connect(judge, from, to, options, random);
  if (corners.empty()) {
    return done({}, fmt::format("no path found in {} iterations; most often in the way: {}",
                                options.max_iterations, judge.Blockers()));
  }
  const std::vector<Joints> unshortened = corners;
  Shorten(judge, world, options, random, corners);
  if (Recheck(fresh, corners)) return done(corners, {});
  if (Recheck(fresh, unshortened)) return done(unshortened, {});
  return done({}, fmt::format("the path found did not pass its re-check: {}", fresh.Blockers()));
}

}  // namespace millpose
