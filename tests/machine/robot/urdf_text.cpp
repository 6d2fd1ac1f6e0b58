// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/machine/robot/urdf_text.hpp"

#include <fmt/format.h>

namespace millpose {
namespace {

using Eigen::Vector3d;

std::string Text(const Vector3d& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v[0], v[1], v[2]); }

}  // namespace

std::string UrdfOf(const Spec& spec) {
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"own\">\n";
  for (int i = 0; i <= 7; ++i) text += fmt::format("<link name=\"l{}\"/>\n", i);
  for (int i = 0; i < 6; ++i) {
    const SpecJoint& joint = spec.joints[i];
    text += fmt::format(
        "<joint name=\"j{}\" type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{}\"/>\n"
        "<origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/><limit lower=\"-3\" upper=\"{}\" "
        "velocity=\"2\"/></joint>\n",
        i + 1, i, i + 1, Text(joint.xyz), Text(joint.rpy), Text(joint.axis), 1 + 0.1 * i);
  }
  return text + fmt::format(
                    "<joint name=\"f\" type=\"fixed\"><parent link=\"l6\"/><child link=\"l7\"/>"
                    "<origin xyz=\"{}\" rpy=\"{}\"/></joint>\n</robot>\n",
                    Text(spec.flange_xyz), Text(spec.flange_rpy));
}

DerivedArm Derive(const std::string& urdf, double tolerance) {
  return DeriveArm(FindChain(ReadUrdf(urdf, "own.urdf"), "l0", "l7").chain, tolerance, "own.urdf");
}

}  // namespace millpose
