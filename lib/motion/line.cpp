// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/line.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"
#include "robot/kinematics.hpp"

namespace millpose {
namespace {

/// Rotation as a unit axis and an angle of 0..π.
struct AxisAngle {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double angle = 0;
};

AxisAngle ToAxisAngle(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond quaternion(R);
  const double sign = quaternion.w() < 0 ? -1 : 1, length = quaternion.vec().norm();
  if (length < 1e-300) return {};
  return {sign * quaternion.vec() / length, 2 * Atan2(length, sign * quaternion.w())};
}

/// Rodrigues' formula, with sine and cosine that are the same on every machine.
Eigen::Matrix3d RotationAbout(const Eigen::Vector3d& axis, double angle) {
  const SineCosine t = SinCos(angle);
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Eigen::Matrix3d::Identity() + t.sin * cross + (1 - t.cos) * cross * cross;
}

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

Pose InterpolateLine(const Pose& from, const Pose& to, double share) {
  const AxisAngle turn = ToAxisAngle(from.linear().transpose() * to.linear());
  Pose X = Pose::Identity();
  X.linear() = from.linear() * RotationAbout(turn.axis, share * turn.angle);
  X.translation() = from.translation() + share * (to.translation() - from.translation());
  return X;
}

double AngleBetween(const Pose& a, const Pose& b) {
  return ToAxisAngle(a.linear().transpose() * b.linear()).angle;
}

Pose Carrier::ToolPose(const Joints& q) const { return X_WB * ForwardFlange(arm, q) * X_FT; }

Pose Carrier::FlangePose(const Pose& X_WT) const {
  return X_WB.inverse(Eigen::Isometry) * X_WT * X_FT.inverse(Eigen::Isometry);
}

LineMotion FollowLine(const Carrier& carrier, const Joints& q, const Pose& X_WT_end, const Joints& lower,
                      const Joints& upper, const LineSteps& steps) {
  const Pose X_WT_start = carrier.ToolPose(q);
  const double length = (X_WT_end.translation() - X_WT_start.translation()).norm();
  const double angle = AngleBetween(X_WT_start, X_WT_end);
  const int count = std::max({1, static_cast<int>(std::ceil(length / steps.distance)),
                              static_cast<int>(std::ceil(angle / steps.angle))});
  const int branch = Status(carrier.arm, q);
  LineMotion motion{{q}, {}};
  for (int i = 1; i <= count; ++i) {
    const double share = static_cast<double>(i) / count;
    const Pose X_BF = carrier.FlangePose(InterpolateLine(X_WT_start, X_WT_end, share));
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
  const Pose X_WT = InterpolateLine(carrier.ToolPose(q0), carrier.ToolPose(q1), share);
  return InverseNear(carrier.arm, carrier.FlangePose(X_WT), Status(carrier.arm, q0), q0 + share * (q1 - q0));
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
  const Pose commanded = InterpolateLine(carrier.ToolPose(q0), carrier.ToolPose(q1), 0.5);
  const Pose real = carrier.ToolPose(0.5 * (q0 + q1));
  const Eigen::Vector3d a = commanded.linear().col(2), b = real.linear().col(2);
  return {(real.translation() - commanded.translation()).norm(), Atan2(a.cross(b).norm(), a.dot(b))};
}

}  // namespace millpose
