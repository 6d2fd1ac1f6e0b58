// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/units.hpp"
#include "planning/result/point_clearance.hpp"
#include "report/inspect.hpp"
#include "report/lifts_json.hpp"
#include "report/summary_version.hpp"

namespace millpose {
namespace {

using PlainJson = nlohmann::json;
constexpr size_t kBinsOfText = 12, kBarWidth = 40;
constexpr int kPlotWidth = 72, kPlotHeight = 14;

void Append(std::string* text, const std::string& line) { *text += line + '\n'; }

/// As StepJson has it.
void AppendStep(const PlainJson& step, const char* indent, std::string* text) {
  Append(text, fmt::format("{}step up to {:.3g} mm ({}): points {} and {}, rotation {:.1f} deg apart{}",
                           indent, step.at("height_mm").get<double>(), step.at("why").get<std::string>(),
                           step.at("point").get<size_t>(), step.at("other_point").get<size_t>(),
                           step.at("rotation_change_deg").get<double>(),
                           step.at("other_branch").get<bool>() ? ", in another branch" : ""));
}

void AppendSummary(const std::string& summary_json, const std::string& name, std::string* text) {
  CheckSummaryVersion(summary_json, name);
  try {
    const PlainJson summary = PlainJson::parse(summary_json);
    const PlainJson &points = summary.at("points"), &gaps = summary.at("gaps");
    Append(text, fmt::format("job {} on {} ({}); stiffness at the {}", summary.at("job").get<std::string>(),
                             summary.at("cell").at("name").get<std::string>(),
                             summary.at("cell").at("robot").get<std::string>(),
                             summary.at("stiffness").at("origin").get<std::string>()));
    Append(text, fmt::format("points {} planned of {}, {} skipped; passes {}; gaps {} planned of {}",
                             points.at("planned").get<size_t>(), points.at("total").get<size_t>(),
                             points.at("skipped").get<size_t>(), summary.at("passes").get<size_t>(),
                             gaps.at("planned").get<size_t>(), gaps.at("total").get<size_t>()));
    const std::string unit = summary.at("stiffness").at("units").at("objective").get<std::string>();
    Append(text, fmt::format("objective {}{}, smaller is stiffer", summary.at("objective").get<std::string>(),
                             unit.empty() ? "" : " in " + unit));
    const PlainJson paper = summary.value("paper_formulation", PlainJson());
    if (!paper.is_null())
      Append(text, fmt::format("paper's formulation: {} of {} points within its tolerance, {} on the path",
                               paper.at("within_tolerance").get<size_t>(), paper.at("points").get<size_t>(),
                               paper.at("on_path").get<size_t>()));
    const PlainJson deflection = summary.value("deflection", PlainJson());
    if (!deflection.is_null() && !deflection.at("level_mm").is_null())
      Append(text,
             fmt::format("deflection along the normal: level {:.4g} mm, variation {:.4g} mm, step "
                         "between passes {:.4g} mm; {}",
                         deflection.at("level_mm").get<double>(), deflection.at("variation_mm").get<double>(),
                         deflection.at("largest_step_between_passes_mm").get<double>(),
                         deflection.at("model").get<std::string>()));
    const PlainJson steps = summary.value("pose_steps", PlainJson());
    if (!steps.is_null()) {
      std::vector<PlainJson> told;
      for (const PlainJson& step : steps.at("parts")) told.push_back(step);
      if (!steps.at("neighbours").is_null()) told.push_back(steps.at("neighbours"));
      for (const PlainJson& step : told) AppendStep(step, "", text);
    }
    const PlainJson& continuity = summary.at("continuity");
    if (continuity.is_null() || continuity.at("smoothing").at("acceleration_rms_ratio").is_null()) return;
    const PlainJson& smoothing = continuity.at("smoothing");
    Append(text,
           fmt::format("smoothing: joint accelerations (RMS) at {:.1f} % of before, for {:.2f} % of the "
                       "objective",
                       100 * smoothing.at("acceleration_rms_ratio").get<double>(),
                       smoothing.at("objective_lost_percent").get<double>()));
  } catch (const PlainJson::exception& error) {
    throw InputError({name}, std::string("is no summary of millpose plan: ") + error.what());
  }
}

void AppendHistogram(const PointsTable& points, const std::vector<size_t>& rows, std::string* text) {
  const Histogram histogram = ObjectiveHistogram(points, rows, kBinsOfText);
  const size_t largest = histogram.counts.empty() ? 0 : std::ranges::max(histogram.counts);
  Append(text, "histogram of the objective, points");
  for (size_t i = 0; i < histogram.counts.size(); ++i) {
    const double lower = histogram.lower + static_cast<double>(i) * histogram.width;
    const size_t bar = (histogram.counts[i] * kBarWidth + largest - 1) / largest;
    Append(text, fmt::format("  {:.4e} … {:.4e} {:<{}} {}", lower, lower + histogram.width,
                             std::string(bar, '#'), kBarWidth, histogram.counts[i]));
  }
}

std::string ClearanceText(double clearance) {
  return fmt::format("{}{:.2f}", clearance >= kPointClearanceBound ? ">=" : "", clearance);
}

void AppendWorst(const PointsTable& points, const std::vector<size_t>& rows, std::string* text) {
  Append(text, fmt::format("worst {} by objective", rows.size()));
  Append(text, fmt::format("  {:>7} {:>5} {:>9} {:>9} {:>9} {:>11} {:>11} {:>11} {:>11} {:>6} {:>9} {:>8}",
                           "point", "pass", "x_mm", "y_mm", "z_mm", "objective", "lt1_mm/N", "lt2_mm/N",
                           "ln_mm/N", "mu", "clear_mm", "rot_deg"));
  for (const size_t row : rows) {
    const auto number = [&](const char* column) { return *points.Number(row, column); };
    Append(text,
           fmt::format("  {:>7} {:>5} {:>9.2f} {:>9.2f} {:>9.2f} {:>11.4e} {:>11.4e} {:>11.4e} {:>11.4e} "
                       "{:>6.3f} {:>9} {:>8.2f}",
                       points.Text(row, "point"), points.Text(row, "pass"), number("x_mm"), number("y_mm"),
                       number("z_mm"), number("objective"), number("lambda_t1_mm_N"),
                       number("lambda_t2_mm_N"), number("lambda_n_mm_N"), number("mu"),
                       ClearanceText(number("clearance_mm")), number("rotation_deg")));
  }
}

// Rows of dots, the largest objective on top; a digit is the branch S, * the pose on the path.
void AppendPlot(const std::vector<RotationSample>& curve, double chosen_rotation, double chosen_objective,
                std::string* text) {
  double lower = chosen_objective, upper = chosen_objective;
  for (const RotationSample& sample : curve) {
    lower = std::min(lower, sample.objective);
    upper = std::max(upper, sample.objective);
  }
  const double span = upper > lower ? upper - lower : 1;
  std::vector<std::string> canvas(kPlotHeight, std::string(kPlotWidth, ' '));
  const auto draw = [&](double rotation, double objective, char mark) {
    const double turn = rotation / (2 * kPi) + 0.5;
    const int column =
        std::clamp(static_cast<int>((turn - std::floor(turn)) * kPlotWidth), 0, kPlotWidth - 1);
    const int row = std::clamp(static_cast<int>(std::lround((upper - objective) / span * (kPlotHeight - 1))),
                               0, kPlotHeight - 1);
    canvas[static_cast<size_t>(row)][static_cast<size_t>(column)] = mark;
  };
  for (const RotationSample& sample : curve)
    draw(sample.rotation, sample.objective, static_cast<char>('0' + sample.branch));
  draw(chosen_rotation, chosen_objective, '*');
  Append(text, "objective over the rotation about the tool axis; digits: branch S, *: chosen");
  for (int i = 0; i < kPlotHeight; ++i)
    Append(text, fmt::format("  {:>11} |{}",
                             i == 0                 ? fmt::format("{:.4e}", upper)
                             : i == kPlotHeight - 1 ? fmt::format("{:.4e}", lower)
                                                    : "",
                             canvas[static_cast<size_t>(i)]));
  Append(text, fmt::format("  {:>11} +{}", "", std::string(kPlotWidth, '-')));
  Append(text, fmt::format("  {:>11}  {:<{}}{:^{}}{:>{}}", "", "-180 deg", kPlotWidth / 3, "0",
                           kPlotWidth - 2 * (kPlotWidth / 3), "180 deg", kPlotWidth / 3));
}

void AppendPoint(const PointsTable& points, size_t row, const PointStory& story, std::string* text) {
  Append(text, fmt::format("point {}", points.Text(row, "point")));
  for (const std::string& column : points.columns()) {
    const std::string& cell = points.Text(row, column);
    if (column != "point" && !cell.empty()) Append(text, fmt::format("  {:<24} {}", column, cell));
  }
  if (!story.reasons.empty()) Append(text, "why this pose");
  for (const std::string& reason : story.reasons) Append(text, "  " + reason);
  if (story.steps) {
    Append(text, "what the tool's own error can leave in the surface here");
    for (const PoseStep& step : *story.steps) AppendStep(StepJson(step), "  ", text);
    if (story.steps->empty())
      Append(text, "  nothing: no part of a pass ends here, no other finishing cut touches");
  }
  if (!story.curve.empty() && points.IsPlanned(row))
    AppendPlot(story.curve, DegToRad(*points.Number(row, "rotation_deg")), *points.Number(row, "objective"),
               text);
}

}  // namespace

std::string InspectText(const PointsTable& points, const std::string& summary_json, const std::string& name,
                        const InspectOptions& options, const PointStory& story) {
  CheckInspectOptions(points, options);
  std::string text;
  AppendSummary(summary_json, name, &text);
  if (options.point) {
    AppendPoint(points, *options.point, story, &text);
    return text;
  }
  const std::vector<size_t> rows = PlannedRows(points, options.pass);
  if (options.pass) Append(&text, fmt::format("pass {}: {} planned points", *options.pass, rows.size()));
  AppendHistogram(points, rows, &text);
  AppendWorst(points, WorstRows(points, rows, options.worst), &text);
  return text;
}

}  // namespace millpose
