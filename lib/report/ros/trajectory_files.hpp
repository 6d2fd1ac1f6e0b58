// SPDX-License-Identifier: GPL-3.0-or-later
// A run as files: the message trajectory_msgs/JointTrajectory of ROS 2, and a table.
#pragma once

#include "program/program_time.hpp"
#include "report/ros/joint_trajectory.hpp"
#include "report/ros/ros_names.hpp"

namespace millpose {

/// YAML as `ros2 topic pub -f` takes it: positions and velocities in rad and m, in the order of
/// RosNames::joints. `head`: lines of remarks in front.
std::string TrajectoryYaml(const std::vector<TrajectoryInstant>& run, const std::vector<ExternalAxis>& axes,
                           const RosNames& names, const std::vector<std::string>& head);

/// The same as CSV with units in the names of columns, and what each instant belongs to: part of the run,
/// pass, planned point. `program`: of the run, made of `plan`.
std::string TrajectoryTable(const std::vector<TrajectoryInstant>& run, const PlanResult& plan,
                            const MotionProgram& program, const RosNames& names);

}  // namespace millpose
