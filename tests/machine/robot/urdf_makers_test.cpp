// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/robot/urdf_text.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The URDFs of makers place the frames of the same arm each in its own way.
struct MakersStyle {
  std::string name;
  std::array<Vector3d, 6> xyz, rpy, axis;  ///< metres, rad
  Vector3d flange_xyz, flange_rpy;
};

std::vector<MakersStyle> MakersStyles() {
  const double h = kPi / 2;
  const Vector3d o = Vector3d::Zero(), x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const Vector3d mx = -x, my = -y, mz = -z;
  return {// Frames turned alike, axes along x, y, z; some arms with the signs of their controller.
          {"abb",
           {Vector3d(0, 0, 0.78), Vector3d(0.32, 0, 0), Vector3d(0, 0, 1.28), Vector3d(0, 0, 0.2),
            Vector3d(1.1425, 0, 0), Vector3d(0.2, 0, 0)},
           {o, o, o, o, o, o},
           {z, y, y, x, y, x},
           o,
           Vector3d(0, h, 0)},
          {"kuka",
           {Vector3d(0, 0, 0.675), Vector3d(0.35, 0, 0), Vector3d(1.15, 0, 0), Vector3d(0, 0, -0.041),
            Vector3d(1, 0, 0), Vector3d(0, 0, 0)},
           {o, o, o, o, o, o},
           {mz, y, y, mx, y, mx},
           Vector3d(0.24, 0, 0),
           Vector3d(0, h, 0)},
          {"fanuc",
           {Vector3d(0, 0, 0.67), Vector3d(0.312, 0, 0), Vector3d(0, 0, 1.075), Vector3d(0, 0, 0.225),
            Vector3d(1.28, 0, 0), Vector3d(0.215, 0, 0)},
           {o, o, o, o, o, o},
           {z, y, my, mx, my, mx},
           o,
           Vector3d(kPi, -h, 0)},
          {"yaskawa",
           {Vector3d(0, 0, 0.54), Vector3d(0.145, 0, 0), Vector3d(0, 0, 1.15), Vector3d(1.225, 0, 0.25),
            Vector3d(0, 0, 0), Vector3d(0, 0, 0)},
           {o, o, o, o, o, o},
           {z, y, my, mx, my, mx},
           Vector3d(0.175, 0, 0),
           Vector3d(kPi, -h, 0)},
          // Every joint about its own z, frames turned by quarters (Denavit and Hartenberg, exporters of CAD
          // systems).
          {"kawasaki",
           {Vector3d(0, 0, 0.43), Vector3d(0.1, 0, 0), Vector3d(0.87, 0, 0), Vector3d(0.1, 0, 0),
            Vector3d(0, 0, 1.02), Vector3d(0, 0, 0)},
           {o, Vector3d(-h, 0, 0), o, Vector3d(-h, 0, 0), Vector3d(h, 0, 0), Vector3d(-h, 0, 0)},
           {z, z, z, z, z, z},
           Vector3d(0, 0, 0.15),
           o},
          {"staubli",
           {Vector3d(0, 0, 0.478), Vector3d(0.05, 0, 0), Vector3d(0, 0, 0.425), Vector3d(0, 0, 0),
            Vector3d(0, 0, 0.425), Vector3d(0, 0, 0)},
           {o, o, o, o, o, o},
           {z, y, y, z, y, z},
           Vector3d(0, 0, 0.1),
           o},
          {"comau",
           {Vector3d(0, 0, 0.8), Vector3d(0.4, 0, 0), Vector3d(0, 0, 1.175), Vector3d(0, 0, 0.25),
            Vector3d(1.3, 0, 0), Vector3d(0.23, 0, 0)},
           {Vector3d(kPi, 0, 0), o, o, o, o, o},
           {z, my, y, mx, y, mx},
           o,
           Vector3d(0, h, 0)},
          {"nachi",
           {Vector3d(0, 0, 0.5), Vector3d(0, -0.2, 0), Vector3d(0, 0, 0.9), Vector3d(0, 0, 0.15),
            Vector3d(0.95, 0, 0), Vector3d(0.12, 0, 0)},
           {Vector3d(0, 0, h), Vector3d(0, 0, -h), o, o, o, o},
           {z, y, y, x, y, x},
           Vector3d(0.02, 0, 0),
           Vector3d(0, h, 0)},
          // The shoulder beside axis 1 and the wrist beside the arm cancel.
          {"offset",
           {Vector3d(0, 0, 0.6), Vector3d(0.25, 0.08, 0), Vector3d(0, 0.05, 1.0), Vector3d(0.1, -0.13, 0.1),
            Vector3d(0.9, 0, 0), Vector3d(0, 0, 0)},
           {o, o, o, o, o, o},
           {z, y, y, x, y, x},
           Vector3d(0.2, 0, 0),
           Vector3d(0, h, 0)}};
}

/// The flange by the file's own words: one homogeneous matrix after the other, mm.
Eigen::Matrix4d OwnForward(const MakersStyle& style, const Joints& q) {
  const auto step = [](const Vector3d& xyz, const Matrix3d& R) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = R;
    T.topRightCorner<3, 1>() = 1000 * xyz;
    return T;
  };
  const auto turn = [](double angle, const Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis).matrix();
  };
  const auto rpy = [&](const Vector3d& v) -> Matrix3d {
    return turn(v[2], Vector3d::UnitZ()) * turn(v[1], Vector3d::UnitY()) * turn(v[0], Vector3d::UnitX());
  };
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  for (size_t i = 0; i < 6; ++i)
    T = T * step(style.xyz[i], rpy(style.rpy[i]) * turn(q[static_cast<Eigen::Index>(i)], style.axis[i]));
  return T * step(style.flange_xyz, rpy(style.flange_rpy));
}

TEST(Urdf, NineArmsInTheMakersStylesAgreeWithTheirFiles) {
  RandomStream random(17, 0);
  double worst = 0;
  for (const MakersStyle& style : MakersStyles()) {
    Spec spec;
    for (size_t i = 0; i < 6; ++i) spec.joints[i] = {style.xyz[i], style.rpy[i], style.axis[i]};
    spec.flange_xyz = style.flange_xyz;
    spec.flange_rpy = style.flange_rpy;
    const DerivedArm derived = Derive(UrdfOf(spec));
    for (int k = 0; k < 200; ++k) {
      Joints q;
      for (double& angle : q) angle = random.Uniform(-kPi, kPi);
      const Pose X = derived.X_SB * ForwardFlange(derived.arm, q) * derived.X_FE;
      const Eigen::Matrix4d off = X.matrix() - OwnForward(style, q);
      worst = std::max({worst, off.topRightCorner<3, 1>().norm(), 500 * off.topLeftCorner<3, 3>().norm()});
      ASSERT_LT(worst, 1e-9) << style.name;
    }
  }
}

}  // namespace
}  // namespace millpose
