// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/bent_part.hpp"

#include "base/error.hpp"

namespace millpose {
namespace {

constexpr double kWithin = 1e-3;  // mm

void Carry(const PartBending& bending, Pass& pass) {
  Eigen::Vector3d before = Eigen::Vector3d::Zero(), bent_before = before;
  double length_before = 0, bent_length = 0;
  for (size_t i = 0; i < pass.points.size(); ++i) {
    MillingPoint& point = pass.points[i];
    const Eigen::Vector3d p = point.position;
    const Eigen::Matrix3d turn = bending.Turn(p, point.normal);
    point.position = bending.Bent(p);
    for (Eigen::Vector3d* direction : {&point.normal, &point.feed, &point.tool_axis})
      *direction = (turn * *direction).normalized();
    const double length = point.arc_length;
    if (i == 0)
      bent_length = length;
    else
      bent_length += length - length_before + (point.position - bent_before).norm() - (p - before).norm();
    point.arc_length = bent_length;
    before = p, bent_before = point.position, length_before = length;
  }
}

}  // namespace

const PartBending* BendingOf(const JobSettings& job) {
  const std::optional<RegisteredSettings>& registered = job.workpiece.registered;
  return registered && registered->bending ? &registered->bending->shape : nullptr;
}

Triangles BentPart(const JobSettings& job, const Triangles& part) {
  const PartBending* bending = BendingOf(job);
  if (!bending) return part;
  constexpr double kRounded = 1e-3;  // mm
  const double largest = LargestBending(part, *bending).first,
               allowed = job.workpiece.max_bending.value_or(0);
  if (largest > allowed + kRounded)
    throw InputError({}, fmt::format("workpiece.registered.bending: the part is bent by up to {:.3f} mm; "
                                     "allowed: workpiece.registration.max_bending_mm, {:.3f} mm",
                                     largest, allowed));
  if (const double slope = SteepestBending(part, *bending); slope > kSteepestBending)
    throw InputError({}, fmt::format("workpiece.registered.bending: the part is bent at a slope of {:.3f}; "
                                     "allowed: {} mm/mm",
                                     slope, kSteepestBending));
  return BentTriangles(part, *bending, kWithin);
}

Triangles BentStock(const JobSettings& job, Triangles stock) {
  const PartBending* bending = BendingOf(job);
  return bending ? BentTriangles(stock, *bending, kWithin) : std::move(stock);
}

Mesh UnbentPart(const JobSettings& job, const Mesh& bent) {
  const PartBending* bending = BendingOf(job);
  return bending ? Mesh(UnbentTriangles(bent.triangles(), *bending)) : bent;
}

void CarryToBent(const PartBending& bending, Toolpath& toolpath) {
  for (Pass& pass : toolpath.passes) Carry(bending, pass);
}

}  // namespace millpose
