// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <optional>

#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

/// |c·F|, mm: how far the mean cutting force F moves the tip. F is that of the point (docs/engagement.md), or
/// the same at all points where it is given: in N, on the tool, `feed_N` along the feed, `across_N` along
/// axis × feed, `axial_N` along the tool axis towards the holder.
class ProcessForce final : public Objective {
 public:
  explicit ProcessForce(const ObjectiveParameters& parameters);
  std::string Name() const override { return "process_force"; }
  std::string Unit() const override { return "mm"; }
  bool DependsOnFeed() const override { return true; }
  bool NeedsForce() const override { return !given_; }
  bool ReadsToolAxis() const override { return given_.has_value(); }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;

 private:
  std::optional<Eigen::Vector3d> given_;  // along feed, across, axis, N
};

ProcessForce::ProcessForce(const ObjectiveParameters& parameters) {
  const Eigen::Vector3d force(parameters.at("feed_N"), parameters.at("across_N"), parameters.at("axial_N"));
  if (!force.isZero(0.0)) given_ = force;
}

void ProcessForce::Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const {
  Eigen::Vector3d F = context.force;
  if (given_) {
    // The feed need not be normal to a tilted tool: "along the feed" means its part in the plane normal to
    // the axis.
    const Eigen::Vector3d across = context.tool_axis.cross(context.feed).normalized();
    F = given_->x() * across.cross(context.tool_axis) + given_->y() * across +
        given_->z() * context.tool_axis;
  }
  const double fx = F.x(), fy = F.y(), fz = F.z();
  for (int i = 0; i < kLanes; ++i) {
    const double x = c.xx.v[i] * fx + c.xy.v[i] * fy + c.xz.v[i] * fz;
    const double y = c.xy.v[i] * fx + c.yy.v[i] * fy + c.yz.v[i] * fz;
    const double z = c.xz.v[i] * fx + c.yz.v[i] * fy + c.zz.v[i] * fz;
    out.v[i] = std::sqrt(x * x + y * y + z * z);
  }
}

}  // namespace

ObjectiveEntry ProcessForceEntry() {
  constexpr double kAny = -std::numeric_limits<double>::max();
  return {"process_force",
          {{"feed_N", 0.0, kAny}, {"across_N", 0.0, kAny}, {"axial_N", 0.0, kAny}},
          [](const ObjectiveParameters& all) { return std::make_unique<ProcessForce>(all); }};
}

}  // namespace millpose
