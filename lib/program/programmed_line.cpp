// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/programmed_line.hpp"

#include "base/trig.hpp"
#include "program/controller_axes.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kNoSwivel = 1e-300;  // sine below which the direction stays

/// Rotation by `angle` about the unit vector `axis`, the same bits on every machine.
Matrix3d About(const Vector3d& axis, double angle) {
  const SineCosine t = SinCos(angle);
  Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Matrix3d::Identity() + t.sin * cross + (1 - t.cos) * cross * cross;
}

/// Some unit vector across `v`.
Vector3d Across(const Vector3d& v) {
  int least = 0;
  v.cwiseAbs().minCoeff(&least);
  return v.cross(Vector3d::Unit(least)).normalized();
}

}  // namespace

ProgrammedLine::ProgrammedLine(const Pose& from, const Pose& to, const Vector3d& direction)
    : line_(from, to) {
  BySwivel by{from.linear(), Vector3d::UnitZ(), direction, 0, 0};
  const Vector3d first = from.linear() * direction, last = to.linear() * direction;
  const Vector3d normal = first.cross(last);
  by.axis = normal.norm() > kNoSwivel ? Vector3d(normal.normalized()) : Across(first);
  by.swivel = Atan2(normal.norm(), first.dot(last));
  const Matrix3d left = by.R.transpose() * About(by.axis, -by.swivel) * to.linear();
  const Vector3d side = Across(direction);
  by.turned = Atan2(direction.dot(side.cross(left * side)), side.dot(left * side));
  by_swivel_ = by;
}

ProgrammedLine::ProgrammedLine(const Vector3d& from, const Vector3d& to, AngleOrder rotation,
                               const Matrix3d& R_TC, const Vector3d& first, const Vector3d& last)
    : line_(Pose(Eigen::Translation3d(from)), Pose(Eigen::Translation3d(to))),
      by_angles_(ByAngles{rotation, R_TC.transpose(), first, last}) {}

Pose ProgrammedLine::At(double share) const {
  Pose pose = line_.At(share);
  if (by_swivel_) {
    const BySwivel& by = *by_swivel_;
    pose.linear() = About(by.axis, share * by.swivel) * by.R * About(by.own, share * by.turned);
  } else if (by_angles_) {
    const Vector3d angles = by_angles_->first + share * (by_angles_->last - by_angles_->first);
    pose.linear() = FromToolAngles(by_angles_->rotation, angles) * by_angles_->R_CT;
  }
  return pose;
}

double ProgrammedLine::angle() const {
  if (by_swivel_) return by_swivel_->swivel + std::abs(by_swivel_->turned);
  return by_angles_ ? (by_angles_->last - by_angles_->first).cwiseAbs().sum() : line_.angle();
}

double TurnDeviation(const ProgrammedLine& line, const Pose& from, const Pose& to) {
  const PoseLine even(from, to);
  double most = 0;
  for (const double share : {0.25, 0.5, 0.75})
    most = std::max(most, AngleBetween(line.At(share).linear(), even.At(share).linear()));
  return most;
}

}  // namespace millpose
