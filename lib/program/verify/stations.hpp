// SPDX-License-Identifier: GPL-3.0-or-later
// The external axes of a program: where they stand, how they move from one station to the next.
#pragma once

#include "program/verify/compare.hpp"

namespace millpose {

/// The robot's base in W, and in the part, with the external axes at `external`; `cell`: with them at 0.
Pose BaseInWorld(const Cell& cell, const ExternalPosition& external);
Pose BaseInPart(const Cell& cell, const ExternalPosition& external);

/// What holds of the external axes whatever the plan: in motion `i` they stay within their limits, and where
/// they move outside cuts nothing else does, from a stop to a stop. True when motion `i` is as it should be.
bool CheckExternal(const Replayed& replayed, size_t i, const Cell& cell, std::vector<Finding>& findings);

/// Whether external axes that move along with motion `i`, which takes `seconds`, are faster than they can be:
/// a finding then.
bool CheckExternalSpeed(const Replayed& replayed, size_t i, double seconds, std::vector<Finding>& findings);
/// Why one cannot pass the corner behind motion `i` without a stop: motions `i` and i + 1 take `in` and `out`
/// s; empty where all can.
std::string ExternalJump(const Replayed& replayed, size_t i, double in, double out, double jump_time);

/// Compares the stations in their order: where the external axes stand, after how many cuts they go there,
/// where the arm stands meanwhile.
void CompareStations(const Replayed& replayed, const Replayed& plan, const VerifyOptions& options,
                     std::vector<Finding>& findings);

/// The first pair of bodies found too near while the external axes move in motion `i`, the arm standing;
/// empty when free. `world`: with them at 0; `resolution`: mm, by which a clearance may be missed between.
std::optional<Interference> InterferenceOfMove(const Replayed& replayed, size_t i, const World& world,
                                               double resolution);

}  // namespace millpose
