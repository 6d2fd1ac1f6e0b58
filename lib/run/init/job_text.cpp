// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/init/job_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/angles.hpp"
#include "base/text.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kWantedPoints = 250;  // so that a first plan takes seconds

/// To a decimal of `digits` places.
std::string Number(double value, int digits) {
  double scale = 1;
  for (int i = 0; i < digits; ++i) scale *= 10;
  return ShortestNumber(std::round(value * scale) / scale + 0.0);
}

std::string Vector(const Vector3d& v, int digits) {
  return fmt::format("[{}, {}, {}]", Number(v.x(), digits), Number(v.y(), digits), Number(v.z(), digits));
}

const char* UnitName(double unit) {
  return unit == 1000 ? "m" : unit == 25.4 ? "in" : unit == 10 ? "cm" : "mm";
}

std::string RegionText(const FirstJob& job, double half, double rim) {
  const FacingGroup& group = job.group;
  std::string text = fmt::format(
      "  # GUESS: of the part's smooth faces one that is large and that the arm reaches. Name your own, by "
      "the "
      "side that it\n  # looks to, a place on it, a box, STEP faces (`millpose check PART`): "
      "docs/yaml-reference.md.\n"
      "  region:\n    facing: {{direction: {}, within_deg: {}}}\n    connected: {{seed_mm: {}, crease_deg: "
      "{}}}\n",
      Vector(group.direction, 6), group.flat ? kFlatWithinDeg : kCurvedWithinDeg, Vector(group.seed, 3),
      group.crease_deg);
  if (((group.upper - group.lower).array() > 2 * half).any()) {
    const Vector3d reach = Vector3d::Constant(half);
    text += fmt::format("    box: {{lower_mm: {}, upper_mm: {}}}   # GUESS: a first patch of it\n",
                        Vector(group.seed - reach, 0), Vector(group.seed + reach, 0));
  }
  if (rim > 0) text += fmt::format("    rim_distance_mm: {}\n", Number(rim, 3));
  return text;
}

/// Down to the part's place; `part`: the lines of what it is.
std::string HeadText(const FirstJob& job, const std::string& part) {
  return fmt::format(
      "# Written by `millpose init`; it can be planned as it is. What the program could not know is marked "
      "GUESS:\n"
      "# measure or replace it before a program goes to a machine. Keys: docs/yaml-reference.md.\n"
      "millpose_job: 1\nname: {}\ncell: {}\n{}seed: 1\nworkpiece:\n{}  frame: world\n"
      "  # GUESS: a place in front of the arm, {}. Measure where the part is, or give\n"
      "  # `targets` in place of `pose`: places on the part and where a tracker saw them "
      "(docs/mesh-import.md).\n"
      "  pose: {{xyz_mm: {}, abc_deg: {}}}\n",
      job.name, job.cell, job.tool.empty() ? "" : fmt::format("tool: {}\n", job.tool), part,
      job.placement.upright ? "what is milled upright like a wall" : "what is milled facing up",
      Vector(job.placement.X_WP.translation(), 1),
      Vector(AnglesZyx(job.placement.X_WP.linear()) * kDegPerRad, 3));
}

std::string ProcessText(bool large, double rpm) {
  return fmt::format(
      "# GUESS: feeds and speed. They follow from cutter, material and spindle.\n"
      "process:\n  feed_mm_min: {}\n  plunge_feed_mm_min: {}                  # towards the material\n"
      "  retract_feed_mm_min: 2000\n  spindle_rpm: {}\n"
      "  # With material, teeth and depth poses are chosen by the computed cutting force "
      "(docs/process-force.md):\n"
      "  # cutting: {{material: 5A06, teeth: 4, depth_mm: 1}}\n",
      large ? 600 : 300, large ? 200 : 100, rpm);
}

std::string ProgramsText(const CellSettings& cell) {
  std::vector<std::string> controllers;
  for (const auto& [controller, options] : cell.controllers) controllers.push_back(controller);
  return fmt::format("programs: [{}]\n", fmt::join(controllers, ", "));
}

}  // namespace

double PatchHalf(double reach) { return std::round(0.05 * reach / 10) * 10; }

std::string JobText(const FirstJob& job, const CellSettings& cell) {
  const double diameter = cell.tool.cutter_diameter, half = job.patch_half;
  const bool pad = job.strategy == FirstStrategy::kPad;
  const GroupSides sides = SidesOf(job.group);
  const double length = std::min(sides.length, 2 * half), width = std::min(sides.width, 2 * half);
  const int percent = pad ? 60 : job.strategy == FirstStrategy::kBall ? 20 : 50;
  const double stepover = std::max(0.1, std::round(diameter * percent / 10) / 10);
  const double spacing = std::max(5.0, std::ceil(length * width / stepover / kWantedPoints));
  std::string text = HeadText(job, fmt::format("  mesh: {}\n  unit: {}\n", job.part, UnitName(job.unit)));
  text += fmt::format("toolpath:\n  strategy: {}\n", pad ? "pad" : "parallel_planes");
  text += RegionText(job, half, job.strategy == FirstStrategy::kPlanesFree ? diameter / 2 + 0.5 : 0);
  text += pad ? fmt::format("  pad: {{pattern: zigzag, along: {}}}\n", Vector(sides.along, 6))
              : fmt::format("  planes: {{normal: {}}}\n", Vector(sides.across, 6));
  text += fmt::format(
      "  stepover_mm: {}                         # GUESS: {} % of the cutter's diameter\n  direction: "
      "zigzag\n"
      "  spacing_mm: {}                           # between milling points\n"
      "  rotation_reference: {}            # in the world; the rotation about the tool axis counts from "
      "here\n",
      Number(stepover, 1), percent, Number(spacing, 0), job.placement.upright ? "[0, 0, 1]" : "[1, 0, 0]");
  if (!pad) text += "  chord_tolerance_mm: 0.05\n";
  if (job.strategy == FirstStrategy::kBall)
    text +=
        "  # GUESS: the facets are rough; where the cutter would go into the part it is lifted along its "
        "axis. A\n"
        "  # smoother mesh does without.\n"
        "  gouges: {action: lift}\n";
  const bool large = diameter > 10;
  return text + ProcessText(large, large ? 7000 : 12000) + ProgramsText(cell);
}

std::string PathJobText(const FirstJob& job, const CamSection& section, const CellSettings& cell) {
  const double rpm = section.speed ? std::round(*section.speed * 60e6) / 1e6 : 7000;
  return HeadText(job,
                  "  # GUESS: no part is named, so nothing sees the arm or the cutter go into it: give its "
                  "`mesh`.\n"
                  "  unit: mm\n") +
         fmt::format(
             "toolpath:\n  strategy: cam\n  cam: {{file: {}}}                       # what else it may need: "
             "docs/cam-import.md\n"
             "  spacing_mm: 10                           # between milling points at most\n"
             "  chord_tolerance_mm: 0.01\n"
             "  rotation_reference: {}            # in the world; the rotation about the tool axis counts "
             "from "
             "here\n",
             job.part, job.placement.upright ? "[0, 0, 1]" : "[1, 0, 0]") +
         ProcessText(cell.tool.cutter_diameter > 10, rpm) + ProgramsText(cell);
}

}  // namespace millpose
