// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "machine/collision/coordinated_checker.hpp"
#include "machine/motion/line.hpp"

namespace millpose {

/// What is in the way of a straight motion of the tool.
struct CutProblem {
  std::optional<ContactCandidate> sighting;  ///< empty: the arm would change its branch, or the cutter gouge
  double gouge = 0;                          ///< how deep the cutter would go into the part, mm
  ExternalPosition external = {};  ///< where the axes were at the sighting, on a motion along which they go
};

/// Checks the straight motion of the tool between the poses at q0 and q1 (LIN, G1: what every program runs in
/// a cut) in Phase::kCutting; q1 as many full revolutions on as the motion makes. Empty means that no checked
/// pair comes nearer than its clearance less `resolution` (mm) on it, nor on any motion of the joints that
/// keeps between it and their even turning on the parts that it was cut into; else what is in the way. A
/// motion on which the arm would change its branch is in its own way.
std::optional<CutProblem> CheckCut(Checker& checker, const Carrier& carrier, const Joints& q0,
                                   const Joints& q1, double resolution);

/// The same where external axes move: `carrier` has their ride, and the motion is straight in P.
std::optional<CutProblem> CheckCut(CoordinatedChecker& checker, const Carrier& carrier, const Joints& q0,
                                   const Joints& q1, double resolution);

/// One line; `checker`: of the world where it was seen.
std::string Describe(Checker& checker, const CutProblem& problem);

}  // namespace millpose
