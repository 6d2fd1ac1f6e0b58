// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/objectives/process_force.hpp"

#include <limits>

#include "base/error.hpp"
#include "pose/objective_parameters.hpp"

namespace millpose {

ProcessForce::ProcessForce(const ObjectiveParameters& parameters) {
  constexpr double kAny = -std::numeric_limits<double>::max();
  const ParameterReader reader("process_force", parameters,
                               {{"feed_N", 0.0, kAny}, {"across_N", 0.0, kAny}, {"axial_N", 0.0, kAny}});
  force_ = {reader.Value("feed_N"), reader.Value("across_N"), reader.Value("axial_N")};
  if (force_.isZero(0.0))
    throw InputError(Place{},
                     "objective process_force: no force; give the job a process section, or feed_N, across_N "
                     "or axial_N");
}

void ProcessForce::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  // The feed need not be normal to a tilted tool: "along the feed" means its part in the plane normal to the
  // axis.
  const Eigen::Vector3d across = context.tool_axis.cross(context.feed).normalized();
  const Eigen::Vector3d F =
      force_.x() * across.cross(context.tool_axis) + force_.y() * across + force_.z() * context.tool_axis;
  const double fx = F.x(), fy = F.y(), fz = F.z();
  for (int i = 0; i < kLanes; ++i) {
    const double x = c.xx.v[i] * fx + c.xy.v[i] * fy + c.xz.v[i] * fz;
    const double y = c.xy.v[i] * fx + c.yy.v[i] * fy + c.yz.v[i] * fz;
    const double z = c.xz.v[i] * fx + c.yz.v[i] * fy + c.zz.v[i] * fz;
    out.v[i] = std::sqrt(x * x + y * y + z * z);
  }
}

}  // namespace millpose
