// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/ros/joint_trajectory.hpp"

#include <cassert>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

using Eigen::VectorXd;

constexpr double kNanosecond = 1e-9;  // s
/// Of a cubic over a unit of time whose slope at one end is off by 1: how far it leaves the right one.
constexpr double kSlopeBulge = 4.0 / 27;

VectorXd Joined(const Joints& q, const ExternalPosition& external) {
  VectorXd all(6 + static_cast<Eigen::Index>(external.size()));
  all.head<6>() = q;
  for (size_t i = 0; i < external.size(); ++i) all[6 + static_cast<Eigen::Index>(i)] = external[i];
  return all;
}

class RunSampler {
 public:
  RunSampler(const MotionProgram& program, const Arm& arm, const TimeOptions& times, double tolerance)
      : program_(program), arm_(arm), laws_(TimeMotions(program, arm, times)), tolerance_(tolerance / 2) {}

  std::vector<TrajectoryInstant> Run() {
    const std::vector<double> dwells = Dwells(program_);
    Stretch before;
    for (size_t i = 1; i < laws_.size(); ++i) {
      if (laws_[i].duration <= 0) continue;  // nothing moves
      Stretch next = Sampled(i);
      if (before.empty()) {
        TrajectoryInstant first = next.front();
        first.rate.setZero();
        first.motion = 0, first.at_end = true;
        Emit(first);
      } else {
        Join(before, next);
        Emit(before, dwells);
      }
      before = std::move(next);
    }
    if (before.empty()) return {};
    before.back().rate.setZero();
    Emit(before, dwells);
    return std::move(run_);
  }

 private:
  /// The instants of one motion, with times from its beginning.
  using Stretch = std::vector<TrajectoryInstant>;

  VectorXd PositionAt(size_t i, double share) const {
    return Joined(JointsOf(program_, arm_, i, share), ExternalOf(program_, i, share));
  }

  /// By the share of the way.
  VectorXd Slope(size_t i, double share) const {
    if (program_.motions[i].type == MotionType::kJoint) return PositionAt(i, 1) - PositionAt(i, 0);
    constexpr double kStep = 1e-4;  // its square is what the difference is off by
    if (share < kStep)
      return (4 * PositionAt(i, share + kStep) - PositionAt(i, share + 2 * kStep) -
              3 * PositionAt(i, share)) /
             (2 * kStep);
    if (share > 1 - kStep)
      return (3 * PositionAt(i, share) - 4 * PositionAt(i, share - kStep) +
              PositionAt(i, share - 2 * kStep)) /
             (2 * kStep);
    return (PositionAt(i, share + kStep) - PositionAt(i, share - kStep)) / (2 * kStep);
  }

  TrajectoryInstant At(size_t i, double time) const {
    const TimeLaw& law = laws_[i];
    const double share = time >= law.duration ? 1 : law.Share(time);
    return {time, PositionAt(i, share), law.Rate(std::min(time, law.duration)) * Slope(i, share), i,
            share >= 1};
  }

  /// Of the tip on the part, mm.
  Eigen::Vector3d Tip(const VectorXd& position) const {
    const ExternalPosition external(position.begin() + 6, position.end());
    const Pose X_PF = BaseOnPart(program_, external) * ForwardFlange(arm_, position.head<6>());
    return X_PF * program_.X_FT->translation();
  }
  double TipWay(const VectorXd& from, const VectorXd& by) const {
    return (Tip(from + by) - Tip(from)).norm();
  }

  Stretch Sampled(size_t i) const {
    const TimeLaw& law = laws_[i];
    const double ramp = law.acceleration > 0 ? law.speed / law.acceleration : 0;
    const double rise = law.from_rest ? ramp : 0, fall = law.duration - (law.to_rest ? ramp : 0);
    Stretch stretch{At(i, 0)};
    for (const double time : {rise, fall})
      if (time - stretch.back().time > kShortest && law.duration - time > kShortest)
        Refine(i, At(i, time), stretch, 0);
    Refine(i, At(i, law.duration), stretch, 0);
    return stretch;
  }

