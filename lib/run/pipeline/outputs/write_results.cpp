// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/outputs/write_results.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include "job/assemble.hpp"
#include "job/config/config.hpp"
#include "job/geometry_error.hpp"
#include "job/registration_error.hpp"
#include "planning/result/write_plan.hpp"
#include "program/verify/causes.hpp"
#include "run/pipeline/programs/program_warnings.hpp"
#include "toolpath/pass_ends.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr size_t kExamples = 4;  // of each cause: the rest says the same

// How many motions of a program end on points of each pass.
std::vector<int> MotionsPerPass(const CheckedProgram& program, size_t passes) {
  std::vector<int> counts(passes, 0);
  for (const int pass : program.pass_of_motion)
    if (pass >= 0) ++counts.at(static_cast<size_t>(pass));
  return counts;
}

std::string ExplainFeed(const ContinuityFigures& continuity, const std::vector<ExternalAxis>& external) {
  const FeedFinding& first = continuity.feed_not_held.front();
  return fmt::format(
      "the feed cannot be held at {} points; first at point {} (pass {}): the {} of {} allows {:.1f} of "
      "{:.1f} "
      "mm/min; `process.feed: reduce` runs such points as fast as the joints can",
      continuity.feed_not_held.size(), first.point, first.pass,
      first.by_acceleration ? "acceleration" : "speed", AxisName(external, first.joint),
      60 * first.feed_possible, 60 * first.feed);
}

// Where reduced feeds fall far below the programmed one: below the job's least share a finding, else a
// warning.
void ExplainSlow(const FeedReduction& reduction, const std::vector<ExternalAxis>& external,
                 double least_share, ReportInputs& report) {
  constexpr size_t kTold = 8;  // of each, the slowest
  std::vector<SlowStretch> slow = reduction.slow;
  std::ranges::stable_sort(slow, {}, &SlowStretch::Share);
  std::array<size_t, 2> told{};
  for (const SlowStretch& s : slow) {
    const bool rubs = s.Share() < least_share;
    std::vector<std::string>& list = rubs ? report.findings : report.warnings;
    if (++told[rubs] > kTold) continue;
    list.push_back(fmt::format(
        "the feed falls to {:.0f} % ({:.1f} of {:.1f} mm/min) at point{} of pass {}: the {} of {} allows no "
        "more{}",
        100 * s.Share(), 60 * s.feed, 60 * s.wanted,
        s.first == s.last ? fmt::format(" {}", s.first) : fmt::format("s {} to {}", s.first, s.last), s.pass,
        s.by_acceleration ? "acceleration" : "speed", AxisName(external, s.joint),
        rubs ? fmt::format("; below {:.0f} % (`process.min_feed_share`) the edge rubs and the force model no "
                           "longer holds; a lower `process.feed_mm_min` or a smaller "
                           "`path.joint_speed_share` helps",
                           100 * least_share)
             : ""));
  }
  for (const bool rubs : {false, true})
    if (told[rubs] > kTold)
      (rubs ? report.findings : report.warnings)
          .push_back(fmt::format("the feed falls like this in {} stretches more", told[rubs] - kTold));
}

/// The texts of programs, which stand where they were made.
using FilesByPath = std::map<std::string, const std::string*>;

// What pieces cannot be started by themselves, and the files of the others.
void AddStarts(const JobStarts& starts, ReportInputs& report, FilesByPath& files) {
  for (const auto& [controller, programs] : starts.programs)
    for (const StartProgram& start : programs) {
      if (start.Confirmed()) {
        for (const auto& [name, bytes] : start.files)
          files[fmt::format("{}/{}/{}", controller, kStarts, name)] = &bytes;
        continue;
      }
      const std::string what = fmt::format("{}: pass {} piece {} cannot be started by itself: ", controller,
                                           start.pass, start.piece);
      if (!start.obstacle.empty())
        report.warnings.push_back(what + start.obstacle);
      else
        report.findings.push_back(what + Describe(GroupByCause(start.findings).front()));
    }
}

// Splits whose parts could not overlap.
std::string ExplainUncut(const PassResult& pass) {
  std::vector<std::string> steps;
  for (const int t : pass.uncut) {
    const Eigen::Vector3d& p = pass.points[static_cast<size_t>(t)].point.position;
    steps.push_back(fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x(), p.y(), p.z()));
  }
  return fmt::format(
      "pass {} is split and not cut from the point at {} to the next: no pose of either part reaches over",
      pass.pass, fmt::join(steps, ", "));
}

// Lifts that were made because they pay.
std::string ExplainLifts(const PassResult& pass) {
  std::vector<std::string> places;
  for (const int piece : pass.lifts) {
    const int first = pass.pieces[static_cast<size_t>(piece)].first;
    const Eigen::Vector3d& p = pass.points[static_cast<size_t>(first)].point.position;
    places.push_back(fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x(), p.y(), p.z()));
  }
  return fmt::format(
      "pass {} is lifted and entered again at {}: that gains {:.1f} % of its objective; a step in the "
      "surface "
      "may show there (docs/lifts.md)",
      pass.pass, fmt::join(places, ", "), 100 * pass.lift_gain);
}

