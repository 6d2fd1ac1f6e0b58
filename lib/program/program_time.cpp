// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/program_time.hpp"

#include <cassert>
#include <iterator>
#include <utility>

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/controller_axes.hpp"

namespace millpose {
namespace {

constexpr double kTurnShare = 0.5;  // of the axes' speeds, in straight motions that only turn

bool IsWay(const Motion& motion) { return motion.type == MotionType::kJoint && motion.duration == 0; }

/// The largest of what the external axes do in motion `i`, each in parts of what `part` says of it.
double LargestExternal(const MotionProgram& program, size_t i, double ExternalAxis::*part) {
  double most = 0;
  for (size_t k = 0; k < program.external_axes.size(); ++k) {
    const double way = program.motions[i].external[k] - program.motions[i - 1].external[k];
    most = std::max(most, std::abs(way) / (program.external_axes[k].*part));
  }
  return most;
}

/// s, running evenly. External axes that move along a cut are waited for.
double EvenSeconds(const MotionProgram& program, size_t i, const Arm& arm, const TimeOptions& options) {
  const Motion &from = program.motions[i - 1], &to = program.motions[i];
  if (to.duration > 0) return to.duration;
  const PoseLine line(from.X_PT, to.X_PT);
  double seconds = to.feed > 0 ? line.length() / to.feed : 0;
  if (options.orientation_speed > 0) seconds = std::max(seconds, line.angle() / options.orientation_speed);
  if (CoordinatedMotions(program, i))
    seconds = std::max(seconds, LargestExternal(program, i, &ExternalAxis::speed));
  const double turning = (*to.q - *from.q).cwiseAbs().cwiseQuotient(arm.speed).maxCoeff() / kTurnShare;
  return line.length() > 0 ? seconds : std::max(seconds, turning);
}

/// Of the way of the external axes alone.
TimeLaw ExternalLaw(const std::vector<ExternalAxis>& axes, const Motion& from, const Motion& to,
                    double speed_share) {
  static_assert(kMostExternalAxes <= 6);
  Joints delta = Joints::Zero(), speed = Joints::Ones(), acceleration = Joints::Ones();
  for (size_t k = 0; k < axes.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    delta[i] = to.external[k] - from.external[k];
    speed[i] = axes[k].speed * speed_share;
    acceleration[i] = axes[k].acceleration;
  }
  return FastestLaw(delta, speed, acceleration);
}

/// The largest change (1/s) of a joint motion's share of its way at which tip and tool are no faster than
/// they may be; infinite where nothing bounds them.
double TipRate(const Joints& from, const Joints& to, const Pose& X_FT, const Arm& arm,
               const TimeOptions& options) {
  constexpr int kParts = 16;  // the tip's speed changes little within one
  double rate = kInfinity;
  Pose before = ForwardFlange(arm, from) * X_FT;
  for (int i = 1; i <= kParts; ++i) {
    const Pose tip = ForwardFlange(arm, from + (to - from) * (static_cast<double>(i) / kParts)) * X_FT;
    const double way = (tip.translation() - before.translation()).norm() * kParts;
    const double turn = PoseLine(before, tip).angle() * kParts;
    if (options.way_tip_speed > 0 && way > 0) rate = std::min(rate, options.way_tip_speed / way);
    if (options.way_turn_speed > 0 && turn > 0) rate = std::min(rate, options.way_turn_speed / turn);
    before = tip;
  }
  return rate;
}

/// The axes' largest speeds in a joint motion between cuts.
Joints WaySpeed(const MotionProgram& program, const Joints& from, const Joints& to, const Arm& arm,
                const TimeOptions& options) {
  Joints speed = options.way_speed_share * arm.speed;
  if (options.way_tip_speed <= 0 && options.way_turn_speed <= 0) return speed;
  const double rate = TipRate(from, to, program.X_FT.value_or(Pose::Identity()), arm, options);
  if (rate == kInfinity) return speed;
  constexpr double kStanding = 1e-9;  // rad/s: an axis that stands bounds nothing
  return (rate * (to - from).cwiseAbs()).cwiseMax(kStanding).cwiseMin(speed);
}

TimeLaw LawOf(const MotionProgram& program, size_t i, const Arm& arm, const TimeOptions& options) {
  const Motion &from = program.motions[i - 1], &to = program.motions[i];
  const Joints delta = *to.q - *from.q;
  if (IsWay(to)) {
    const TimeLaw law = FastestLaw(delta, WaySpeed(program, *from.q, *to.q, arm, options), arm.acceleration);
    if (!MovesExternal(program, i)) return law;
    const TimeLaw external = ExternalLaw(program.external_axes, from, to, options.way_speed_share);
    return external.duration > law.duration ? external : law;
  }
  const double seconds = EvenSeconds(program, i, arm, options);
  if (seconds <= 0) return {};
  double ramp = (delta.cwiseAbs() / seconds).cwiseQuotient(arm.acceleration).maxCoeff();
  if (CoordinatedMotions(program, i))
    ramp = std::max(ramp, LargestExternal(program, i, &ExternalAxis::acceleration) / seconds);
  return FeedLaw(seconds, ramp, from.exact, to.exact);
}

class TrajectoryWriter {
 public:
  TrajectoryWriter(const MotionProgram& program, const Arm& arm, const Pose& X_WB,
                   const std::vector<ExternalColumn>& external)
      : program_(program), arm_(arm), X_WB_(X_WB), external_(external) {}

