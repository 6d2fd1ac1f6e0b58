// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/audit/kinematics.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace millpose::audit {

Matrix4 Tool(const Setup& setup, const Angles& angles) { return Frames(setup, angles)[6] * setup.X_FT; }

Matrix4 ToolOnPart(const Setup& setup, const Angles& angles, const std::vector<Real>& external) {
  if (external.empty()) return setup.X_WP.inverse() * Tool(setup, angles);
  const Matrix4 X_WP = Carried(setup, LastCarrier(setup, false), external) * setup.X_WP;
  return X_WP.inverse() * Carried(setup, LastCarrier(setup, true), external) * Tool(setup, angles);
}

Matrix4 UrdfTool(const UrdfArm& arm, const Angles& angles) {
  Matrix4 X = arm.X_WS;
  size_t turned = 0;
  for (const UrdfArm::Joint& joint : arm.joints) {
    X *= joint.origin;
    if (joint.axis.isZero(0)) continue;
    Matrix4 turn = Matrix4::Identity();
    turn.block<3, 3>(0, 0) = Eigen::AngleAxis<Real>(angles.at(turned++), joint.axis).toRotationMatrix();
    X *= turn;
  }
  return X * arm.X_ET;
}

Angles Solve(const Setup& setup, const Matrix4& X_WT, Angles angles) {
  const auto error = [&](const Angles& at) {
    const Matrix4 X = Tool(setup, at);
    const Matrix3 turn = X_WT.block<3, 3>(0, 0) * X.block<3, 3>(0, 0).transpose();
    Eigen::Matrix<Real, 6, 1> e;
    e << Vector3((X_WT - X).block<3, 1>(0, 3)) / 1000, (turn(2, 1) - turn(1, 2)) / 2,
        (turn(0, 2) - turn(2, 0)) / 2, (turn(1, 0) - turn(0, 1)) / 2;
    return e;
  };
  for (int round = 0; round < 20; ++round) {
    const Eigen::Matrix<Real, 6, 1> off = error(angles);
    Eigen::Matrix<Real, 6, 6> slope;
    for (size_t i = 0; i < 6; ++i) {
      Angles more = angles;
      more[i] += 1e-8L;
      slope.col(static_cast<Eigen::Index>(i)) = (error(more) - off) / 1e-8L;
    }
    const Eigen::Matrix<Real, 6, 1> step = slope.fullPivLu().solve(off);
    for (size_t i = 0; i < 6; ++i) angles[i] -= step[static_cast<Eigen::Index>(i)];
    if (step.norm() < 1e-12L) break;  // rad; the next would be shorter by far
  }
  return angles;
}

