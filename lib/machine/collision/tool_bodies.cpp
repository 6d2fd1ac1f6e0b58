// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/tool_bodies.hpp"

#include "machine/collision/cutter.hpp"
#include "machine/collision/fcl_part.hpp"

namespace millpose {
namespace {

constexpr double kRubs = 0.2;   // mm by which a shank may rub beyond what is not known of the material
constexpr double kThin = 1e-6;  // mm, of a box without width

/// The shank as a convex body in T, thinner by `by`; empty when nothing is left of it.
std::optional<Convex> Thinner(std::optional<Convex> shank, double by) {
  if (!shank) return shank;
  for (Eigen::Vector3d& point : shank->points) {
    const double radius = point.head<2>().norm();
    if (radius == 0) continue;
    if (radius <= by) return std::nullopt;
    point.head<2>() *= (radius - by) / radius;
  }
  return shank;
}

}  // namespace

struct ToolBodies::Impl {
  struct ToolBody {
    std::string name;
    FclPart part;
    Pose X_TG;
    double clearance;  ///< mm
  };
  std::vector<ToolBody> bodies;
  double reach = 0;
};

ToolBodies::ToolBodies(const Cell& cell, double beside, double travel) {
  auto impl = std::make_unique<Impl>();
  for (const Body& body : cell.bodies) {
    if (body.mount != Mount::kTool) continue;
    if (body.body_class == BodyClass::kCutter) {
      if (auto shank = Thinner(AboveHeight(body.shape, body.X_MG, cell.cutter_length), beside + kRubs))
        impl->bodies.push_back({body.name + "'s shank", MakePart(*shank), Pose::Identity(), kThin});
    } else if (body.body_class == BodyClass::kHolder || body.body_class == BodyClass::kSpindle) {
      impl->bodies.push_back({body.name, MakePart(body.shape), body.X_MG,
                              std::max(cell.clearances.cutting, beside + travel / 2)});
    }
  }
  for (const auto& body : impl->bodies)
    impl->reach = std::max(impl->reach, (body.X_TG * body.part.centre).norm() + body.part.radius);
  impl_ = std::move(impl);
}

ToolBodies::~ToolBodies() = default;

size_t ToolBodies::size() const { return impl_->bodies.size(); }
const std::string& ToolBodies::Name(size_t body) const { return impl_->bodies[body].name; }
double ToolBodies::Reach() const { return impl_->reach; }

std::function<bool(const Eigen::AlignedBox3d&)> ToolBodies::NearTo(size_t body, const Pose& X_T) const {
  const Impl::ToolBody& own = impl_->bodies[body];
  return [placed = PlacePart(own.part, X_T * own.X_TG),
          clearance = own.clearance](const Eigen::AlignedBox3d& box) {
    const Eigen::Vector3d size = box.sizes();
    FclPart around;
    around.half = size / 2;
    around.radius = around.half.norm();
    const Pose X_G(Eigen::Translation3d(box.center()));
    if (BoxesApart(placed, PlacePart(around, X_G), clearance)) return false;
    if ((size.array() > 0).count() > 1) return true;
    const FclPart line = MakePart(Box{size.cwiseMax(kThin)});
    return DistanceUpTo(placed, PlacePart(line, X_G), clearance).distance < clearance;
  };
}

}  // namespace millpose
