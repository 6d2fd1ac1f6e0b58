// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/line.hpp"

#include "base/rotation.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "machine/robot/compose.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

constexpr double kNoTurn = 1e-300;  // sine of half an angle below which there is no axis

/// What is wrong with a sample that follows `previous`; empty when nothing.
std::string SampleProblem(const Joints& q, const Joints& previous, const Joints& lower, const Joints& upper,
                          double joint_jump) {
  for (int i = 0; i < 6; ++i) {
    if (std::abs(q[i] - previous[i]) > joint_jump) {
      return fmt::format("A{} would have to turn by {:.1f}° at once near a singularity", i + 1,
                         RadToDeg(std::abs(q[i] - previous[i])));
    }
    if (q[i] < lower[i] || q[i] > upper[i]) {
      return fmt::format("A{} = {:.3f}° is outside {:.3f}°…{:.3f}°", i + 1, RadToDeg(q[i]),
                         RadToDeg(lower[i]), RadToDeg(upper[i]));
    }
  }
  return {};
}

}  // namespace

PoseLine::PoseLine(const Pose& from, const Pose& to)
    : from_(from.translation()), to_(to.translation()), R_(from.linear()) {
  Eigen::Quaterniond turn(Eigen::Matrix3d(from.linear().transpose() * to.linear()));
  if (turn.w() < 0) turn.coeffs() *= -1;
  const double sine = turn.vec().norm();  // of half the angle; half a turn has 1
  if (sine < kNoTurn) return;
  axis_ = turn.vec() / sine;
  angle_ = 2 * Atan2(sine, turn.w());
}

Pose PoseLine::At(double share) const {
  Pose pose = Pose::Identity();
  pose.linear() = R_ * RotationAbout(axis_, share * angle_);
  pose.translation() = from_ + share * (to_ - from_);
  return pose;
}

double AngleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Matrix3d R = a.transpose() * b;
  const Eigen::Vector3d twice_axis_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return Atan2(twice_axis_sine.norm(), R.trace() - 1);
}

Pose Carrier::ToolPose(const Joints& q, double share) const {
  return Compose(Compose(BasePose(share), ForwardFlange(arm, q)), X_FT);
}

Pose Carrier::FlangePose(const Pose& X_WT, double share) const {
  return Compose(Compose(BasePose(share).inverse(Eigen::Isometry), X_WT), X_FT.inverse(Eigen::Isometry));
}

LineMotion FollowLine(const Carrier& carrier, const Joints& q, const Pose& X_WT_end, const Joints& lower,
                      const Joints& upper, const LineSteps& steps) {
  const Pose X_WT_start = carrier.ToolPose(q);
  const PoseLine line(X_WT_start, X_WT_end);
  const double length = line.length();
  const int count = std::max({1, static_cast<int>(std::ceil(length / steps.distance)),
                              static_cast<int>(std::ceil(line.angle() / steps.angle))});
  const int branch = Status(carrier.arm, q);
  LineMotion motion{{q}, {}};
  for (int i = 1; i <= count; ++i) {
    const double share = static_cast<double>(i) / count;
    const Pose X_BF = carrier.FlangePose(line.At(share), share);
    const std::optional<Joints> next = InverseNear(carrier.arm, X_BF, branch, motion.joints.back());
    const std::string problem =
        next ? SampleProblem(*next, motion.joints.back(), lower, upper, steps.joint_jump)
             : std::string("out of reach");
    if (!problem.empty()) {
      motion.problem = fmt::format("{:.1f} mm along the straight motion of {:.1f} mm: {}", share * length,
                                   length, problem);
      return motion;
    }
    motion.joints.push_back(*next);
  }
  return motion;
}

std::optional<Joints> OnLine(const Carrier& carrier, const Joints& q0, const Joints& q1, double share) {
  const Pose X_WT = PoseLine(carrier.ToolPose(q0), carrier.ToolPose(q1, 1)).At(share);
  return InverseNear(carrier.arm, carrier.FlangePose(X_WT, share), Status(carrier.arm, q0),
                     q0 + share * (q1 - q0));
}

std::optional<Joints> JointDeviation(const Carrier& carrier, const Joints& q0, const Joints& q1) {
  constexpr double kBetween = 1.25;
  Joints most = Joints::Zero();
  for (const double share : {0.25, 0.5, 0.75}) {
    const std::optional<Joints> q = OnLine(carrier, q0, q1, share);
    if (!q) return std::nullopt;
    most = most.cwiseMax((*q - q0 - share * (q1 - q0)).cwiseAbs());
  }
  return kBetween * most;
}

Deviation HalfwayDeviation(const Carrier& carrier, const Joints& q0, const Joints& q1) {
  const Pose commanded = PoseLine(carrier.ToolPose(q0), carrier.ToolPose(q1, 1)).At(0.5);
  const Pose real = carrier.ToolPose(0.5 * (q0 + q1), 0.5);
  const Eigen::Vector3d a = commanded.linear().col(2), b = real.linear().col(2);
  return {(real.translation() - commanded.translation()).norm(), Atan2(a.cross(b).norm(), a.dot(b))};
}

}  // namespace millpose
