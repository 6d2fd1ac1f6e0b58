// SPDX-License-Identifier: GPL-3.0-or-later
// The texts that a cell puts into programs, and the programs of the plant that they call.
#pragma once

#include <stop_token>
#include <vector>

#include "base/error.hpp"
#include "job/inputs.hpp"
#include "machine/collision/world.hpp"
#include "program/motion_program.hpp"

namespace millpose {

/// What the controllers' readers refuse of a cell's texts: statements that are neither modelled nor words of
/// texts nor declared calls, and calls that move the arm anywhere but in header, tool_change and footer.
/// Every program would carry them unproven, so the cell is refused as it is read.
std::vector<Problem> CheckCellTexts(const CellSettings& cell);

/// What keeps the job's external axes from moving along cuts (scope continuous) in the programs that it asks
/// for: the controllers must count in them.
std::vector<Problem> CheckAlongCuts(const JobSettings& job, const CellSettings& cell);

/// What programs of this controller take the cell's word for: "SPINDLE_ON moves nothing", one for every call
/// that its texts make.
std::vector<std::string> AssumedCalls(const CellSettings& cell, const std::string& controller);
std::string AssumptionOf(const DeclaredCall& call);

/// The ways from home to every call that moves the arm, and back. Planned like any gap, from the same seed:
/// the same inputs give the same ways. Throws InputError for one that cannot be planned, Interrupted.
std::vector<CallTransition> PlanCallTransitions(const World& world, const JobInputs& inputs,
                                                const std::string& controller, const std::stop_token& stop);

}  // namespace millpose
