// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/split_sections.hpp"

#include <map>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "base/yaml/value.hpp"
#include "job/assemble.hpp"
#include "program/scanner.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr double kSameCutter = 1e-3;  // mm

bool HasCutter(const ToolSettings& tool, const CamSection& section) {
  return std::abs(tool.cutter_diameter - *section.diameter) <= kSameCutter &&
         std::abs(CornerRadius(tool) - section.corner_radius) <= kSameCutter;
}

bool HasNumber(const ToolSettings& tool, const CamSection& section) {
  return section.tool == tool.name || (tool.number && section.tool == std::to_string(*tool.number));
}

std::string CutterText(const ToolSettings& tool) {
  return fmt::format("{} ({}{:.6g} mm{})", tool.name,
                     tool.number ? fmt::format("number {}, ", *tool.number) : "", tool.cutter_diameter,
                     CornerRadius(tool) > 0 ? fmt::format(", corner {:.6g}", CornerRadius(tool)) : "");
}

/// A name that operations may have: "mill_d6", and "mill_d6_2" for its second use.
std::string OperationName(const std::string& tool, std::map<std::string, int>& uses) {
  constexpr size_t kMost = 27;  // of 31, with room for the count
  std::string name;
  for (const char c : tool.empty() ? std::string("cut") : tool)
    name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  if (!std::isalpha(static_cast<unsigned char>(name[0]))) name = "t" + name;
  name.resize(std::min(name.size(), kMost));
  const int use = ++uses[name];
  return use == 1 ? name : fmt::format("{}_{}", name, use);
}

/// The lines of a key at the beginning of a line, with what is indented behind it: first, and one past the
/// last. Blank lines and comments between them and the next key stay.
std::pair<size_t, size_t> LinesOf(const std::vector<std::string_view>& lines, const std::string& key) {
  size_t first = 0;
  while (first < lines.size() && !lines[first].starts_with(key + ":")) ++first;
  size_t end = first < lines.size() ? first + 1 : first;
  for (size_t i = end; i < lines.size(); ++i) {
    const std::string_view line = lines[i];
    const bool inside = line.starts_with(' ') || line.starts_with('-');
    if (inside) end = i + 1;
    if (!inside && !line.empty() && !line.starts_with('#')) break;
  }
  return {first, end};
}

yaml::Value Operation(const yaml::Value& toolpath, const CamSection& section, size_t number,
                      const std::string& tool, const std::string& name, bool own_speed) {
  using yaml::Value;
  Value operation = Value::Map(), laid = toolpath;
  operation.Put("name", Value::Plain(name));
  if (!tool.empty()) operation.Put("tool", Value::Text(tool));
  laid.Find("cam")->Put("section", Value::Plain(std::to_string(number)));
  operation.Put("toolpath", std::move(laid));
  if (own_speed) {
    Value process = Value::Map();
    process.Put("spindle_rpm", Value::Plain(ShortestNumber(std::round(*section.speed * 60e6) / 1e6)));
    operation.Put("process", std::move(process));
  }
  return operation;
}

bool SpeedDiffers(const CamSection& section, double speed) {
  return section.speed && std::abs(*section.speed - speed) > 1e-9 * (1 + speed);
}

/// A process of the job whose speed no operation takes.
std::string WithoutSpeed(const yaml::Value& process) {
  yaml::Value kept = yaml::Value::Map(), map = yaml::Value::Map();
  for (size_t i = 0; i < process.keys.size(); ++i)
    if (process.keys[i].text != "spindle_rpm") kept.Put(process.keys[i].text, process.items[i]);
  map.Put("process", std::move(kept));
  return yaml::WriteYaml(map);
}

/// One tool at several speeds asks for no choice of a tool, whatever its number.
std::vector<CamSection> WithoutNeedlessTools(std::vector<CamSection> sections, const CellSettings& cell) {
  const bool one = cell.tools.empty() && std::ranges::all_of(sections, [&](const CamSection& section) {
                     return section.tool == sections.front().tool;
                   });
  if (one)
    for (CamSection& section : sections) section.tool.clear();
  return sections;
}

}  // namespace

