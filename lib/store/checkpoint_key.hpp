// SPDX-License-Identifier: GPL-3.0-or-later
// Names of checkpoints: hashes of the very values that planning a pass or a gap is handed, and of the program
// that plans. Nothing is left out by name, so a setting counts where, and only where, it changes one of them.
#pragma once

#include <string>

#include "planning/external/external_course.hpp"
#include "planning/links/link_move_planner.hpp"
#include "planning/pass/pass_planner.hpp"

namespace millpose {

class ValueBytes;
void AppendTo(ValueBytes& bytes, const Freedom& freedom);
void AppendTo(ValueBytes& bytes, const Objective& objective);
void AppendTo(ValueBytes& bytes, const LeanSurface& surface);

/// What all passes of a job are handed besides themselves, or all gaps besides their ends, without where
/// obstacles stand: that is looked at apart (kept_pass.hpp). Of gaps in a cell with external axes, all of it.
std::string PassContext(const PoseProblem& problem, const World& world, const PathOptions& options);
/// What passes along which external axes move have in common: the cell with all that stands in it.
std::string CoordinatedContext(const PoseProblem& problem, const World& at_zero, const PathOptions& options);
/// Of one of them, as PassKey takes it.
std::string CoordinatedKey(const std::string& context, const ExternalCourse& course);

std::string LinkMoveContext(const World& world, const LinkMoveOptions& options);

/// `number` of the pass in the job, `first_point` the number of its first point.
std::string PassKey(const std::string& context, const Pass& pass, size_t number, size_t first_point);
std::string LinkMoveKey(const std::string& context, const LinkMoveEnd& from, const LinkMoveEnd& to);

/// Whether a plan read from a checkpoint is one of this pass: its number, and all of its points in their
/// order, among which splits may have put others.
bool IsPlanOf(const PassResult& plan, const Pass& pass, size_t number);
/// Whether a gap joins these ends.
bool IsLinkMoveOf(const LinkMove& gap, const LinkMoveEnd& from, const LinkMoveEnd& to);

}  // namespace millpose
