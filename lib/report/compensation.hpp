// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan's compensation does to its points (docs/compensation.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning/result/plan_result.hpp"

namespace millpose {

/// How well a controller's program carries it, mm along the normal.
struct CarriedBy {
  std::string controller;
  double largest = 0;  ///< between the loaded tip and where the plan expects it
};

/// Along the surface normal, mm, over the cut points that a force bends.
struct CompensationFigures {
  size_t points = 0;             ///< that have a force
  size_t left_alone = 0;         ///< of them, those where nothing is taken out
  size_t bounded = 0;            ///< of all, those whose shift is cut to compensation.max_mm
  double largest_shift = 0;      ///< of the tip, whole
  double largest_weight = 0;     ///< of it, weight's
  double largest_map = 0;        ///< of it, the error map's
  double largest_arm_shift = 0;  ///< of the tip, for the arm's deviations, beside `largest_shift`
  double largest_arm_turn = 0;   ///< of the tool, likewise, rad
  std::optional<double> largest_gear =
      {};  ///< of largest_arm_shift's parts, for its gears' tables and couplings
  /// Largest half of the 95 % interval along the normal of what the measured geometry leaves.
  std::optional<double> arm_left = {};
  bool shifts = false;                             ///< anything but deviations is taken out
  double expected_before = 0, expected_after = 0;  ///< the largest
  double worst_before = 0, worst_after = 0;        ///< the largest that force and stiffness may make
  /// Median of |error after ÷ before| where something is taken out, over arms and forces within the bounds.
  std::optional<double> remains;
  bool could_hurt = false;  ///< at some point less than nothing could be gained
  std::vector<CarriedBy> programs;
};

/// Empty where nothing is compensated.
std::optional<CompensationFigures> FiguresOfCompensation(const PlanResult& plan);

/// Whether taking out `taken` could leave more than there was, for some deflection that may be.
bool CouldHurt(const Compensation::Along& deflection);

/// One row per compensated point: point,pass, the force in P (N), along the normal and across it (µm) what is
/// expected, between which values it lies, what is taken out, what remains at worst before and after, the
/// shift of the tip and weight's share of it in P (µm), whether the shift was cut to
/// compensation.max_mm, what an error map takes out along the normal (µm), and by how much the commanded tool
/// lies elsewhere (µm) and is turned (rotation vector, mrad) for the arm's deviations, in P; where its
/// joints have tables or couplings, the part of the former that is for them; where the
/// cell says in which ways its geometry may be off yet, half of the 95 % interval along the normal (µm).
std::string CompensationCsv(const PlanResult& plan);

/// The lines of the terminal's summary.
std::string CompensationText(const CompensationFigures& figures);

}  // namespace millpose