  std::string Write(const std::vector<TimeLaw>& laws, double step) {
    Head();
    const std::vector<double> dwells = Dwells(program_);
    double start = 0;
    long long next = 0;  // number of the next time on the grid
    for (size_t i = 0; i < laws.size(); ++i) {
      const double end = start + laws[i].duration;
      for (; static_cast<double>(next) * step < end; ++next) {
        const double time = static_cast<double>(next) * step;
        if (time > start && i > 0) Row(time, i, laws[i].Share(time - start), laws[i].Rate(time - start));
      }
      Row(end, i, 1, laws[i].Rate(laws[i].duration));
      start = end + dwells[i];
      if (dwells[i] > 0) Row(start, i, 1, 0);
      for (; static_cast<double>(next) * step <= start; ++next) continue;
    }
    return std::move(text_);
  }

 private:
  void Head() {
    text_ = "t_s,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg";
    for (const ExternalColumn& column : external_) text_ += "," + column.name;
    text_ += ",x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,speed_mm_s,pass,point\n";
  }

  void Row(double time, size_t i, double share, double rate) {
    constexpr double kNear = 1e-6;  // of the way, for the tip's speed in joint motions
    const Joints q = JointsOf(program_, arm_, i, share) * kDegPerRad;
    const ExternalPosition external = ExternalOf(program_, i, share);
    const Pose tip = TipOf(program_, arm_, i, share);
    const Pose X_WT = Base(external) * FrameAt(program_, i, share) * tip;
    const double back = std::max(0.0, share - kNear);
    const double speed = i == 0 || rate == 0
                             ? 0
                             : (tip.translation() - TipOf(program_, arm_, i, back).translation()).norm() /
                                   (share - back) * rate;
    const Eigen::Vector3d p = X_WT.translation(), abc = AnglesZyx(X_WT.linear()) * kDegPerRad;
    const auto out = std::back_inserter(text_);
    fmt::format_to(out, "{}", Fixed(time, 4));
    for (int k = 0; k < 6; ++k) fmt::format_to(out, ",{}", Fixed(q[k], 6));
    for (const ExternalColumn& column : external_)
      fmt::format_to(out, ",{}", Fixed(column.axis ? Value(*column.axis, external) : column.constant, 4));
    for (int k = 0; k < 3; ++k) fmt::format_to(out, ",{}", Fixed(p[k], 4));
    for (int k = 0; k < 3; ++k) fmt::format_to(out, ",{}", Fixed(abc[k], 6));
    const Motion& motion = program_.motions[i];
    fmt::format_to(out, ",{},{},{}\n", Fixed(speed, 4), motion.pass < 0 ? "" : fmt::format("{}", motion.pass),
                   share < 1 || motion.point < 0 ? "" : fmt::format("{}", motion.point));
  }