namespace {

/// How far `origin` moves in W when the spring gives way under a unit force there along x, y and z.
Matrix3 GiveOf(const Spring& spring, const Matrix4& X_WL, const Vector3& origin) {
  const Matrix4 X_WK = X_WL * spring.X_LK;
  const Matrix3 R = X_WK.block<3, 3>(0, 0);
  const Vector3 arm = origin - X_WK.block<3, 1>(0, 3);
  Matrix3 moved;
  for (int i = 0; i < 3; ++i) {
    const Vector3 force = Vector3::Unit(i), moment = arm.cross(force);
    Eigen::Matrix<Real, 6, 1> wrench;
    wrench << R.transpose() * force, R.transpose() * moment;
    const Eigen::Matrix<Real, 6, 1> twist = spring.C * wrench;
    const Vector3 shift = R * twist.head<3>(), turn = R * twist.tail<3>();
    moved.col(i) = shift + turn.cross(arm);
  }
  return moved;
}

/// By central differences.
Eigen::Matrix<Real, 6, 6> JacobianAt(const Setup& setup, const Angles& angles, const Matrix4& X_FO) {
  constexpr Real kStep = 1e-5L;  // rad: truncation near 1e-10 of the entries, rounding far below
  Eigen::Matrix<Real, 6, 6> J;
  const Matrix4 middle = Frames(setup, angles)[6] * X_FO;
  for (int i = 0; i < 6; ++i) {
    Angles more = angles, less = angles;
    more[static_cast<size_t>(i)] += kStep;
    less[static_cast<size_t>(i)] -= kStep;
    const Matrix4 after = Frames(setup, more)[6] * X_FO, before = Frames(setup, less)[6] * X_FO;
    J.col(i).head<3>() = (after - before).block<3, 1>(0, 3) / (2 * kStep);
    const Matrix3 spin =
        (after - before).block<3, 3>(0, 0) / (2 * kStep) * middle.block<3, 3>(0, 0).transpose();
    J.col(i).tail<3>() << spin(2, 1), spin(0, 2), spin(1, 0);
  }
  return J;
}

Matrix4 StiffnessOrigin(const Setup& setup) {
  return setup.stiffness_at_flange ? Matrix4(Matrix4::Identity()) : setup.X_FT;
}

Matrix3 ComplianceBy(const Setup& setup, const Angles& angles, const Eigen::Matrix<Real, 6, 6>& J) {
  Eigen::Matrix<Real, 6, 1> flexibility;
  for (int i = 0; i < 6; ++i) flexibility[i] = 1 / setup.stiffness[static_cast<size_t>(i)];
  Matrix3 c = J.topRows<3>() * flexibility.asDiagonal() * J.topRows<3>().transpose();
  const std::array<Matrix4, 7> frames = Frames(setup, angles);
  const Vector3 origin = (frames[6] * StiffnessOrigin(setup)).block<3, 1>(0, 3);
  for (const Spring& spring : setup.springs)
    c += GiveOf(spring, frames[static_cast<size_t>(spring.link)], origin);
  return c;
}

}  // namespace

Angles TurnedNear(Angles angles, const Angles& near) {
  for (size_t i = 0; i < 6; ++i)
    angles[i] += 360 * kDegree * std::round((near[i] - angles[i]) / (360 * kDegree));
  return angles;
}

Matrix3 ComplianceAt(const Setup& setup, const Angles& angles) {
  return ComplianceBy(setup, angles, JacobianAt(setup, angles, StiffnessOrigin(setup)));
}

Indices ComputeIndices(const Setup& setup, const Angles& angles, const Vector3& normal_W) {
  const Eigen::Matrix<Real, 6, 6> J = JacobianAt(setup, angles, StiffnessOrigin(setup));
  const Matrix3 c = ComplianceBy(setup, angles, J);

  // A point c·f of the ellipsoid with |f| = 1 lies in the plane when it is B·y; so |c⁻¹·B·y| = 1 there.
  const Vector3 n = normal_W.normalized();
  Eigen::Index least;
  n.cwiseAbs().minCoeff(&least);
  // With a third column of nothing: of square matrices the decomposition compiles quickly.
  Matrix3 plane = Matrix3::Zero();
  plane.col(0) = n.cross(Vector3(Vector3::Unit(least))).normalized();
  plane.col(1) = n.cross(Vector3(plane.col(0)));
  const Matrix3 inverse = c.inverse();
  const Eigen::JacobiSVD<Matrix3> section(inverse * plane);
  Indices indices;
  indices.lambda_t1 = 1 / section.singularValues()[1];
  indices.lambda_t2 = 1 / section.singularValues()[0];
  indices.lambda_n = 1 / (inverse * n).norm();
  indices.mu = indices.lambda_t2 / indices.lambda_t1;
  indices.objective = setup.w1 * indices.lambda_t2 + setup.w2 * indices.lambda_n;

  Eigen::Matrix<Real, 6, 6> scaled = J;
  scaled.topRows<3>() /= setup.characteristic_length;
  const Eigen::JacobiSVD<Eigen::Matrix<Real, 6, 6>> svd(scaled);
  const auto squares = svd.singularValues().array().square();
  indices.dexterity = 6 / std::sqrt(squares.sum() * squares.inverse().sum());
  return indices;
}

Real AngleBetween(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

Real AngleBetween(const Matrix3& a, const Matrix3& b) {
  // |a − b| = 2·√2·sin(angle/2) (Frobenius), exact for small angles where the trace is not.
  const Real chord = (a - b).norm() / (2 * std::sqrt(Real{2}));
  return 2 * std::asin(std::min(Real{1}, chord));
}

}  // namespace millpose::audit
