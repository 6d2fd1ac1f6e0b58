// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cutter.hpp"

#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/cutters.hpp"

namespace millpose {
namespace {

// Height of the cutter's bottom over its tip at a distance from the axis.
double Bottom(const CutterShape& cutter, double distance) {
  const double r = cutter.corner_radius, beyond = std::max(0.0, distance - (cutter.radius - r));
  return r - std::sqrt(std::max(0.0, r * r - beyond * beyond));
}

TEST(Cutter, TouchesThePlaneAtTheContactAndNowhereElse) {
  for (const CutterShape& cutter : kCutters)
    for (const double lead : {0.0, 0.1, -0.4})
      for (const double tilt : {0.0, 0.3}) {
        const Eigen::Vector3d axis = Leaning(lead, tilt), contact(3, -7, 0);
        const Eigen::Vector3d tip = TipAtContact(cutter, contact, Eigen::Vector3d::UnitZ(), axis);
        EXPECT_LT((ContactAtTip(cutter, tip, Eigen::Vector3d::UnitZ(), axis) - contact).norm(), 1e-9);
        const Eigen::Vector3d lever = contact - tip;
        if (lead != 0 || tilt != 0) {
          EXPECT_NEAR(ContactRadius(cutter, Eigen::Vector3d::UnitZ(), axis),
                      (lever - lever.dot(axis) * axis).norm(), 1e-9);
        }
        // The cutter's surface, sampled: nothing below the plane, the lowest point at the contact.
        const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
        double lowest = 1e9;
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        for (int i = 0; i <= 400; ++i)
          for (int j = 0; j < 720; ++j) {
            const double rho = cutter.radius * i / 400, phi = 2 * kPi * j / 720;
            const Eigen::Vector3d p =
                tip + rho * (std::cos(phi) * u + std::sin(phi) * v) + Bottom(cutter, rho) * axis;
            if (p.z() < lowest - 1e-9) {
              lowest = p.z();
              place = p;
            }
          }
        EXPECT_NEAR(lowest, 0, 1e-3);
        if (lead != 0 || tilt != 0) {
          EXPECT_LT((place - contact).norm(), 0.2) << place.transpose();
        }
      }
}

}  // namespace
}  // namespace millpose
