// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/setup_of_folder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "base/angles.hpp"
#include "base/counted.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "job/assemble.hpp"
#include "job/config/setup_names.hpp"
#include "job/first_run.hpp"
#include "job/step_meshes.hpp"
#include "job/workpiece.hpp"
#include "planning/result/cycle_time.hpp"
#include "planning/result/station.hpp"
#include "report/budget_json.hpp"
#include "report/setup_sheet.hpp"
#include "report/view_mesh.hpp"
#include "run/pipeline/commands/operation_json.hpp"
#include "run/pipeline/commands/setup_views.hpp"

namespace millpose {
namespace {

using JsonTree = nlohmann::json;
using Eigen::Vector3d;

/// Three numbers to `digits` decimals; no -0.
std::string Three(const Vector3d& v, int digits) {
  const double scale = digits == 2 ? 100 : 1000;
  const auto rounded = [&](double x) { return std::round(x * scale) / scale + 0.0; };
  return fmt::format("{0:.{3}f}, {1:.{3}f}, {2:.{3}f}", rounded(v.x()), rounded(v.y()), rounded(v.z()),
                     digits);
}
std::string Place(const Vector3d& p) { return Three(p, 2); }
std::string Turned(const Pose& X) { return Three(kDegPerRad * AnglesZyx(X.linear()), 3); }

SheetSection SummaryOf(const std::vector<OperationWithTree>& operations) {
  SheetSection section{.title = "Summary"};
  section.table.columns = {"operation",          "tool",           "milled", "cycle, h:min:s",
                           "least distance, mm", "face off by, µm"};
  section.table.names = 2;
  for (const OperationWithTree& one : operations) {
    const JsonTree& points = one.json.at("points");
    std::vector<std::string> times;
    for (const JsonTree& time : one.json.at("cycle_times"))
      times.push_back(fmt::format("{} {}", ClockText(time.at("total_s").get<double>()),
                                  time.at("controller").get<std::string>()));
    const JsonTree& clearance = one.json.at("clearance_min_mm");
    const JsonTree& budget = one.json.at("budget");  // null where no face is cut
    const double sum = budget.is_object() ? budget.at("sum_um").get<double>() : 0;
    section.table.rows.push_back(
        {one.name, one.inputs.cell.tool.name,
         fmt::format("{} of {} points in {}", points.at("planned").get<size_t>(),
                     points.at("total").get<size_t>(), CountedPasses(one.plan.passes.size())),
         fmt::format("{}", fmt::join(times, "; ")),
         clearance.is_number() ? fmt::format("{:.1f}", clearance.get<double>()) : "-",
         sum > 0 ? fmt::format("{:.3g}", sum) : "-"});
  }
  return section;
}

/// Sentences of the summaries, those of operations with their names; each once.
SheetSection Sentences(const std::vector<OperationWithTree>& operations, const char* key, const char* title) {
  SheetSection section{.title = title};
  for (const OperationWithTree& one : operations)
    for (const JsonTree& sentence : one.json.at(key)) {
      const std::string text = sentence.get<std::string>();
      section.list.push_back(operations.size() > 1 ? one.name + ": " + text : text);
    }
  return section;
}

SheetSection Sources(const std::vector<OperationWithTree>& operations) {
  SheetSection section{.title = "What the face may be off by"};
  section.note =
      "Along its normal, source by source, each at its largest; what is not stated is not in the sum.";
  section.table.columns = {"operation", "source", "µm", "what the figure is of"};
  section.table.names = 1;
  for (const OperationWithTree& one : operations)
    for (const BudgetRow& row : ReadBudget(one.json).value_or(Budget{}).rows)
      section.table.rows.push_back({one.name, row.name,
                                    row.largest ? fmt::format("{:.3g}", 1e3 * *row.largest) : "not stated",
                                    row.basis});
  return section;
}

SheetSection Datum(const OperationWithTree& first) {
  const JobSettings& job = first.inputs.job;
  const PlanResult& plan = first.plan;
  SheetSection section{.title = "Datum"};
  const char* frame = job.workpiece.frame == GivenFrame::kWorld ? "the cell" : "the robot's base";
  const Pose X_BP = plan.X_WB.inverse() * plan.X_WP;
  section.table.columns = {"frame", "in", "X, Y, Z, mm", "A, B, C (Z, Y', X''), deg"};
  section.table.rows = {{"part", "the robot's base", Place(X_BP.translation()), Turned(X_BP)},
                        {"part", "the cell", Place(plan.X_WP.translation()), Turned(plan.X_WP)},
                        {"robot's base", "the cell", Place(plan.X_WB.translation()), Turned(plan.X_WB)}};
  if (!plan.external_axes.empty()) section.note = "With all external axes at 0. ";
  if (!job.workpiece.targets.empty()) {
    section.note += fmt::format("Measured by {} targets, given in {}: ", job.workpiece.targets.size(), frame);
    std::vector<std::string> targets;
    for (const TargetSettings& target : job.workpiece.targets)
      targets.push_back("(" + Place(target.nominal) + ")");
    section.note += fmt::format("{} mm on the part.", fmt::join(targets, ", "));
  } else if (job.workpiece.registered) {
    const JsonTree& known = first.json.contains("registration") ? first.json.at("registration") : JsonTree();
    section.note += "Registered by probed points";
    if (known.is_object())
      section.note += fmt::format("; for that the face may be off by {:.3g} µm (95 %)",
                                  known.at("face_um_95").get<double>());
    section.note += ".";
  } else {
    section.note += fmt::format(
        "The pose is the job's own, given in {}: nobody has measured it. `millpose register` does.", frame);
    std::erase(section.note, '`');
  }
  return section;
}

/// How long the tool's parts of each class are together, from the tip upwards.
std::string LengthsOf(const ToolSettings& tool) {
  std::vector<std::string> lengths;
  for (const BodyClass part : {BodyClass::kCutter, BodyClass::kHolder, BodyClass::kSpindle}) {
    double length = 0;
    for (const ToolPartSettings& own : tool.stack)
      if (own.body_class == part) length += own.length;
    lengths.push_back(length > 0 ? fmt::format("{:.6g}", length) : "-");
  }
  return fmt::format("{}", fmt::join(lengths, ", "));
}

/// Tools in the order in which they are asked for, each once.
SheetSection ToolsOf(const std::vector<OperationWithTree>& operations) {
  SheetSection section{.title = "Tools"};
  section.table.columns = {"tool",
                           "number",
                           "cutter, mm",
                           "length of cutter, holder, spindle, mm",
                           "tip in the flange, mm",
                           "spindle, 1/min",
                           "feed, mm/min",
                           "load, kg",
                           "tip known to, mm"};
  section.table.names = 1;
  std::set<std::string> told;
  for (const OperationWithTree& one : operations) {
    const ToolSettings& tool = one.inputs.cell.tool;
    if (!told.insert(tool.name).second) continue;
    std::string cutter =
        fmt::format("{} Ø {:.6g}", WordOf(kCutterTipWords, tool.cutter_tip), tool.cutter_diameter);
    if (tool.cutter_tip == CutterTip::kBull) cutter += fmt::format(", r {:.6g}", tool.corner_radius);
    cutter += fmt::format(", cuts on {:.6g}", tool.cutting_length);
    const double turns =
        60 * (one.plan.spindle_speed > 0 ? one.plan.spindle_speed : one.inputs.job.spindle_speed);
    section.table.rows.push_back(
        {tool.name, tool.number ? std::to_string(*tool.number) : "-", cutter, LengthsOf(tool),
         Place(tool.tip), turns > 0 ? fmt::format("{:.6g}", turns) : "not stated",
         fmt::format("{:.6g}", 60 * one.inputs.job.feed),
         tool.load ? fmt::format("{:.6g}", tool.load->mass) : "not stated",
         tool.tip_uncertainty ? fmt::format("{:.3g}", *tool.tip_uncertainty) : "not stated"});
  }
  return section;
}

SheetSection AxisPositions(const std::vector<OperationWithTree>& operations) {
  SheetSection section{.title = "External axes"};
  section.table.columns = {"operation", "passes", "stand at"};
  section.table.names = 1;
  for (const OperationWithTree& one : operations) {
    if (one.plan.external_axes.empty()) continue;
    // Neighbouring passes at one station share a row.
    for (size_t p = 0; p < one.plan.passes.size();) {
      size_t end = p + 1;
      while (end < one.plan.passes.size() && one.plan.passes[end].external == one.plan.passes[p].external)
        ++end;
      section.table.rows.push_back({one.name,
                                    end == p + 1 ? fmt::format("{}", p) : fmt::format("{} to {}", p, end - 1),
                                    PositionText(one.plan.external_axes, one.plan.passes[p].external)});
      p = end;
    }
  }
  return section;
}

/// What stands in the cell beside arm and tool, in the robot's base.
SheetSection Holding(const Cell& cell) {
  SheetSection section{.title = "What stands around the part"};
  section.note =
      "Bodies that the plan keeps clear of; where the middle of each stands, as seen from the robot's base.";
  section.table.columns = {"body", "kind", "X, Y, Z, mm", "size, mm"};
  section.table.names = 1;
  const Pose X_BW = cell.X_WB.inverse();
  for (const Body& body : cell.bodies) {
    if (body.mount == Mount::kLink || body.mount == Mount::kTool || body.body_class == BodyClass::kWorkpiece)
      continue;
    Eigen::AlignedBox3d own;
    for (const Vector3d& p : ViewMesh(body.shape).vertices) own.extend(p);
    const Pose X_WM = body.mount == Mount::kWorkpiece ? cell.X_WP : Pose::Identity();
    const Vector3d size = own.sizes();
    section.table.rows.push_back({body.name, WordOf(kBodyClassWords, body.body_class),
                                  Place(X_BW * (X_WM * (body.X_MG * own.center()))),
                                  fmt::format("{:.4g} × {:.4g} × {:.4g}", size.x(), size.y(), size.z())});
  }
  return section;
}

SheetSection ProgramsOf(const ReportedFolder& folder) {
  SheetSection section{.title = "Programs, in the order of the work"};
  section.table.columns = {"operation", "controller", "file", "read back"};
  for (const FolderProgram& program : ProgramsIn(folder))
    section.table.rows.push_back({program.operation, program.controller, program.path, program.read_back});
  return section;
}

/// Before the first run: what each controller asks for, once for all operations.
void AddFirstRuns(const std::vector<OperationWithTree>& operations, SetupSheet& sheet) {
  std::map<std::string, SheetSection> by_controller;
  for (const OperationWithTree& one : operations)
    for (const std::string& controller : one.inputs.job.programs) {
      SheetSection& section = by_controller[controller];
      section.title = "Before a first run: " + controller;
      for (const auto& [what, how] : FirstRunSteps(one.inputs, controller)) {
        const std::string step = fmt::format("{}: {}", what, how);
        if (std::ranges::find(section.steps, step) == section.steps.end()) section.steps.push_back(step);
      }
    }
  for (auto& [controller, section] : by_controller) sheet.sections.push_back(std::move(section));
}

/// The operations of each setup in a row, those of a job without setups in one.
std::vector<std::span<const OperationWithTree>> BySetup(const std::vector<OperationWithTree>& operations,
                                                        const std::vector<std::string>& setups) {
  std::vector<std::span<const OperationWithTree>> groups;
  for (size_t i = 0; i < operations.size(); ++i) {
    if (i == 0 || setups[i] != setups[i - 1]) groups.push_back({&operations[i], 0});
    groups.back() = {groups.back().data(), groups.back().size() + 1};
  }
  return groups;
}

/// Pictures and datum of each setup.
void AddSetups(const std::vector<OperationWithTree>& operations, const std::vector<std::string>& setups,
               const Mesh& part, Language language, std::vector<SheetSection>& sections) {
  size_t first = 0;
  for (const std::span<const OperationWithTree> group : BySetup(operations, setups)) {
    std::vector<SheetSection> own = SetupViews(group, MakeJobCell(group.front().inputs), part, language);
    own.push_back(Datum(group.front()));
    for (SheetSection& section : own) {
      if (!setups[first].empty()) section.note = fmt::format("Setup {}. {}", setups[first], section.note);
      sections.push_back(std::move(section));
    }
    first += group.size();
  }
}

/// What stands around the part in each setup: a job may give each its own fixtures.
void AddHolding(const std::vector<OperationWithTree>& operations, const std::vector<std::string>& setups,
                std::vector<SheetSection>& sections) {
  size_t first = 0;
  for (const std::span<const OperationWithTree> group : BySetup(operations, setups)) {
    SheetSection section = Holding(MakeJobCell(group.front().inputs));
    if (!setups[first].empty()) section.note = fmt::format("Setup {}. {}", setups[first], section.note);
    sections.push_back(std::move(section));
    first += group.size();
  }
}

}  // namespace

std::string SetupOfFolder(const SetupArguments& arguments, std::stop_token stop) {
  const ReportedFolder folder = ReadReportedFolder(arguments);
  std::vector<OperationWithTree> operations;
  for (const FolderOperation& one : folder.operations) operations.emplace_back(one);
  const bool several = folder.several;
  JobInputs& inputs = operations.front().inputs;
  CutStepFiles(
      &inputs, [](int) {}, stop);
  const Cell cell = MakeJobCell(inputs);
  const Part part = ReadPart(inputs, cell);
  SetupSheet sheet;
  try {
    const OperationWithTree& first = operations.front();
    sheet.title = folder.job + ": setup sheet";
    sheet.subtitle = SubtitleOf(folder);
    std::vector<std::string> setups(operations.size());
    if (several) setups = SetupNames(arguments.root.Read(arguments.plan / "job.yaml"), "job.yaml");
    std::vector<SheetSection> sections = {SummaryOf(operations),
                                          Sentences(operations, "findings", "Findings"), Sources(operations)};
    AddSetups(operations, setups, part.import.mesh, arguments.language, sections);
    sections.push_back(ToolsOf(operations));
    sections.push_back(AxisPositions(operations));
    AddHolding(operations, setups, sections);
    sections.push_back(ProgramsOf(folder));
    for (SheetSection& section : sections) {
      if (!section.table.rows.empty() || !section.list.empty() || !section.picture.empty())
        sheet.sections.push_back(std::move(section));
    }
    AddFirstRuns(operations, sheet);
    for (const OperationWithTree& one : operations)
      sheet.appendix.emplace_back(several ? one.name + "/job.yaml" : "job.yaml", one.inputs.job_text);
    sheet.appendix.emplace_back("cell.yaml", first.inputs.cell.text);
  } catch (const JsonTree::exception&) {
    throw InputError({(arguments.plan / "summary.json").string()}, "is no summary that millpose plan wrote");
  }
  return SetupSheetHtml(sheet, arguments.language);
}

}  // namespace millpose
