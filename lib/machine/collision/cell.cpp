// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/cell.hpp"

#include <cassert>

#include "base/trig.hpp"

namespace millpose {

double Radius(const Shape& shape) {
  const auto farthest = [](const std::vector<Eigen::Vector3d>& points) {
    double radius = 0;
    for (const Eigen::Vector3d& p : points) radius = std::max(radius, p.norm());
    return radius;
  };
  if (const auto* box = std::get_if<Box>(&shape)) return box->size.norm() / 2;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const auto* c = std::get_if<Cylinder>(&shape)) return Hypot(c->radius, c->length / 2);
  if (const auto* c = std::get_if<Capsule>(&shape)) return c->radius + c->length / 2;
  if (const auto* c = std::get_if<Cone>(&shape))
    return Hypot(std::max(c->radius_bottom, c->radius_top), c->length / 2);
  if (const auto* convex = std::get_if<Convex>(&shape)) return farthest(convex->points);
  return farthest(std::get<Triangles>(shape).vertices);
}

Cell AsItIs(Cell cell, const ArmDeviations& deviations) {
  assert(!cell.deviations);
  for (Body& body : cell.bodies)
    if (body.mount == Mount::kLink)
      body.X_MG = DeviationOf(deviations, static_cast<size_t>(body.link)) * body.X_MG;
  cell.deviations = deviations;
  return cell;
}

Pose ToolOnFlange(const Cell& cell) {
  return cell.deviations ? DeviationOf(*cell.deviations, 6) * cell.X_FT : cell.X_FT;
}

Joints MostTurnOf(const Cell& cell, const Joints& turn) {
  return cell.deviations ? cell.deviations->law.MostTurn(turn) : turn;
}

LinkPoses FramesOf(const Cell& cell, const Joints& q) {
  return cell.deviations ? TrueLinkFrames(cell.arm, *cell.deviations, q) : LinkFrames(cell.arm, q);
}

}  // namespace millpose
