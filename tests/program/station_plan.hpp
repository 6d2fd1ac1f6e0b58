// SPDX-License-Identifier: GPL-3.0-or-later
// A plan made by hand with external axes: two passes of SamplePlan(), each milled at a station of its own,
// and a cell's words for the controllers.
#pragma once

#include "program/post.hpp"
#include "program/rapid/rapid_options.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {

/// rail: along W's y, 100 and 400 mm. table: about a vertical axis behind the wall, 5 and 35 degrees. both:
/// rail first.
PlanResult StationPlan(const std::string& axes, const SampleShape& shape = {.points = 4, .ring = false});

/// The same with axes that move along the cuts: in each pass from its station on, by 60 mm and −8 degrees,
/// evenly from point to point. The tip's path on the part is that of StationPlan().
PlanResult RidePlan(const std::string& axes, const SampleShape& shape = {.points = 4, .ring = false});

/// A controller for StationPlan(): a variant as SampleSettings() knows it, with all axes coupled or none.
struct StationPost {
  StationPost(const std::string& variant, const PlanResult& plan, bool coupled);
  PostSettings settings;
  std::unique_ptr<Post> post;
  ProgramFiles Write(const MotionProgram& program, const Arm& arm) const;
};

/// The controller's world of that cell for RAPID, and the table as its unit STN1 where it counts in it.
RapidOptions RapidStations(const PlanResult& plan, bool coupled);

/// The words of the KRL cell, as plain numbers: the rail's root, the robot on its carriage, the table's root,
/// in the controller's $WORLD, which is parallel to the cell.
struct KrlCellNumbers {
  Eigen::Vector3d ersysroot{50, -200, 300}, carriage{20, 60, 120}, root{0, 0, 0};
};
KrlCellNumbers KrlNumbers(const PlanResult& plan, bool coupled);

}  // namespace millpose
