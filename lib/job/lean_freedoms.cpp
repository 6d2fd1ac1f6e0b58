// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/lean_freedoms.hpp"

#include "job/assemble.hpp"
#include "planning/pose/freedom_entry.hpp"
#include "planning/pose/lean_problem.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

/// What the job's freedoms leave open of lead and tilt, and how the tool path is laid.
LeanRules RulesOf(const JobInputs& inputs) {
  const ToolpathSettings& toolpath = inputs.job.toolpath;
  LeanRules rules;
  rules.cutter = MakeCutterShape(inputs.cell.tool);
  rules.lead = toolpath.lead;
  rules.tilt = toolpath.tilt;
  rules.lead_free = rules.tilt_free = false;
  for (const auto& [name, freedom] : toolpath.freedoms) freedom->Open(rules);
  rules.back_and_forth = toolpath.direction == Direction::kZigzag;
  rules.stepover = toolpath.stepover;
  const auto* on_surface = dynamic_cast<const SurfaceStrategy*>(toolpath.strategy.get());
  rules.by_scallop = on_surface != nullptr && on_surface->IsLaidByScallop();
  rules.scallop = rules.cutter.IsBall() ? 0 : toolpath.scallop;
  rules.min_speed_share = toolpath.min_cutting_speed_share;
  return rules;
}

/// Whether the tool may stand along the normal.
bool HoldUpright(const LeanRules& rules, const std::vector<const Freedom*>& leans) {
  return (rules.lead_free || rules.lead == 0) && (rules.tilt_free || rules.tilt == 0) &&
         std::ranges::all_of(leans,
                             [](const Freedom* lean) { return lean->Lower() <= 0 && lean->Upper() >= 0; });
}

}  // namespace

void CheckLeanRanges(const JobInputs& inputs, std::vector<Problem>& problems) {
  const ToolpathSettings& toolpath = inputs.job.toolpath;
  const LeanRules rules = RulesOf(inputs);
  if (!toolpath.Leans() || rules.cutter.IsBall()) return;
  std::vector<const Freedom*> leans;
  std::string key;  // of the first
  for (const FreedomEntry& entry : Freedoms().entries()) {
    const Freedom* freedom = toolpath.Find(entry.name);
    if (!freedom || !freedom->IsLean()) continue;
    if (leans.empty()) key = "toolpath." + entry.key->info.key;
    leans.push_back(freedom);
  }
  const auto add = [&](const std::string& message) {
    problems.push_back({{inputs.job.file}, fmt::format("{}: {}", key, message)});
  };
  if (HoldUpright(rules, leans))
    add("the range holds the upright axis, on which a cutter with a flat stands with all of it, so that the "
        "contact would leap; leave it out, as with a lead from 0.1 on (below 0 the heel would cut)");
  if (toolpath.scallop == 0)
    add("what a leaning cutter with a flat leaves between passes must be bounded; give toolpath.scallop_mm");
}

void BoundLeans(const JobInputs& inputs, const Mesh& mesh, const Pose& X_WP, PoseProblem* problem) {
  if (!HasLean(*problem)) return;
  const ToolpathSettings& toolpath = inputs.job.toolpath;
  LeanRules rules = RulesOf(inputs);
  // Where gouges are only reported they are no one's to avoid.
  const bool avoided = toolpath.gouges.action != GougeAction::kReport;
  rules.surface = std::make_shared<const LeanSurface>(
      mesh, CornerNormals(mesh, toolpath.crease, toolpath.normal_smoothing), X_WP, rules.cutter,
      avoided ? toolpath.gouges.tolerance : std::numeric_limits<double>::infinity());
  problem->lean = std::move(rules);
}

MillingPoint AsLaid(const JobInputs& inputs, const MillingPoint& planned) {
  const ToolpathSettings& toolpath = inputs.job.toolpath;
  MillingPoint laid = planned;
  if (!toolpath.Leans()) return laid;
  const CutterShape cutter = MakeCutterShape(inputs.cell.tool);
  const Eigen::Vector3d contact = ContactAtTip(cutter, planned.position, planned.normal, planned.tool_axis);
  laid.tool_axis = AxisOf({toolpath.lead, toolpath.tilt}, planned.normal, planned.feed);
  laid.position = TipAtContact(cutter, contact, planned.normal, laid.tool_axis);
  return laid;
}

}  // namespace millpose
