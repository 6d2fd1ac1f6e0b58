// SPDX-License-Identifier: GPL-3.0-or-later
// Where joints turn back in the cuts that leave the face, and what lost motion then leaves on it
// (docs/lost-motion.md).
#pragma once

#include <string>
#include <vector>

#include "planning/result/gear_course.hpp"

namespace millpose {

struct LostMotionReport {
  GearModel model;
  std::string source;  ///< of the arm's lost motion; empty where it is not known
  GearCourse course;
  GearTally tally;

  /// Whether lost motion is known of every gear that turns back.
  bool Known() const;
};

/// `finished_from`: the first pass of the layer that leaves the face.
LostMotionReport ReportLostMotion(const PlanResult& plan, GearModel model, std::string source,
                                  int finished_from);

/// "A1 4, A3 2": the gears whose count is not 0.
std::string CountsText(const std::vector<ExternalAxis>& external, const std::array<int, kMostGears>& counts);
/// One line for the terminal and report.html, without a line end.
std::string LostMotionText(const PlanResult& plan, const LostMotionReport& report);
/// How large marks are: "at most 85.1 µm, 412 µm summed", per arcmin where lost motion is not known.
std::string MarksText(const GearTally& tally, bool known);

}  // namespace millpose
