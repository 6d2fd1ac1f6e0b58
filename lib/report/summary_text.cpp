// SPDX-License-Identifier: GPL-3.0-or-later
#include <iterator>

#include "base/counted.hpp"
#include "base/units.hpp"
#include "planning/result/skipped.hpp"
#include "report/face_choices_json.hpp"
#include "report/fixed_figures.hpp"
#include "report/price_text.hpp"
#include "report/report.hpp"

namespace millpose {
namespace {

constexpr size_t kShown = 8;  // of each list: the rest stands in summary.json

void AppendSpread(const char* name, const std::optional<Spread>& spread, const std::string& unit,
                  std::string* text) {
  if (!spread) return;
  fmt::format_to(std::back_inserter(*text), "  {:<10} {:>11.4e} {:>11.4e} {:>11.4e}  {}\n", name,
                 spread->best, spread->median, spread->worst, unit);
}

std::string Verdict(const ReportedProgram& program) {
  if (!program.verified) return "withheld";
  if (!program.but_for) return "read back and confirmed";
  return fmt::format("read back and confirmed but for the corner's path, bounded by {:.4f} mm",
                     program.but_for->position);
}

void AppendLinkMoveRemarks(const PlanResult& plan, std::string* text) {
  size_t remarks = 0;
  for (size_t i = 0; i < plan.gaps.size(); ++i) {
    const LinkMove& gap = plan.gaps[i];
    if (!gap.detail.empty() && remarks++ < kShown)
      fmt::format_to(std::back_inserter(*text), "  gap {}{}: {}\n", i, gap.planned ? "" : " not planned",
                     gap.detail);
  }
  if (remarks > kShown)
    fmt::format_to(std::back_inserter(*text), "  … and {} more, all in summary.json\n", remarks - kShown);
}

void AppendSkipped(const PlanResult& plan, std::string* text) {
  const std::map<std::string, size_t> by_reason = SkippedByReason(plan);
  if (by_reason.empty()) return;
  size_t number = 0, shown = 0, skipped = 0;
  std::string rows;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      if (point.skip != Infeasibility::kNone) {
        ++skipped;
        if (shown++ < kShown)
          fmt::format_to(std::back_inserter(rows), "  point {} (pass {}): {}: {}\n", number, pass.pass,
                         ToString(point.skip), point.detail);
      }
      ++number;
    }
  *text += "skipped   ";
  for (const auto& [reason, count] : by_reason)
    fmt::format_to(std::back_inserter(*text), " {} {}", count, reason);
  *text += "\n" + rows;
  if (skipped > kShown)
    fmt::format_to(std::back_inserter(*text), "  … and {} more, all in summary.json\n", skipped - kShown);
}

void AppendPaper(const PaperFigures& paper, std::string* text) {
  fmt::format_to(std::back_inserter(*text),
                 "paper's formulation: {} of {} points meet 0.1 mm and 0.1 deg, {} of them admissible on the "
                 "exact pose, {} on the path; errors at worst {:.3g} mm, {:.3g} deg\n",
                 paper.within_tolerance, paper.searched, paper.usable, paper.on_path,
                 paper.position_error.worst, RadToDeg(paper.angle_error.worst));
  if (paper.above_exhaustive)
    fmt::format_to(std::back_inserter(*text),
                   "  where met, {:+.2f} % to {:+.2f} % against the point's own optimum, median {:+.2f} %\n",
                   100 * paper.above_exhaustive->best, 100 * paper.above_exhaustive->worst,
                   100 * paper.above_exhaustive->median);
}

void AppendDeflection(const DeflectionReport& report, std::string* text) {
  const auto out = std::back_inserter(*text);
  if (report.face)
    fmt::format_to(out,
                   "deflection of the finished face along its normal: level {:.3g} µm, variation {:.3g} µm, "
                   "step between passes {:.3g} µm\n",
                   1e3 * report.face->level, 1e3 * report.face->variation, 1e3 * report.face->largest_step);
  fmt::format_to(out, "  under a mean force of at most {:.1f} N (peak {:.1f} N): {}\n",
                 report.force.mean.norm(), report.force.peak, kDeflectionModel);
}

void AppendFixed(const FixedComparison& fixed, bool known, std::string* text) {
  const auto out = std::back_inserter(*text);
  for (const auto& [name, choice] : NamedChoices(fixed)) {
    fmt::format_to(out, "against    {}, plan / fixed:\n", name);
    for (const FixedFigure& figure : FixedFigures(fixed.plan, choice->figures))
      fmt::format_to(out, "  {:<10} {}\n", figure.label, FixedRatios(figure));
    fmt::format_to(out, "  {}\n", FixedReversals(fixed.plan_gears, choice->gears, known));
  }
  if (!fixed.job.Exists())
    fmt::format_to(out, "against    no single rotation does the job: {}\n", fixed.job_in_the_way);
  if (!fixed.passes.Exists())
    fmt::format_to(out, "against    no rotation of its own does each pass: {}\n", fixed.passes_in_the_way);
}

}  // namespace