// What a confirmed program leaves open.
std::optional<ReportedBound> ButForOf(const CheckedProgram& program) {
  if (!program.but_for || !program.Confirmed()) return std::nullopt;
  return ReportedBound{program.but_for->position, program.but_for->angle, program.but_for->assumption};
}

// The causes of a program that is withheld, each with what cures it and the first places.
void ExplainCauses(const CheckedProgram& program, std::vector<std::string>& sentences) {
  for (const CauseGroup& group : GroupByCause(program.findings)) {
    sentences.push_back(fmt::format("{}: {}; what helps: {}", program.controller, Describe(group),
                                    Cure(group.cause, program.controller)));
    size_t shown = 0;
    for (const Finding& finding : program.findings) {
      if (finding.cause != group.cause || finding.count > 1 || shown == kExamples) continue;
      ++shown;
      sentences.push_back(
          fmt::format("{} {}:{}: {}", program.controller, finding.file, finding.line, finding.message));
    }
    if (group.count > shown)
      sentences.push_back(fmt::format("{}: {} more like these", program.controller, group.count - shown));
  }
}

// What is withheld comes first, then why.
std::vector<std::string> Explain(const PlanResult& plan, const std::vector<CheckedProgram>& programs) {
  std::vector<std::string> sentences;
  const std::string obstacle = WhyNotProgrammable(plan);
  if (!obstacle.empty()) sentences.push_back("no program was written: " + obstacle);
  for (const CheckedProgram& program : programs)
    if (!program.Confirmed()) sentences.push_back(program.WhyWithheld());
  for (const CheckedProgram& program : programs) ExplainCauses(program, sentences);
  for (const PassResult& pass : plan.passes)
    if (!pass.uncut.empty()) sentences.push_back(ExplainUncut(pass));
  return sentences;
}

}  // namespace

std::optional<ToolUncertainty> UncertaintyOf(const ToolSettings& tool) {
  if (!tool.tip_uncertainty && !tool.axis_uncertainty) return std::nullopt;
  return ToolUncertainty{tool.tip_uncertainty.value_or(0), tool.axis_uncertainty.value_or(0),
                         tool.cutter_diameter / 2};
}