  Pose Base(const ExternalPosition& external) const {
    if (external.empty()) return X_WB_;
    return Mechanism(program_.external_axes).Moved(Carries::kRobot, external) * X_WB_;
  }

  /// mm or degrees.
  double Value(size_t axis, const ExternalPosition& external) const {
    const bool turns = program_.external_axes[axis].kind == AxisKind::kRotary;
    return external[axis] * (turns ? kDegPerRad : 1);
  }

  const MotionProgram& program_;
  const Arm& arm_;
  const Pose& X_WB_;
  const std::vector<ExternalColumn>& external_;
  std::string text_;
};

}  // namespace

Pose TipOf(const MotionProgram& program, const Arm& arm, size_t i, double share) {
  const Motion& motion = program.motions[i];
  if (i == 0 || share >= 1) return motion.X_PT;
  if (motion.type == MotionType::kLinear) return PoseLine(program.motions[i - 1].X_PT, motion.X_PT).At(share);
  return FrameAt(program, i, share).inverse() * ForwardFlange(arm, JointsOf(program, arm, i, share)) *
         *program.X_FT;
}

Joints JointsOf(const MotionProgram& program, const Arm& arm, size_t i, double share) {
  const Motion& motion = program.motions[i];
  if (i == 0 || share >= 1) return *motion.q;
  const Joints& from = *program.motions[i - 1].q;
  Joints even = from + share * (*motion.q - from);
  if (motion.type == MotionType::kJoint) return even;
  const Pose X_BF = FrameAt(program, i, share) * TipOf(program, arm, i, share) * program.X_FT->inverse();
  return InverseNear(arm, X_BF, Status(arm, from), even).value_or(even);
}

bool IsCut(const MotionProgram& program, size_t i) {
  if (program.motions[i].point < 0 || i == 0) return false;
  const Motion& before = program.motions[i - 1];
  return before.point >= 0 && before.pass == program.motions[i].pass && before.type == MotionType::kLinear;
}

std::vector<TimeLaw> TimeMotions(const MotionProgram& program, const Arm& arm, const TimeOptions& options) {
  std::vector<TimeLaw> laws(program.motions.size());
  for (size_t i = 1; i < laws.size(); ++i) laws[i] = LawOf(program, i, arm, options);
  return laws;
}

ProgramTime MeasureTime(const MotionProgram& program, const Arm& arm, const TimeOptions& options) {
  const std::vector<TimeLaw> laws = TimeMotions(program, arm, options);
  const std::vector<double> dwells = Dwells(program);
  ProgramTime time;
  CycleTime way;  // since the last pass
  for (size_t i = 1; i < laws.size(); ++i) {
    const Motion& motion = program.motions[i];
    CycleTime part;
    if (IsWay(motion)) {
      part.gaps = laws[i].duration;
    } else if (laws[i].duration > 0) {
      const double even = EvenSeconds(program, i, arm, options);
      (IsCut(program, i) ? part.cuts : part.approaches) = even;
      part.stops = laws[i].duration - even;
    }
    part.stops += dwells[i];
    time.all += part;
    way += part;
    if (motion.pass < 0) continue;
    const size_t pass = static_cast<size_t>(motion.pass);
    if (time.passes.size() <= pass) time.passes.resize(pass + 1);
    time.passes[pass] += std::exchange(way, {});
  }
  return time;
}

std::string TrajectoryCsv(const MotionProgram& program, const Arm& arm, const Pose& X_WB,
                          const std::vector<ExternalColumn>& external, const TimeOptions& options,
                          double seconds) {
  assert(seconds > 0 && program.X_BP && program.X_FT);
  return TrajectoryWriter(program, arm, X_WB, external).Write(TimeMotions(program, arm, options), seconds);
}

}  // namespace millpose