std::string SummaryText(const PlanResult& plan, const ReportInputs& inputs, const RunFigures& run) {
  const PlanFigures figures = Figures(plan);
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "job {} on {} ({})\n", plan.job, plan.cell, plan.arm.name);
  fmt::format_to(out, "points     {} planned of {}, {} skipped\n", figures.planned, figures.total,
                 figures.total - figures.planned);
  fmt::format_to(out, "passes     {} in {}\n", plan.passes.size(),
                 Counted(figures.pieces, "piece", "pieces"));
  fmt::format_to(out, "gaps       {} planned of {}\n", figures.gaps_planned, plan.gaps.size());
  AppendLinkMoveRemarks(plan, &text);
  AppendSkipped(plan, &text);
  if (figures.planned > 0) {
    fmt::format_to(out, "stiffness at the {}; compliance, smaller is stiffer\n",
                   plan.stiffness_origin == StiffnessOrigin::kFlange ? "flange centre" : "tool tip");
    fmt::format_to(out, "  {:<10} {:>11} {:>11} {:>11}\n", "", "best", "median", "worst");
  }
  AppendSpread("lambda_t1", figures.lambda_t1, "mm/N  larger semi-axis in the milling plane", &text);
  AppendSpread("lambda_t2", figures.lambda_t2, "mm/N  smaller semi-axis in the milling plane", &text);
  AppendSpread("lambda_n", figures.lambda_n, "mm/N  radius along the normal", &text);
  AppendSpread("objective", figures.objective, plan.objective_unit + "  " + plan.objective_name, &text);
  if (figures.planned > 0 && figures.price) {
    const std::vector<std::string> lines = PriceLines(*figures.price);
    for (size_t i = 0; i < lines.size(); ++i)
      fmt::format_to(out, "{:<10} {}\n", i == 0 ? "price" : "", lines[i]);
  }
  if (figures.planned > 0 && inputs.continuity) {
    const ContinuityFigures& c = *inputs.continuity;
    int fastest = 0, jerkiest = 0;
    c.speed_share.maxCoeff(&fastest);
    c.acceleration_share.maxCoeff(&jerkiest);
    fmt::format_to(
        out, "joints     at most {:.1f} % of the speed (A{}) and {:.1f} % of the acceleration (A{}){}\n",
        100 * c.speed_share[fastest], fastest + 1, 100 * c.acceleration_share[jerkiest], jerkiest + 1,
        plan.arm.acceleration_assumed ? ", which is assumed" : "");
    if (figures.acceleration_ratio)
      fmt::format_to(
          out, "smoothing  joint accelerations (RMS) at {:.1f} % of before, for {:.2f} % of the objective\n",
          100 * *figures.acceleration_ratio, 100 * figures.smoothing_loss.value_or(0));
    if (inputs.feed_reduction.points > 0)
      fmt::format_to(out, "feed       reduced at {} points, to {:.1f} mm/min at the least\n",
                     inputs.feed_reduction.points, 60 * inputs.feed_reduction.least);
  }
  if (figures.paper) AppendPaper(*figures.paper, &text);
  if (inputs.deflection) AppendDeflection(*inputs.deflection, &text);
  if (inputs.registration)
    fmt::format_to(std::back_inserter(text),
                   "registration: the face may be off by {:.0f} µm along its normal (95 %){}\n",
                   1e3 * inputs.registration->off_95,
                   inputs.registration->bent
                       ? fmt::format("; it is planned as bent by up to {:.3f} mm", *inputs.registration->bent)
                       : "");
  if (inputs.compensation) text += CompensationText(*inputs.compensation);
  if (figures.planned > 0 && inputs.lost_motion)
    fmt::format_to(out, "reversals  {}\n", LostMotionText(plan, *inputs.lost_motion));
  if (!inputs.faces.empty()) fmt::format_to(out, "face       {}\n", FaceChoicesText(inputs.faces));
  if (figures.planned > 0 && inputs.budget)
    fmt::format_to(out, "budget     {}\n", BudgetText(*inputs.budget));
  if (figures.planned > 0 && inputs.fixed)
    AppendFixed(*inputs.fixed, inputs.lost_motion && inputs.lost_motion->Known(), &text);
  if (inputs.face) text += FaceText(*inputs.face);
  fmt::format_to(out, "interference {} poses checked; {} of {} candidates never had to be\n",
                 figures.poses_checked, figures.candidates - figures.candidates_checked, figures.candidates);
  if (figures.clearance_min) fmt::format_to(out, "clearance  at least {:.1f} mm\n", *figures.clearance_min);
  for (const ReportedProgram& program : inputs.programs)
    fmt::format_to(out, "program    {} ({}; {} points left out that its motions pass)\n", program.path,
                   Verdict(program), program.points_saved);
  for (const ProgramSize& size : inputs.program_sizes)
    fmt::format_to(
        out, "size       {}: {} kB in {} file{}{}\n", size.controller, (size.bytes + 500) / 1000, size.files,
        size.files == 1 ? "" : "s",
        size.memory > 0 ? fmt::format(", of {} kB (program_memory_kbytes)", size.memory / 1000) : "");
  for (const ControllerTime& program : inputs.times)
    fmt::format_to(out, "cycle      {} {}\n", program.controller, TimeText(program.time.all));
  if (inputs.stock)
    fmt::format_to(out, "stock      {:.1f} of {:.1f} cm3 milled off; {}\n", inputs.stock->removed / 1e3,
                   inputs.stock->blank / 1e3, AirText(inputs.stock->air));
  for (const PathSpeed& speed : inputs.path_speeds)
    fmt::format_to(out, "speed      {}: estimated at no less than {:.0f} % of the feed along the cuts\n",
                   speed.controller, 100 * speed.lowest_share);
  if (inputs.base_window)
    fmt::format_to(
        out, "base       may be shifted by {:.3f} mm and turned by {:.4f} deg together with the part{}\n",
        inputs.base_window->shift, RadToDeg(inputs.base_window->turn),
        inputs.base_window->obstacle.empty() ? "" : "; no more: " + inputs.base_window->obstacle);
  for (const std::string& warning : inputs.warnings) fmt::format_to(out, "warning    {}\n", warning);
  for (const std::string& finding : inputs.findings) fmt::format_to(out, "finding    {}\n", finding);
  if (inputs.audit)
    fmt::format_to(
        out,
        "audit      genetic algorithm within 0.1 % at {:.2f} % of the points (worst {:.3f} %), {} limit "
        "violations, {} contacts, {} clearances not kept, {:.1e} mm off the mesh\n",
        inputs.audit->ga_share_within_0p1_percent, inputs.audit->ga_worst_gap_percent,
        inputs.audit->limit_violations, inputs.audit->interferences, inputs.audit->clearance_violations,
        inputs.audit->max_slice_distance_mm);
  fmt::format_to(out, "time       {:.1f} s:", run.wall_s);
  for (const RunFigures::Stage& stage : run.stages)
    fmt::format_to(out, " {} {:.1f}", stage.name, stage.wall_s);
  text += "\n";
  return text;
}

}  // namespace millpose
