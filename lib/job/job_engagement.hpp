// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <stop_token>

#include "base/execution.hpp"
#include "geometry/mesh/mesh.hpp"
#include "job/inputs.hpp"
#include "planning/result/plan_result.hpp"
#include "toolpath/engagement/process_force.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// Kienzle's exponent m_c of what a job cuts: a force goes with its feed to the power 1 − m_c. Precondition:
/// the job has `process.cutting`.
double ChipExponent(const JobSettings& job);

/// Sets what every point of a job's tool path (in P, gouges known) takes off, and the mean force there;
/// returns the heaviest cut. Nothing where the job has no `process.cutting`. Throws InputError for a
/// material, depth, width or stock that cannot be or that contradicts the tool path; Interrupted.
std::optional<CuttingForce> SetJobEngagement(const JobInputs& inputs, const Mesh& mesh,
                                             const Execution& execution, Toolpath& toolpath);

/// Sets the same in a variant of that tool path, for the points alone that are set in `of`, by pass.
void SetEngagementOf(const std::vector<std::vector<char>>& of, const JobInputs& inputs, const Mesh& mesh,
                     const Execution& execution, Toolpath& toolpath);

/// Leaves out the pieces of a plan that would cut more than 20 % wider or deeper than any of the job's own
/// cuts because points before them are not milled, and what lies over them in turn (`path.over_missing`).
/// Returns how many pieces.
size_t LeaveOverMissing(const JobInputs& inputs, const Mesh& mesh, const Execution& execution,
                        PlanResult& plan);

/// At how many entries a tool that does not cut at its centre comes down on material, as far as the job says
/// what it cuts; empty where at none.
std::string EntriesOnMaterial(const JobInputs& inputs, const Mesh& mesh, const PlanResult& plan);

/// Works the engagement of a plan's points out anew where the planner had to skip some: what they leave
/// standing is cut by the passes beside them. Poses stay as planned. What the operator should know of it, or
/// empty.
std::string CountWhatIsLeft(const JobInputs& inputs, const Mesh& mesh, const Execution& execution,
                            PlanResult& plan);

}  // namespace millpose
