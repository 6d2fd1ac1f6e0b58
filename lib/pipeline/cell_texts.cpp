// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/cell_texts.hpp"

#include "base/units.hpp"
#include "path/gap_planner.hpp"
#include "pipeline/assemble.hpp"
#include "program/controller_axes.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

constexpr double kSameJoints = 1e-9;  // rad

/// The calls that a text makes, in the order of the cell's list.
std::vector<DeclaredCall> CallsOf(const PostSettings& post, const std::string& text) {
  const Templates templates({}, post.texts, post.tool_name);
  std::vector<DeclaredCall> calls;
  for (DeclaredCall call : post.calls) {
    call.text = text;
    if (templates.Calls(text, {call}, false)) calls.push_back(call);
  }
  return calls;
}

PostSettings SettingsOf(const CellSettings& cell, const std::string& controller) {
  return MakePostSettings(JobSettings{}, cell, controller);
}

/// The arm stands at home before and behind these texts; anywhere else it stands where a cut wants it.
void CheckMovingCalls(const PostSettings& post, const std::string& text, std::vector<Problem>& problems) {
  int moving = 0;
  for (const DeclaredCall& call : CallsOf(post, text)) {
    if (!call.moves) continue;
    if (text != "header" && text != "tool_change" && text != "footer") {
      problems.push_back(
          {{text, 1, 1, -1},
           fmt::format("{} moves the arm: header, tool_change or footer expected", call.name)});
    } else if (moving++ > 0) {
      problems.push_back({{text, 1, 1, -1}, "one call that moves the arm expected in a text"});
    }
  }
}

std::vector<Joints> PlanWay(const World& world, const Joints& from, const Joints& to,
                            const GapOptions& options, const std::string& name, double& share,
                            const std::stop_token& stop) {
  if ((from - to).cwiseAbs().maxCoeff() < kSameJoints) return {from};
  const Gap gap = PlanGap(world, {-1, -1, from}, {-1, -1, to}, options, stop);
  if (!gap.planned)
    throw InputError(Place{}, fmt::format("the way between home and the call of {} could not be planned: {}",
                                          name, gap.detail));
  share = std::min(share, gap.clearance_share);
  return gap.joints;
}

}  // namespace

std::vector<Problem> CheckCellTexts(const CellSettings& cell) {
  std::vector<Problem> problems;
  for (const auto& [controller, settings] : cell.controllers) {
    const PostSettings post = SettingsOf(cell, controller);
    std::vector<Problem> found = settings.post->CheckTexts(MakeArm(cell.arm), post);
    for (const auto& [text, lines] : post.texts) CheckMovingCalls(post, text, found);
    for (const Problem& problem : found) {
      const std::string& text = problem.place.file;
      const auto line = post.text_lines.find(text);
      problems.push_back({{cell.file, line == post.text_lines.end() ? 0 : line->second, 0, -1},
                          fmt::format("controllers.{}.texts.{}, its line {}, column {}: {}", controller, text,
                                      problem.place.line, problem.place.column, problem.message)});
    }
  }
  return problems;
}

std::string AssumptionOf(const DeclaredCall& call) {
  if (!call.moves) return call.name + " moves nothing";
  const auto text = [](const Joints& q) {
    std::vector<std::string> angles;
    for (const double angle : q) angles.push_back(Fixed(angle * kDegPerRad, 2));
    return fmt::format("{}", fmt::join(angles, " "));
  };
  return fmt::format("{} moves the arm from A1..A6 {} to {}", call.name, text(call.from), text(call.to));
}

std::vector<std::string> AssumedCalls(const CellSettings& cell, const std::string& controller) {
  std::vector<std::string> assumptions;
  if (!cell.controllers.contains(controller)) return {};
  const PostSettings post = SettingsOf(cell, controller);
  for (const auto& [text, lines] : post.texts) {
    for (const DeclaredCall& call : CallsOf(post, text)) {
      const std::string assumption = AssumptionOf(call);
      if (std::ranges::find(assumptions, assumption) == assumptions.end()) assumptions.push_back(assumption);
    }
  }
  return assumptions;
}

std::vector<CallWay> PlanCallWays(const World& world, const JobInputs& inputs, const std::string& controller,
                                  const std::stop_token& stop) {
  const PostSettings post = SettingsOf(inputs.cell, controller);
  const GapOptions options = MakeGapOptions(inputs.job);
  const Joints& home = world.cell().home;
  std::vector<CallWay> ways;
  for (const std::string text : {"header", "tool_change", "footer"}) {
    for (const DeclaredCall& call : CallsOf(post, text)) {
      if (!call.moves) continue;
      CallWay& way = ways.emplace_back();
      way.call = call;
      way.there = PlanWay(world, home, call.from, options, call.name, way.clearance_share, stop);
      way.back = PlanWay(world, call.to, home, options, call.name, way.clearance_share, stop);
    }
  }
  return ways;
}

}  // namespace millpose
