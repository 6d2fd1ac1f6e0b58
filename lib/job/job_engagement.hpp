// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <stop_token>

#include "base/execution.hpp"
#include "geometry/mesh/mesh.hpp"
#include "job/inputs.hpp"
#include "planning/result/plan_result.hpp"
#include "toolpath/engagement/engagement.hpp"
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

/// At how many entries a tool that does not cut at its centre comes down on material, as far as the job says
/// what it cuts; empty where at none.
std::string EntriesOnMaterial(const JobInputs& inputs, const Mesh& mesh, const PlanResult& plan);

/// What follows where the planner had to skip points of a plan: what they leave standing is cut by the passes
/// beside them. What all points would take off together is worked out once, and again where a plan's points
/// are others. The job, the mesh and the execution outlive it. Throws Interrupted.
class MissingCuts {
 public:
  MissingCuts(const JobInputs& inputs, const Mesh& mesh, const Execution& execution)
      : inputs_(inputs), mesh_(mesh), execution_(execution) {}

  /// Leaves out the pieces that would cut more than 20 % wider or deeper than any of the job's own cuts
  /// because points before them are not milled, and what lies over them in turn (`path.over_missing`).
  /// Returns how many pieces.
  size_t LeaveOut(PlanResult& plan);
  /// Works the engagement of the plan's points out anew; poses stay as planned. What the operator should know
  /// of it, or empty.
  std::string Count(PlanResult& plan);

 private:
  const Toolpath& Whole(const EngagementOptions& options, const PlanResult& plan);
  Toolpath Now(const EngagementOptions& options, const PlanResult& plan);

  const JobInputs& inputs_;
  const Mesh& mesh_;
  const Execution& execution_;
  std::optional<Toolpath> whole_;  ///< in P, nothing skipped; its engagement is set
};

}  // namespace millpose
