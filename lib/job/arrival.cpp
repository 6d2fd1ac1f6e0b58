// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/arrival.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "geometry/import/raw_mesh.hpp"
#include "geometry/import/step_reader.hpp"
#include "job/assemble.hpp"
#include "job/controller_zero.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

Vector3d SizeOf(const std::vector<Vector3d>& points) {
  if (points.empty()) return Vector3d::Zero();
  Vector3d lower = points.front(), upper = lower;
  for (const Vector3d& p : points) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
  return upper - lower;
}

/// Of the box round a shape in its own frame, mm.
struct BoxSize {
  Vector3d operator()(const Box& box) const { return box.size; }
  Vector3d operator()(const Sphere& s) const { return Vector3d::Constant(2 * s.radius); }
  Vector3d operator()(const Cylinder& c) const { return {2 * c.radius, 2 * c.radius, c.length}; }
  Vector3d operator()(const Capsule& c) const {
    return {2 * c.radius, 2 * c.radius, c.length + 2 * c.radius};
  }
  Vector3d operator()(const Cone& c) const {
    const double width = 2 * std::max(c.radius_bottom, c.radius_top);
    return {width, width, c.length};
  }
  Vector3d operator()(const Convex& c) const { return SizeOf(c.points); }
  Vector3d operator()(const Triangles& t) const { return SizeOf(t.vertices); }
};

std::string WristOf(const CellSettings& settings) {
  const std::string deviation =
      settings.arm.deviation
          ? fmt::format("; the closed form is within {:.2g} mm of the file's joints", *settings.arm.deviation)
          : "";
  return (settings.arm.family == ArmFamily::kParallelAxes ? "axes 2, 3 and 4 are parallel"
                                                          : "spherical: axes 4, 5 and 6 meet in one point") +
         deviation;
}

std::string Length(double mm) {
  return mm >= 1000 ? fmt::format("{:.4g} m", mm / 1000) : fmt::format("{:.3g} mm", mm);
}

/// "-1 × axis 2": what a controller adds to its count of an axis.
std::string Sum(const Joints& factors) {
  std::vector<std::string> terms;
  for (int i = 0; i < 6; ++i)
    if (factors[i] != 0) terms.push_back(fmt::format("{} × axis {}", ShortestNumber(factors[i]), i + 1));
  return fmt::format("{}", fmt::join(terms, " + "));
}

}  // namespace

ArmArrival DescribeArrival(const CellSettings& settings, const Cell& cell) {
  ArmArrival arrival;
  arrival.joints = settings.arm.joints.empty() ? "A1 to A6, as the cell says" : settings.arm.joints;
  arrival.zero = DescribeZero(cell.arm);
  arrival.wrist = WristOf(settings);
  for (size_t i = 0; i < 6; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    arrival.limits[i] = {RadToDeg(cell.arm.lower[axis]), RadToDeg(cell.arm.upper[axis])};
  }
  for (const Body& body : cell.bodies)
    if (body.body_class == BodyClass::kLink)
      arrival.bodies.push_back({body.name, WordOf(kLinkWords, body.link), std::visit(BoxSize{}, body.shape)});
  for (const auto& [name, controller] : settings.controllers) {
    const AxisConvention axes = controller.shared.UncoupledAxes();
    std::vector<std::string> signs, offsets;
    for (int i = 0; i < 6; ++i) {
      signs.emplace_back(axes.matrix()(i, i) < 0 ? "-1" : "1");
      offsets.push_back(ShortestNumber(std::round(RadToDeg(axes.offset()[i]) * 1e6) / 1e6 + 0.0));
    }
    std::string text = fmt::format("{}: its angle = [{}] × the arm's + [{}]°", name, fmt::join(signs, ", "),
                                   fmt::join(offsets, ", "));
    if (controller.shared.axis_couplings)
      for (const AxisCoupling& coupling : *controller.shared.axis_couplings)
        text += fmt::format(", axis {} + {}", coupling.axis, Sum(coupling.factors));
    arrival.controllers.push_back(std::move(text));
  }
  arrival.notes = settings.notes;
  return arrival;
}

std::string ToText(const ArmArrival& arrival) {
  std::string text = fmt::format("joints              {}\n", arrival.joints);
  text += fmt::format("zero                {}\n", arrival.zero);
  text += fmt::format("wrist               {}\n", arrival.wrist);
  std::vector<std::string> limits;
  for (const auto& [lower, upper] : arrival.limits)
    limits.push_back(fmt::format("{:.6g} to {:.6g}", lower, upper));
  text += fmt::format("limits              {} deg\n", fmt::join(limits, ", "));
  for (const ArmArrival::Body& body : arrival.bodies)
    text += fmt::format("link body           {} on {}: {:.4g} x {:.4g} x {:.4g} mm\n", body.name, body.mount,
                        body.size.x(), body.size.y(), body.size.z());
  for (const std::string& controller : arrival.controllers)
    text += fmt::format("controller's zero   {}\n", controller);
  for (const std::string& note : arrival.notes) text += "  - note: " + note + "\n";
  return text;
}

std::vector<Problem> CheckLinkMeshes(const CellSettings& cell,
                                     const std::map<std::string, std::string>& body_bytes) {
  std::vector<Problem> problems;
  const double reach = ArmLength(MakeArm(cell.arm));
  for (const BodySettings& body : cell.bodies) {
    if (body.body_class != BodyClass::kLink || body.shape.kind != ShapeKind::kMesh) continue;
    const auto bytes = body_bytes.find(body.shape.mesh_file);
    if (bytes == body_bytes.end() || LooksLikeCad(bytes->second)) continue;
    const double size =
        body.shape.unit * SizeOf(ReadMesh(bytes->second, body.shape.mesh_file).triangles.vertices).maxCoeff();
    if (size <= 10 * reach && size >= reach / 1000) continue;
    const double scale = body.shape.unit / 1000;
    const double likely = size > reach ? scale / 1000 : scale * 1000;
    const bool usual = likely == 1 || likely == 0.001;
    problems.push_back({{body.shape.mesh_file},
                        fmt::format("{} is {} {} with the scale {:.6g}, while the arm reaches {}{}",
                                    body.name, Length(size), size > reach ? "wide" : "small", scale,
                                    Length(reach), usual ? fmt::format(": scale {:.6g}?", likely) : "")});
  }
  return problems;
}

}  // namespace millpose