ReportInputs WriteResults(const Results& results, ResultSet& set) {
  const PlanResult& plan = results.plan;
  const std::vector<CheckedProgram>& programs = results.programs.programs;
  ReportInputs report;
  report.base_window = results.programs.base_window;
  report.audit = results.audit;
  report.warnings = results.warnings;
  report.findings = Explain(plan, programs);
  for (const PassResult& pass : plan.passes)
    if (!pass.stripe.empty()) report.warnings.push_back(fmt::format("pass {}: {}", pass.pass, pass.stripe));
  for (const PassResult& pass : plan.passes)
    if (!pass.lifts.empty()) report.warnings.push_back(ExplainLifts(pass));
  report.findings.insert(report.findings.end(), results.findings.begin(), results.findings.end());
  report.continuity = AnalyseContinuity(plan);
  report.feed_reduction = results.reduction;
  for (const CheckedProgram& program : programs) {
    report.times.push_back({program.controller, program.time});
    if (program.speed) report.path_speeds.push_back(*program.speed);
    if (program.but_for && program.Confirmed())
      report.warnings.push_back(program.controller +
                                ": confirmed but for a stated gap: " + Describe(*program.but_for));
    for (const std::string& warning : program.warnings)
      report.warnings.push_back(program.controller + ": " + warning);
  }
  ExplainSlow(results.reduction, plan.external_axes, results.inputs.job.min_feed_share, report);
  if (results.inputs.job.feed_policy == FeedPolicy::kKeep && !report.continuity->feed_not_held.empty())
    report.findings.push_back(ExplainFeed(*report.continuity, plan.external_axes));
  if (results.heaviest)
    report.deflection = PredictDeflections(plan, *results.heaviest, MakeCompliances(results.inputs.cell),
                                           FinishedFrom(results.inputs.job, plan.passes.size()),
                                           {0.01 * results.inputs.job.force_uncertainty_percent,
                                            DegToRad(results.inputs.job.force_direction_deg)});
  // Holes are no face: neither level nor variation says something of them.
  if (report.deflection && results.inputs.job.toolpath.strategy->DrillPoint())
    report.deflection->face.reset();
  if (report.deflection && results.inputs.job.cutting)
    report.deflection->source = results.inputs.job.cutting->kc11_source;
  report.compensation = FiguresOfCompensation(plan);
  if (report.compensation) report.compensation->remains = results.compensation_remains;
  for (const CheckedProgram& program : programs)
    if (report.compensation && program.under_load)
      report.compensation->programs.push_back({program.controller, program.under_load->largest});
  report.stock = results.stock;
  report.registration =
      ErrorOfRegistration(results.inputs.job, plan, FinishedFrom(results.inputs.job, plan.passes.size()));
  if (report.registration)
    if (const std::string finding = RegistrationFinding(*report.registration); !finding.empty())
      report.findings.push_back(finding);
  if (const std::string warning = RegistrationWarning(results.inputs.job); !warning.empty())
    report.warnings.push_back(warning);
  report.lost_motion =
      ReportLostMotion(plan, MakeGearModel(results.inputs.cell), results.inputs.cell.arm.lost_motion_source,
                       FinishedFrom(results.inputs.job, plan.passes.size()));
  const std::optional<GeometryFigures> geometry =
      ErrorOfGeometry(results.inputs.cell.arm, plan, FinishedFrom(results.inputs.job, plan.passes.size()),
                      results.inputs.job.compensation.deviations);
  const double path_tolerance = results.inputs.job.program_options.path_tolerance;
  if (geometry && geometry->taken_out && geometry->gears.value_or(0) > path_tolerance)
    report.warnings.push_back(fmt::format(
        "between the points of the path waves of the gears leave up to {:.3f} mm along the normal, "
        "more than program_options.path_tolerance_mm; a smaller toolpath.spacing_mm takes more out",
        *geometry->gears));
  if (report.deflection || std::ranges::count(report.lost_motion->course.face, true) > 0)
    report.budget =
        MakeBudget(report.deflection ? &*report.deflection : nullptr, *report.lost_motion,
                   report.registration ? &*report.registration : nullptr, geometry ? &*geometry : nullptr);
  report.fixed = &results.fixed;
  report.faces = results.faces;
  if (const std::optional<ToolUncertainty> tool = UncertaintyOf(results.inputs.cell.tool)) {
    report.steps = FindPoseSteps(plan, *tool, FinishedFrom(results.inputs.job, plan.passes.size()));
    if (const std::string steps = Describe(*report.steps); !steps.empty()) report.warnings.push_back(steps);
  }
  report.face = results.face;
  FilesByPath files;
  for (const CheckedProgram& program : programs)
    for (const auto& [name, bytes] : program.files) {
      const std::string path = program.controller + "/" + name;
      if (program.Confirmed()) files[path] = &bytes;
      report.programs.push_back({"programs/" + path, program.controller,
                                 MotionsPerPass(program, plan.passes.size()), program.saved, program.near,
                                 program.Confirmed(), program.WhyWithheld(), ButForOf(program)});
    }
  for (const CheckedProgram& program : programs) {
    if (program.files.empty()) continue;
    const Post& post = *results.inputs.cell.controllers.at(program.controller).post;
    report.program_sizes.push_back(
        {program.controller, program.files.size(), BytesOf(program.files), post.Memory()});
  }
  AddStarts(results.starts, report, files);
  // One sentence for terminal, pages, JUnit: keys are not set apart in any of them.
  for (std::vector<std::string>* sentences : {&report.warnings, &report.findings})
    for (std::string& sentence : *sentences) std::erase(sentence, '`');
  const std::string job = PlannedJobText(results.inputs.job), cell = WriteCell(results.inputs.cell);
  set.Add("job.yaml", job);
  set.Add("cell.yaml", cell);
  const int threads = results.execution.Threads();
  set.Add(kPlanFile, [&](const ByteSink& sink) { WritePlan(plan, threads, sink); });
  if (!results.starts.ways.gaps.empty()) set.Add(kStartWays, Serialise(results.starts.ways));
  const CutterShape cutter = MakeCutterShape(results.inputs.cell.tool);
  set.Add("points.csv",
          [&](const ByteSink& sink) { WritePointsCsv(plan, cutter, &*report.lost_motion, threads, sink); });
  set.Add("path.vtp", [&](const ByteSink& sink) { WritePathVtp(plan, threads, sink); });
  if (report.deflection)
    set.Add("deflection.csv",
            [&](const ByteSink& sink) { WriteDeflectionCsv(*report.deflection, threads, sink); });
  if (report.compensation) set.Add("compensation.csv", CompensationCsv(plan));
  if (report.face) set.Add("face.csv", FaceCsv(report.face->rays, report.face->plan.expected.heights));
  set.Add("summary.json", SummaryJson(plan, report));
  set.Add("report.html",
          ReportHtml({plan, results.cell, results.grid, results.parts.curves, job + "\n" + cell,
                      report.deflection ? &*report.deflection : nullptr, report.findings, report.warnings,
                      report.times, report.fixed, &results.parts.map, &results.timeline, &*report.lost_motion,
                      report.budget ? &*report.budget : nullptr, report.face ? &*report.face : nullptr,
                      results.parts.removal ? &*results.parts.removal : nullptr, results.language,
                      report.stock ? &*report.stock : nullptr, results.inputs.job.operation}));
  for (const CheckedProgram& program : programs)
    if (program.Confirmed() && !program.trajectory.empty())
      set.Add("trajectory-" + program.controller + ".csv", program.trajectory);
  for (const auto& [name, bytes] : files) set.Add(fmt::format("{}/{}", kProgramsFolder, name), *bytes);
  return report;
}

RunFigures MeasureRun(int threads, const std::string& version) {
  RunFigures run;
  run.threads = threads;
  run.version = version;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  run.peak_memory_MB = static_cast<double>(usage.ru_maxrss) / 1024;
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  run.host = host;
  return run;
}

}  // namespace millpose
