// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/freedom.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {

ToolStance Freedom::Lean(const CutterContact&, const ToolStance& from, double) const { return from; }

Pose Freedom::Apply(const Pose& X_WT, double) const { return X_WT; }

Pose NominalToolPose(const ToolStance& stance, const Eigen::Vector3d& rotation_reference) {
  const Eigen::Vector3d z = stance.axis.normalized();
  Eigen::Vector3d x = rotation_reference - rotation_reference.dot(z) * z;
  static const double kParallel = SinCos(DegToRad(1)).sin;
  if (x.norm() < kParallel * rotation_reference.norm()) {
    int least = 0;
    z.cwiseAbs().minCoeff(&least);
    x = Eigen::Vector3d::Unit(least) - z[least] * z;
  }
  Pose X_WT = Pose::Identity();
  X_WT.linear().col(0) = x.normalized();
  X_WT.linear().col(1) = z.cross(X_WT.linear().col(0));
  X_WT.linear().col(2) = z;
  X_WT.translation() = stance.tip;
  return X_WT;
}

}  // namespace millpose