  /// Whether the cubic between two instants of a motion is near enough to it. Looked at in two places: what
  /// it is off by may pass through 0 in one.
  bool IsNear(size_t i, const TrajectoryInstant& begin, const TrajectoryInstant& end) const {
    for (const double share : {0.4, 0.7}) {
      const double time = begin.time + share * (end.time - begin.time);
      if ((Tip(PositionBetween(begin, end, time)) - Tip(At(i, time).position)).norm() > tolerance_)
        return false;
    }
    return true;
  }

  /// Adds `end`, and before it as many instants as the tolerance asks for.
  void Refine(size_t i, const TrajectoryInstant& end, Stretch& stretch, int depth) const {
    constexpr int kDeepest = 12;
    const TrajectoryInstant begin = stretch.back();
    if (program_.motions[i].type == MotionType::kLinear && depth < kDeepest && !IsNear(i, begin, end)) {
      Refine(i, At(i, (begin.time + end.time) / 2), stretch, depth + 1);
      Refine(i, end, stretch, depth + 1);
      return;
    }
    stretch.push_back(end);
  }

  /// One rate at the corner between two motions.
  void Join(Stretch& before, Stretch& next) const {
    const VectorXd left = before.back().rate, right = next.front().rate;
    if (left == right) return;
    const VectorXd change = right - left;
    const VectorXd& corner = before.back().position;
    const double a = before.back().time - before[before.size() - 2].time, b = next[1].time;
    // The parabola through the instants on both sides.
    double share = a / (a + b);
    const auto bulge = [&](double part, double time) {
      return TipWay(corner, kSlopeBulge * part * time * change);
    };
    if (bulge(share, a) > tolerance_ || bulge(1 - share, b) > tolerance_) {
      share = 0.5;
      const double longest = std::max(a, b);
      const double reach = std::max(kShortest, longest * tolerance_ / bulge(share, longest));
      if (reach < a - kShortest)
        before.insert(before.end() - 1, At(before.back().motion, EndOf(before) - reach));
      if (reach < b - kShortest) next.insert(next.begin() + 1, At(next.front().motion, reach));
    }
    before.back().rate = next.front().rate = left + share * change;
  }
  static double EndOf(const Stretch& stretch) { return stretch.back().time; }

  void Emit(const TrajectoryInstant& instant) {
    if (run_.empty() ||
        std::llround(instant.time / kNanosecond) > std::llround(run_.back().time / kNanosecond))
      run_.push_back(instant);
  }
  void Emit(Stretch& stretch, const std::vector<double>& dwells) {
    const size_t motion = stretch.back().motion;
    if (dwells[motion] > 0) stretch.back().rate.setZero();
    for (size_t k = 1; k < stretch.size(); ++k) {
      stretch[k].time += start_;
      Emit(stretch[k]);
    }
    start_ += laws_[motion].duration;
    if (dwells[motion] <= 0) return;
    start_ += dwells[motion];
    TrajectoryInstant waited = run_.back();
    waited.time = start_;
    Emit(waited);
  }

  static constexpr double kShortest = 1e-6;  // s, between instants that are not ends of motions

  const MotionProgram& program_;
  const Arm& arm_;
  const std::vector<TimeLaw> laws_;
  const double tolerance_;  // for the curve of a motion, and as much for the corners
  std::vector<TrajectoryInstant> run_;
  double start_ = 0;
};

}  // namespace

VectorXd PositionBetween(const TrajectoryInstant& a, const TrajectoryInstant& b, double time) {
  const double length = b.time - a.time, s = (time - a.time) / length, r = 1 - s;
  return r * r * (1 + 2 * s) * a.position + s * s * (1 + 2 * r) * b.position +
         length * s * r * (r * a.rate - s * b.rate);
}

std::vector<TrajectoryInstant> SampleRun(const MotionProgram& program, const Arm& arm,
                                         const TimeOptions& times, double tolerance) {
  assert(program.X_FT && tolerance > 0);
  return RunSampler(program, arm, times, tolerance).Run();
}

