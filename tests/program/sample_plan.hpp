// SPDX-License-Identifier: GPL-3.0-or-later
// A small plan made by hand: two zigzag passes and one closed ring on a vertical wall, arm and tool of
// cells/kr500_r2830.yaml.
#pragma once

#include "planning/result/plan_result.hpp"
#include "program/post.hpp"

namespace millpose {

Arm SampleArm();
Pose SampleTool();

/// What to vary in the sample.
struct SampleShape {
  int points = 6;              ///< per pass
  double spacing = 4;          ///< mm
  bool ring = true;            ///< a third, closed pass
  double wall_turn_deg = -90;  ///< B of the workpiece in the world
  double wall_yaw_deg = 0;     ///< A
  double tilt_deg = 0;         ///< of the tool axis against the wall's normal
  int passes = 2;              ///< straight ones
  double stepover = 8;         ///< mm, of these
  double lift = 50;            ///< mm, of approach and retract
};
PlanResult SamplePlan(const SampleShape& shape = {});

/// Feeds of their own for every part of a pass: 1000 mm/min before the last 5 mm, which plunge at 40, 2000
/// away.
MotionOptions SampleFeeds();

/// How FANUC would count the axes of SampleArm(): its own zero and senses, J3 against the level.
AxisConvention SampleFanucAxes();
/// Settings as the kr500_r2830 cell gives them for a controller, or for a variant of it: krl,
/// sinumerik, sinumerik_euler, linuxcnc, linuxcnc_cartesian, urscript, fanuc, fanuc_held (frames that the
/// controller holds), fanuc_cnt, fanuc_cr (corners that the cell bounds), rapid.
PostSettings SampleSettings(const std::string& variant);
std::unique_ptr<Post> SamplePost(const std::string& variant);
/// The program as it is handed to the writer of a variant's controller: with the points that its way to turn
/// the tool needs.
MotionProgram Prepared(const MotionProgram& program, const std::string& variant, const PostSettings& settings,
                       const Arm& arm);
MotionProgram Prepared(const MotionProgram& program, const Post& post, const PostSettings& settings,
                       const Arm& arm);
/// The controller of a variant.
std::string ControllerOf(const std::string& variant);

}  // namespace millpose
