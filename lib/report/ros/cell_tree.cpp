// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/ros/cell_tree.hpp"

#include "machine/robot/kinematics.hpp"

namespace millpose {

using Eigen::Vector3d;

CellTree::CellTree(const Cell& cell, const RosNames& names) {
  Add({.name = kRosWorld});
  carriages_.assign(cell.external_axes.size(), 0);
  for (const ExternalAxis& axis :
       cell.external_axes)  // its frame: parallel to W, on the line of a rotary one
    places_.push_back(axis.kind == AxisKind::kRotary ? axis.origin : Vector3d::Zero());
  AddAxes(cell, names, Carries::kRobot);
  AddAxes(cell, names, Carries::kWorkpiece);
  AddArm(cell, names);
  const int carrier = LastCarrier(cell.external_axes, Carries::kWorkpiece);
  part_ =
      static_cast<size_t>(Add({.name = kRosPart,
                               .parent = carrier == kNoCarrier ? 0 : carriages_[static_cast<size_t>(carrier)],
                               .X = OnCarrier(carrier, cell.X_WP)}));
}

int CellTree::Add(CellFrame frame) {
  frames_.push_back(std::move(frame));
  return static_cast<int>(frames_.size()) - 1;
}

Pose CellTree::OnCarrier(int axis, const Pose& X_W) const {
  if (axis == kNoCarrier) return X_W;
  return Eigen::Translation3d(-places_[static_cast<size_t>(axis)]) * X_W;
}

void CellTree::AddAxes(const Cell& cell, const RosNames& names, Carries carried) {
  for (size_t i = 0; i < cell.external_axes.size(); ++i) {
    const ExternalAxis& axis = cell.external_axes[i];
    if (axis.carries != carried) continue;
    const int under = CarrierOfAxis(cell.external_axes, static_cast<int>(i));
    const bool carried_itself = under != kNoCarrier;
    const Vector3d below = carried_itself ? places_[static_cast<size_t>(under)] : Vector3d::Zero().eval();
    carriages_[i] =
        Add({.name = names.carriages[i],
             .parent = carried_itself ? carriages_[static_cast<size_t>(under)] : 0,
             .X = Pose(Eigen::Translation3d(places_[i] - below)),
             .joint = axis.kind == AxisKind::kRotary ? CellFrame::Joint::kTurns : CellFrame::Joint::kSlides,
             .axis_number = 6 + i,
             .axis = axis.direction,
             .lower = axis.lower,
             .upper = axis.upper,
             .speed = axis.speed});
  }
}

// Between two frames of the arm only the joint between them counts: at angle 0 it is the joint's place.
void CellTree::AddArm(const Cell& cell, const RosNames& names) {
  static constexpr std::array kAxes = {2, 1, 1, 0, 1, 2};  // z, y, y, x, y, z, of the frame behind
  const int carrier = LastCarrier(cell.external_axes, Carries::kRobot);
  int parent = Add({.name = kRosBase,
                    .parent = carrier == kNoCarrier ? 0 : carriages_[static_cast<size_t>(carrier)],
                    .X = OnCarrier(carrier, cell.X_WB)});
  links_.push_back(static_cast<size_t>(parent));
  const LinkPoses frames = LinkFrames(cell.arm, Joints::Zero());
  for (size_t i = 0; i < 6; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    parent = Add({.name = names.links[i],
                  .parent = parent,
                  .X = frames[i].inverse(Eigen::Isometry) * frames[i + 1],
                  .joint = CellFrame::Joint::kTurns,
                  .axis_number = i,
                  .axis = cell.arm.sign[i] * Vector3d::Unit(kAxes[i]),
                  .lower = cell.arm.lower[k],
                  .upper = cell.arm.upper[k],
                  .speed = cell.arm.speed[k]});
    links_.push_back(static_cast<size_t>(parent));
  }
  parent = Add({.name = kRosFlange, .parent = parent});
  tip_ = static_cast<size_t>(Add({.name = kRosTip, .parent = parent, .X = cell.X_FT}));
}

CellTree::Mounted CellTree::MountOf(const Body& body) const {
  switch (body.mount) {
    case Mount::kLink:
      return {links_[static_cast<size_t>(body.link)], body.X_MG};
    case Mount::kTool:
      return {tip_, body.X_MG};
    case Mount::kWorkpiece:
      return {part_, body.X_MG};
    case Mount::kCarriage:
      if (body.axis == kNoCarrier) break;
      return {static_cast<size_t>(carriages_[static_cast<size_t>(body.axis)]),
              OnCarrier(body.axis, body.X_MG)};
    case Mount::kWorld:
      break;
  }
  return {0, body.X_MG};
}

}  // namespace millpose