RunLoads LoadsOf(const std::vector<TrajectoryInstant>& run, const Arm& arm,
                 const std::vector<ExternalAxis>& axes) {
  RunLoads loads;
  if (run.empty()) return loads;
  VectorXd speed(run.front().rate.size()), acceleration(speed.size());
  speed.head<6>() = arm.speed, acceleration.head<6>() = arm.acceleration;
  for (size_t i = 0; i < axes.size(); ++i)
    speed[6 + static_cast<Eigen::Index>(i)] = axes[i].speed,
              acceleration[6 + static_cast<Eigen::Index>(i)] = axes[i].acceleration;
  const auto take = [](const VectorXd& shares, size_t at, AxisLoad& load) {
    Eigen::Index axis = 0;
    const double most = shares.maxCoeff(&axis);
    if (most > load.share) load = {most, static_cast<size_t>(axis), at};
  };
  for (size_t i = 0; i < run.size(); ++i) {
    take(run[i].rate.cwiseAbs().cwiseQuotient(speed), i, loads.speed);
    if (i == 0) continue;
    const double time = run[i].time - run[i - 1].time;
    const VectorXd even = (run[i].position - run[i - 1].position) / time;
    const VectorXd first = (6 * even - 4 * run[i - 1].rate - 2 * run[i].rate) / time,
                   last = (2 * run[i - 1].rate + 4 * run[i].rate - 6 * even) / time;
    take(first.cwiseAbs().cwiseMax(last.cwiseAbs()).cwiseQuotient(acceleration), i, loads.acceleration);
  }
  return loads;
}

namespace {

std::string Where(const TrajectoryInstant& at, const MotionProgram& program) {
  const Motion& motion = program.motions[at.motion];
  if (motion.pass < 0) return fmt::format("after {:.3f} s, on the way home", at.time);
  return fmt::format("after {:.3f} s, {} pass {}", at.time, motion.point < 0 ? "on the way to or from" : "in",
                     motion.pass);
}

/// What is wrong with one axis at an instant; empty for nothing.
std::string AxisProblem(double position, double rate, const std::string& name, double lower, double upper,
                        double speed, double unit, const char* word) {
  constexpr double kRounding = 1e-9, kRatesRounding = 1e-6;
  if (position < lower - kRounding || position > upper + kRounding)
    return fmt::format("{} stands at {:.4f} {}; allowed: {:.4f} to {:.4f}", name, unit * position, word,
                       unit * lower, unit * upper);
  if (std::abs(rate) > speed * (1 + kRatesRounding))
    return fmt::format("{} would have to go at {:.3f} {}/s; allowed: {:.3f}", name, unit * std::abs(rate),
                       word, unit * speed);
  return {};
}

}  // namespace

std::vector<std::string> BeyondLimits(const std::vector<TrajectoryInstant>& run, const MotionProgram& program,
                                      const Arm& arm) {
  std::vector<std::string> problems;
  const size_t axes = 6 + program.external_axes.size();
  std::vector<char> told(axes + arm.coupled_limits.size(), 0);
  const auto tell = [&](size_t what, const std::string& problem, const TrajectoryInstant& at) {
    if (problem.empty() || told[what]) return;
    told[what] = 1;
    problems.push_back(fmt::format("{}: {}", Where(at, program), problem));
  };
  for (const TrajectoryInstant& at : run) {
    for (size_t k = 0; k < axes; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      if (k < 6) {
        tell(k,
             AxisProblem(at.position[i], at.rate[i], fmt::format("A{}", k + 1), arm.lower[i], arm.upper[i],
                         arm.speed[i], kDegPerRad, "deg"),
             at);
        continue;
      }
      const ExternalAxis& axis = program.external_axes[k - 6];
      const bool turns = axis.kind == AxisKind::kRotary;
      tell(k,
           AxisProblem(at.position[i], at.rate[i], axis.name, axis.lower, axis.upper, axis.speed,
                       turns ? kDegPerRad : 1, turns ? "deg" : "mm"),
           at);
    }
    for (size_t k = 0; k < arm.coupled_limits.size(); ++k)
      if (arm.coupled_limits[k].Beyond(at.position.head<6>()) > 1e-9)
        tell(axes + k, CoupledText(arm.coupled_limits[k], at.position.head<6>()), at);
  }
  return problems;
}

}  // namespace millpose
