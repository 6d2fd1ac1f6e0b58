// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/lean_freedoms.hpp"

#include "pipeline/assemble.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

bool HoldsZero(double value, const std::optional<LeanRange>& range) {
  return range ? range->from <= 0 && range->to >= 0 : value == 0;
}

}  // namespace

void CheckLeanRanges(const JobInputs& inputs, std::vector<Problem>& problems) {
  const ToolpathSettings& toolpath = inputs.job.toolpath;
  const CutterShape cutter = MakeCutterShape(inputs.cell.tool);
  if (!toolpath.Leans() || cutter.IsBall()) return;
  const std::string key = toolpath.lead_range ? "toolpath.lead_deg" : "toolpath.tilt_deg";
  const auto add = [&](const std::string& message) {
    problems.push_back({{inputs.job.file}, fmt::format("{}: {}", key, message)});
  };
  if (HoldsZero(toolpath.lead, toolpath.lead_range) && HoldsZero(toolpath.tilt, toolpath.tilt_range))
    add("the range holds the upright axis, on which a cutter with a flat stands with all of it, so that the "
        "contact would leap; leave it out, as with a lead from 0.1 on (below 0 the heel would cut)");
  if (toolpath.scallop == 0)
    add("what a leaning cutter with a flat leaves between passes must be bounded; give toolpath.scallop_mm");
}

void AddLeanFreedoms(const JobInputs& inputs, const Mesh& mesh, const Pose& X_WP, PoseProblem* problem) {
  const ToolpathSettings& toolpath = inputs.job.toolpath;
  if (!toolpath.Leans()) return;
  if (toolpath.lead_range) problem->freedoms.push_back(MakeFreedom("lead", *toolpath.lead_range));
  if (toolpath.tilt_range) problem->freedoms.push_back(MakeFreedom("tilt", *toolpath.tilt_range));
  LeanRules rules;
  rules.cutter = MakeCutterShape(inputs.cell.tool);
  rules.lead = toolpath.lead;
  rules.tilt = toolpath.tilt;
  rules.lead_free = toolpath.lead_range.has_value();
  rules.tilt_free = toolpath.tilt_range.has_value();
  rules.back_and_forth = toolpath.direction == Direction::kZigzag;
  rules.stepover = toolpath.stepover;
  const auto* on_surface = dynamic_cast<const SurfaceStrategy*>(toolpath.strategy.get());
  rules.by_scallop = on_surface != nullptr && on_surface->IsLaidByScallop();
  rules.scallop = rules.cutter.IsBall() ? 0 : toolpath.scallop;
  rules.min_speed_share = toolpath.min_cutting_speed_share;
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
