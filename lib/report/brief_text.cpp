// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "base/counted.hpp"
#include "planning/result/skipped.hpp"
#include "report/report.hpp"

namespace millpose {
namespace {

constexpr size_t kMostLines = 12;
constexpr size_t kFindings = 3;  // told of more: two of them and how many follow

constexpr double kMuchAir = 0.05;  // of the cutting time: less is not worth a word

using Lines = std::vector<std::string>;

std::string Line(const std::string& word, const std::string& text) {
  return fmt::format("{:<10} {}", word, text);
}

void AddState(const PlanResult& plan, const ReportInputs& inputs, Lines& lines) {
  const PlanFigures figures = Figures(plan);
  const size_t ways_left = plan.gaps.size() - static_cast<size_t>(figures.gaps_planned);
  const bool whole = figures.planned == figures.total && ways_left == 0;
  std::string text = fmt::format("{} on {}: {} of {} points in {}", plan.job, plan.cell, figures.planned,
                                 figures.total, CountedPasses(plan.passes.size()));
  if (ways_left > 0)
    text += fmt::format(", {} of {} ways between them not planned", ways_left, plan.gaps.size());
  if (whole && !inputs.findings.empty())
    text += ", " + Counted(inputs.findings.size(), "finding", "findings");
  lines.push_back(Line(!whole ? "INCOMPLETE" : inputs.findings.empty() ? "done" : "FINDINGS", text));
}

/// Why points are skipped, and the first of them.
void AddSkipped(const PlanResult& plan, Lines& lines) {
  std::string text;
  for (const auto& [reason, count] : SkippedByReason(plan)) text += fmt::format("{} {}, ", count, reason);
  if (text.empty()) {
    for (const LinkMove& gap : plan.gaps)
      if (!gap.planned) return lines.push_back(Line("not planned", gap.detail));
    return;
  }
  size_t number = 0;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      if (point.skip != Infeasibility::kNone) {
        text += fmt::format("first point {} (pass {}): {}", number, pass.pass, point.detail);
        return lines.push_back(Line("skipped", text));
      }
      ++number;
    }
}

void AddPrograms(const ReportInputs& inputs, Lines& lines) {
  std::map<std::string, std::pair<int, std::string>>
      verdicts;  // files and what became of them, by controller
  for (const ReportedProgram& program : inputs.programs) {
    auto& [files, verdict] = verdicts[program.controller];
    files += program.verified ? 1 : 0;
    if (!program.verified)
      verdict = "WITHHELD";
    else if (verdict.empty())
      verdict = program.but_for
                    ? fmt::format("confirmed but for corners within {:.4f} mm", program.but_for->position)
                    : "confirmed";
  }
  Lines parts;
  for (const auto& [controller, known] : verdicts)
    parts.push_back(
        fmt::format("{} {} ({} file{})", controller, known.second, known.first, known.first == 1 ? "" : "s"));
  if (!parts.empty()) lines.push_back(Line("programs", fmt::format("{}", fmt::join(parts, ", "))));
}

void AddCycle(const ReportInputs& inputs, Lines& lines) {
  Lines parts;
  for (const ControllerTime& own : inputs.times)
    if (own.time.all.Total() > 0)
      parts.push_back(fmt::format("{} {}", ClockText(own.time.all.Total()), own.controller));
  if (parts.empty()) return;
  std::string text = fmt::format("{}", fmt::join(parts, ", "));
  if (inputs.stock && inputs.stock->air.nothing > kMuchAir * inputs.stock->air.cuts)
    text += "; " + AirText(inputs.stock->air);
  lines.push_back(Line("cycle", text));
}

}  // namespace

void TellSome(const std::string& word, const std::vector<std::string>& sentences, size_t room,
              std::vector<std::string>& lines, const std::string& all) {
  if (sentences.empty() || room == 0) return;
  const size_t shown = sentences.size() <= room ? sentences.size() : room - 1;
  for (size_t i = 0; i < shown; ++i) lines.push_back(Line(word, sentences[i]));
  if (shown < sentences.size())
    lines.push_back(Line(word, fmt::format("{} {}: plan -v or report.html", sentences.size() - shown,
                                           shown > 0 ? "more" : all)));
}

std::string BriefText(const PlanResult& plan, const ReportInputs& inputs, const std::string& folder) {
  const PlanFigures figures = Figures(plan);
  Lines lines;
  AddState(plan, inputs, lines);
  AddSkipped(plan, lines);
  AddPrograms(inputs, lines);
  AddCycle(inputs, lines);
  if (figures.clearance_min)
    lines.push_back(Line("clearance", fmt::format("at least {:.1f} mm", *figures.clearance_min)));
  if (figures.planned > 0 && inputs.budget) lines.push_back(Line("face", BudgetBrief(*inputs.budget)));
  TellSome("finding", inputs.findings, kFindings, lines);
  TellSome("warning", inputs.warnings, kMostLines - 1 - lines.size(), lines, "warnings");
  lines.push_back(Line("report", (std::filesystem::path(folder) / "report.html").string()));
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

}  // namespace millpose
