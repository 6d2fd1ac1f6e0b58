// SPDX-License-Identifier: GPL-3.0-or-later
// What a program does beside its motions, against what it should: spindle, outputs, pass marks, dwells; and,
// where it is known how the program was written, texts, calls with their arguments, stops, waits, messages,
// tools.
#pragma once

#include "program/verify/compare.hpp"

namespace millpose {

/// Compares the events in their order: what they do, with their numbers, after how many cuts, and where the
/// arm stands. `wanted` is the plan, or, with `all`, the plan's program as written and read back: then also
/// what texts and hands alone put into a program. Every difference is a finding, until the two have nothing
/// in common.
void CompareEvents(const Replayed& replayed, const Replayed& wanted, bool all, const Cell& cell,
                   const VerifyOptions& options, std::vector<Finding>& findings);

/// What an event does, for people: "output 5 on", "the call of SUCTION(0)".
std::string Describe(const ProgramEvent& event);

}  // namespace millpose
