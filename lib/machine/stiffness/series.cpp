// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/series.hpp"

#include <cassert>

#include "machine/robot/angles.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d Skew(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

constexpr double kNewton = 1e-3;  // N per kg·mm/s²

}  // namespace

std::vector<SeriesCompliance> ExternalCompliances(const Mechanism& mechanism,
                                                  const ExternalPosition& external, const Pose& X_WB) {
  std::vector<SeriesCompliance> elements;
  const Pose X_BW = X_WB.inverse(Eigen::Isometry);
  for (size_t i = 0; i < mechanism.axes().size(); ++i) {
    const ExternalAxis& axis = mechanism.axes()[i];
    if (!axis.compliance) continue;
    const auto [direction, origin] = mechanism.LineOf(i, external);
    SeriesCompliance& element = elements.emplace_back();
    element.name = axis.name;
    element.X_LK.translation() = X_BW * origin;
    const Vector3d along = X_BW.linear() * direction;
    const Eigen::Index block = axis.kind == AxisKind::kLinear ? 0 : 3;
    element.C.block<3, 3>(block, block) = *axis.compliance * along * along.transpose();
  }
  return elements;
}

Matrix6 ComplianceAt(const SeriesCompliance& element, const Vector3d& point) {
  const Pose& X = element.X_LK;
  Matrix6 adjoint = Matrix6::Zero();
  adjoint.topLeftCorner<3, 3>() = X.linear();
  adjoint.topRightCorner<3, 3>() = -Skew(point - X.translation()) * X.linear();
  adjoint.bottomRightCorner<3, 3>() = X.linear();
  return adjoint * element.C * adjoint.transpose();
}

Matrix6 SeriesComplianceAt(const Arm& arm, const Joints& q, const Vector3d& p_FT,
                           const std::vector<SeriesCompliance>& elements) {
  return SeriesComplianceAt(LinkFrames(arm, q), p_FT, elements);
}

Matrix6 SeriesComplianceAt(const LinkPoses& frames, const Vector3d& p_FT,
                           const std::vector<SeriesCompliance>& elements) {
  const Vector3d point = frames[6] * p_FT;
  Matrix6 sum = Matrix6::Zero();
  for (SeriesCompliance element : elements) {
    assert(element.link >= 0 && element.link <= 6);
    element.X_LK = frames[static_cast<size_t>(element.link)] * element.X_LK;
    sum += ComplianceAt(element, point);
  }
  return 0.5 * (sum + sum.transpose());
}

Joints GravityTorques(const Arm& arm, const Joints& q, const std::vector<LinkMass>& masses,
                      const Counterbalance& counterbalance, const Vector3d& gravity) {
  return GravityTorques(arm, q, LinkFrames(arm, q), masses, counterbalance, gravity);
}

Joints GravityTorques(const Arm& arm, const Joints& q, const LinkPoses& frames,
                      const std::vector<LinkMass>& masses, const Counterbalance& counterbalance,
                      const Vector3d& gravity) {
  Joints torques = Joints::Zero();
  for (const LinkMass& body : masses) {
    assert(body.link >= 0 && body.link <= 6);
    const Vector3d in_flange = frames[6].inverse() * (frames[body.link] * body.centre);
    const Matrix6 J = Jacobian(arm, frames, in_flange);
    // Only the joints inwards of the link carry it.
    torques.head(body.link) +=
        J.topRows<3>().leftCols(body.link).transpose() * (kNewton * body.mass * gravity);
  }
  const double lean = InnerAngles(arm, q)[1] - counterbalance.zero;
  torques[1] -= arm.sign[1] * counterbalance.torque * SinCos(lean).sin;
  return torques;
}

Vector3d GravityDeflection(const Arm& arm, const Joints& q, const Joints& reference, const Vector3d& p_FT,
                           const std::vector<LinkMass>& masses, const Counterbalance& counterbalance,
                           const Vector3d& gravity) {
  const Joints difference = GravityTorques(arm, q, masses, counterbalance, gravity) -
                            GravityTorques(arm, reference, masses, counterbalance, gravity);
  const Joints give = difference.array() / arm.stiffness.array();
  return Jacobian(arm, q, p_FT).topRows<3>() * give;
}

}  // namespace millpose
