// SPDX-License-Identifier: GPL-3.0-or-later
// Arms that give way in more than their joints' springs, and what is measured on them.
#pragma once

#include "machine/identification/identify.hpp"
#include "machine/stiffness/compliance.hpp"
#include "machine/stiffness/series.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {

/// An arm whose links 1 to 6 tilt by `tilt` (rad/(N·mm), about both axes across the joint's), whose base
/// moves by `base` (mm/N), whose joints take up gaps (rad, to the side to which they are loaded) and on which
/// a weight hangs that nobody states (N).
struct DrawnArm {
  Arm arm;
  std::vector<SeriesCompliance> elements;
  Joints takes_up = Joints::Zero();
  double payload = 0;

  DrawnArm(const Arm& nominal, const std::vector<std::pair<int, double>>& tilts, double base = 0)
      : arm(nominal) {
    constexpr int kOwn[] = {2, 1, 1, 0, 1, 2};
    for (const auto& [link, tilt] : tilts) {
      SeriesCompliance element;
      element.link = link;
      for (int axis = 0; axis < 3; ++axis)
        if (axis != kOwn[link - 1]) element.C(3 + axis, 3 + axis) = tilt;
      elements.push_back(element);
    }
    SeriesCompliance foot;
    foot.C.topLeftCorner<3, 3>() = base * Eigen::Matrix3d::Identity();
    elements.push_back(foot);
  }

  /// By the stiffness module's own compliance, at the point where the load acts.
  LoadCase Loaded(const Joints& q, const Eigen::Vector3d& force, double noise, RandomStream& stream) const {
    LoadCase load;
    load.q = q;
    load.force = force;
    load.load_point = load.measured_point = Eigen::Vector3d(-120, 90, 260);
    const Matrix6 J = Jacobian(arm, q, load.load_point);
    const Matrix6 C = Compliance(J, arm.stiffness) + SeriesComplianceAt(arm, q, load.load_point, elements);
    load.displacement = C.topLeftCorner<3, 3>() * (force - payload * Eigen::Vector3d::UnitZ()) +
                        noise * RandomNormal3(stream);
    const Joints torque = J.topRows<3>().transpose() * force;
    for (int j = 0; j < 6; ++j)
      load.displacement += (torque[j] > 0 ? takes_up[j] : -takes_up[j]) * J.block<3, 1>(0, j);
    return load;
  }

  std::vector<LoadCase> Measured(int poses, double noise, RandomStream& stream) const {
    std::vector<LoadCase> cases;
    for (int i = 0; i < poses; ++i) {
      Joints q;
      q << stream.Uniform(-1, 1), stream.Uniform(-1.7, -0.6), stream.Uniform(0.8, 2), stream.Uniform(-2, 2),
          stream.Uniform(0.4, 1.6), stream.Uniform(-2, 2);
      cases.push_back(Loaded(q, 500 * RandomNormal3(stream).normalized(), noise, stream));
    }
    return cases;
  }
};

}  // namespace millpose
