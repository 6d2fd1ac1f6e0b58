// SPDX-License-Identifier: GPL-3.0-or-later
// A cell as a tree of frames, for descriptions that other programs read (docs/ros.md, docs/gltf.md).
#pragma once

#include <string>
#include <vector>

#include "report/ros/ros_names.hpp"

namespace millpose {

/// A frame of the tree and the joint that carries it.
struct CellFrame {
  enum class Joint : uint8_t { kFixed, kTurns, kSlides };

  std::string name;           ///< of the link
  int parent = -1;            ///< index; −1: the root
  Pose X = Pose::Identity();  ///< in the parent with all axes at 0, mm
  Joint joint = Joint::kFixed;
  size_t axis_number = 0;  ///< of a joint: 0..5 of the arm, then the external axes; into RosNames::joints
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< it turns about or slides along, in this frame
  double lower = 0, upper = 0, speed = 0;           ///< rad or mm, and per s
};

/// world, what external axes carry, base_link, link_1 … link_6, tool0 (F), tool_tip (T), workpiece_frame (P);
/// parents before children. Precondition: the cell's external axes stand at 0.
class CellTree {
 public:
  CellTree(const Cell& cell, const RosNames& names);

  const std::vector<CellFrame>& frames() const { return frames_; }

  /// The frame that a body hangs on, and where its shape stands there.
  struct Mounted {
    size_t frame;
    Pose X;
  };
  Mounted MountOf(const Body& body) const;
  size_t part() const { return part_; }  ///< the frame P

 private:
  void AddAxes(const Cell& cell, const RosNames& names, Carries carried);
  void AddArm(const Cell& cell, const RosNames& names);
  int Add(CellFrame frame);
  Pose OnCarrier(int axis, const Pose& X_W) const;

  std::vector<CellFrame> frames_;
  std::vector<int> carriages_;           ///< frames of the external axes
  std::vector<Eigen::Vector3d> places_;  ///< where these stand in W
  std::vector<size_t> links_;            ///< frames of base and links
  size_t tip_ = 0, part_ = 0;
};

}  // namespace millpose