std::vector<CamSection> SectionsOf(const JobInputs& inputs) {
  const Strategy& strategy = *inputs.job.toolpath.strategy;
  if (strategy.Name() != "cam")
    throw InputError(
        {inputs.job.file},
        fmt::format("toolpath.strategy: {} has no sections; they are a CAM file's (cam)", strategy.Name()));
  const ToolpathOptions options = MakeToolpathOptions(inputs.job, inputs.cell.tool);
  return strategy.Sections({Mesh(Triangles()), options, inputs.path_bytes});
}

std::string ToolOfSection(const CamSection& section, size_t number, const CellSettings& cell,
                          const std::string& file) {
  const bool choice = !cell.tools.empty();
  const std::vector<ToolSettings> tools = choice ? cell.tools : std::vector<ToolSettings>{cell.tool};
  std::vector<const ToolSettings*> fit;
  for (const ToolSettings& tool : tools)
    if (section.diameter ? HasCutter(tool, section)
                         : HasNumber(tool, section) || (!choice && section.tool.empty()))
      fit.push_back(&tool);
  if (fit.size() > 1)
    if (const auto numbered =
            std::ranges::find_if(fit, [&](const ToolSettings* tool) { return HasNumber(*tool, section); });
        numbered != fit.end())
      fit = {*numbered};
  if (fit.size() == 1) return choice ? fit.front()->name : "";
  std::vector<std::string> has;
  for (const ToolSettings& tool : tools) has.push_back(CutterText(tool));
  const std::string corner =
      section.corner_radius > 0 ? fmt::format(" with corners of {:.6g} mm", section.corner_radius) : "";
  throw InputError(
      {file, section.first_line},
      fmt::format("section {} is for {}{}, and cell {} has {} tool with it; given {}: add it to the "
                  "cell's `tools` (docs/programs.md, \"Tools\")",
                  number, section.ToText(), corner, cell.name, fit.empty() ? "no" : "more than one",
                  fmt::join(has, ", ")));
}

std::string SplitIntoOperations(std::string_view job_yaml, const JobInputs& inputs) {
  const std::string& file = inputs.job.toolpath.strategy->File();
  const std::vector<CamSection> sections = WithoutNeedlessTools(SectionsOf(inputs), inputs.cell);
  if (sections.size() < 2)
    throw InputError({file}, "the path is for one tool at one speed: there is nothing to split");
  const yaml::Value root = yaml::ReadYaml(job_yaml, inputs.job.file);
  const yaml::Value* toolpath = root.Find("toolpath");
  const std::vector<std::string_view> lines = SplitLines(job_yaml);
  const auto [begin, end] = LinesOf(lines, "toolpath");
  if (!toolpath || begin == lines.size() || !toolpath->Find("cam"))
    throw InputError({inputs.job.file}, "toolpath: its own lines, at the beginning of a line, are needed");
  if (toolpath->Find("cam")->Find("section"))
    throw InputError({inputs.job.file}, "toolpath.cam.section: given; a job that is split names none");
  yaml::Value operations = yaml::Value::List();
  std::vector<Problem> problems;
  std::map<std::string, int> uses;
  for (size_t i = 0; i < sections.size(); ++i) try {
      const std::string tool = ToolOfSection(sections[i], i + 1, inputs.cell, file);
      operations.items.push_back(Operation(*toolpath, sections[i], i + 1, tool, OperationName(tool, uses),
                                           SpeedDiffers(sections[i], inputs.job.spindle_speed)));
    } catch (const InputError& error) {
      std::ranges::copy(error.problems(), std::back_inserter(problems));
    }
  if (!problems.empty()) throw InputError(std::move(problems));
  yaml::Value map = yaml::Value::Map();
  map.Put("operations", std::move(operations));
  const auto [tool_begin, tool_end] = LinesOf(lines, "tool");
  const yaml::Value* process = root.Find("process");
  const bool rewritten = process && std::ranges::all_of(sections, [&](const CamSection& section) {
                           return SpeedDiffers(section, inputs.job.spindle_speed);
                         });
  const auto [process_begin, process_end] =
      rewritten ? LinesOf(lines, "process") : std::pair(lines.size(), lines.size());
  std::string text;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (i == begin)
      text +=
          fmt::format("# One operation for each section of {}, in its order.\n", file) + yaml::WriteYaml(map);
    if (i == process_begin) text += WithoutSpeed(*process);
    if (i >= process_begin && i < process_end) continue;
    if ((i < begin || i >= end) && (i < tool_begin || i >= tool_end)) text += std::string(lines[i]) + '\n';
  }
  return text;
}

}  // namespace millpose
