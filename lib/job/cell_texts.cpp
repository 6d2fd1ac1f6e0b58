// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/cell_texts.hpp"

#include "base/units.hpp"
#include "job/assemble.hpp"
#include "planning/links/link_move_planner.hpp"
#include "program/controller_axes.hpp"
#include "program/external_axes.hpp"
#include "program/templates.hpp"

namespace millpose {
namespace {

constexpr double kSameJoints = 1e-9;  // rad

/// The calls that a text makes, in the order of the cell's list.
std::vector<DeclaredCall> CallsOf(const PostSettings& post, const std::string& text) {
  const Templates templates({}, post.texts, ToolOf(post));
  std::vector<DeclaredCall> calls;
  for (DeclaredCall call : post.calls) {
    call.text = text;
    if (templates.Calls(text, {call}, false)) calls.push_back(call);
  }
  return calls;
}

/// External axes that the controller does not name matter where programs are asked for (LoadJobInputs).
PostSettings SettingsOf(const CellSettings& cell, const std::string& controller) {
  if (cell.external_axes.empty()) return MakePostSettings(JobSettings{}, cell, controller);
  return MakeTextSettings(JobSettings{}, cell, controller);
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

/// {number} stands for one that every tool must have.
void CheckNumbers(const CellSettings& cell, const PostSettings& post, std::vector<Problem>& problems) {
  const std::vector<ToolSettings> tools = cell.tools.empty() ? std::vector{cell.tool} : cell.tools;
  for (const auto& [text, lines] : post.texts)
    for (const ToolSettings& tool : tools)
      if (!tool.number && lines.find("{number}") != std::string::npos)
        problems.push_back(
            {{text, 1, 1, -1}, fmt::format("{{number}}: tool {} has none (number)", tool.name)});
}

std::vector<Joints> PlanWay(const World& world, const Joints& from, const Joints& to,
                            const LinkMoveOptions& options, const std::string& name, double& share,
                            const std::stop_token& stop) {
  if ((from - to).cwiseAbs().maxCoeff() < kSameJoints) return {from};
  const LinkMove gap = PlanLinkMove(world, {-1, -1, from}, {-1, -1, to}, options, stop);
  if (!gap.planned)
    throw InputError(
        SourceLocation{},
        fmt::format("the way between home and the call of {} could not be planned: {}", name, gap.detail));
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
    CheckNumbers(cell, post, found);
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
  if (call.from == call.to) return fmt::format("{} leaves the arm at A1..A6 {}", call.name, text(call.to));
  return fmt::format("{} moves the arm from A1..A6 {} to {}", call.name, text(call.from), text(call.to));
}

std::vector<Problem> CheckAlongCuts(const JobSettings& job, const CellSettings& cell) {
  std::vector<Problem> problems;
  for (size_t i = 0; i < job.external.size(); ++i) {
    if (job.external[i].scope != ExternalScope::kContinuous) continue;
    for (const std::string& controller : job.programs) {
      const auto found = cell.controllers.find(controller);
      if (found == cell.controllers.end()) continue;
      const std::string refusal =
          WhyNotAlongCuts(MakeTextSettings(job, cell, controller), controller, job.external[i].axis,
                          found->second.post->MovesAllTogether());
      if (!refusal.empty())
        problems.push_back(
            {{job.file}, fmt::format("external[{}].scope: given continuous, but {}", i, refusal)});
    }
  }
  return problems;
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

std::vector<CallTransition> PlanCallTransitions(const World& at_zero, const JobInputs& inputs,
                                                const std::string& controller, const std::stop_token& stop) {
  const PostSettings post = MakeTextSettings(inputs.job, inputs.cell, controller);
  const LinkMoveOptions options = MakeLinkMoveOptions(inputs.job);
  const ExternalPosition external = Mechanism(at_zero.cell().external_axes).Home();
  const World world = external.empty() ? at_zero : at_zero.At(external);
  const Joints& home = world.cell().home;
  const auto way_of = [&](const DeclaredCall& call) {
    // Nobody knows which tool the spindle holds before it is changed.
    const bool any_tool = call.text == "tool_change" && inputs.cell.tools.size() > 1;
    const World there = any_tool ? World(WithAllTools(world.cell(), inputs.cell)) : world;
    CallTransition way{call, {}, {}};
    way.there = PlanWay(there, home, call.from, options, call.name, way.clearance_share, stop);
    way.back = PlanWay(world, call.to, home, options, call.name, way.clearance_share, stop);
    return way;
  };
  std::vector<CallTransition> ways;
  for (const std::string text : {"header", "tool_change", "footer"}) {
    for (const DeclaredCall& call : CallsOf(post, text)) {
      if (call.moves) ways.push_back(way_of(call));
    }
    const bool by_hand =
        text == "tool_change" && post.change_at && (ways.empty() || ways.back().call.text != text);
    if (by_hand) ways.push_back(way_of(ChangeByHand(*post.change_at)));
  }
  return ways;
}

}  // namespace millpose
