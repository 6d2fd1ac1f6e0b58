// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html_data.hpp"

#include <limits>

#include "base/units.hpp"
#include "planning/result/skipped.hpp"
#include "planning/result/station.hpp"
#include "report/fixed_figures.hpp"
#include "report/html_columns.hpp"
#include "report/html_json.hpp"
#include "report/packed.hpp"
#include "report/price_text.hpp"
#include "report/report.hpp"

namespace millpose {
namespace {

using namespace html;

/// Of every pass, where the robot's base stands as seen from the part, which the page shows with the external
/// axes at 0.
Json BasesJson(const PlanResult& plan) {
  Json bases = Json::array();
  for (const PassResult& pass : plan.passes) bases.push_back(Matrix(BaseFromPartAtZero(plan, pass.external)));
  return bases;
}

/// The same of every row, where external axes move along passes.
std::string RowBases(const PlanResult& plan, const std::vector<ReportRow>& rows) {
  std::vector<Pose> bases;
  for (const ReportRow& row : rows)
    bases.push_back(BaseFromPartAtZero(
        plan, ExternalAt(plan.passes[static_cast<size_t>(row.pass)], static_cast<size_t>(row.point))));
  return PackPoses(bases);
}

/// Lengths of the passes, and where each begins when they are laid end to end, mm.
struct Layout {
  std::vector<double> begin, length;
};
Layout LayEndToEnd(const PlanResult& plan) {
  Layout layout;
  double at = 0;
  for (const PassResult& pass : plan.passes) {
    const double length = pass.points.empty() ? 0 : pass.points.back().point.arc_length;
    layout.begin.push_back(at);
    layout.length.push_back(length);
    at += length;
  }
  return layout;
}

Json RowsJson(const PlanResult& plan, const std::vector<ReportRow>& rows, const Layout& layout) {
  std::vector<uint32_t> number, pass, piece, status, branch, kind;
  std::vector<float> way;
  std::vector<Eigen::Vector3d> position, normal;
  for (const ReportRow& row : rows) {
    const PlannedPoint& p = plan.passes[row.pass].points[row.point];
    number.push_back(row.number);
    pass.push_back(static_cast<uint32_t>(row.pass));
    piece.push_back(static_cast<uint32_t>(p.piece));
    status.push_back(static_cast<uint32_t>(p.skip));
    branch.push_back(static_cast<uint32_t>(p.branch));
    kind.push_back(static_cast<uint32_t>(p.point.kind));
    way.push_back(static_cast<float>(layout.begin[row.pass] + p.point.arc_length));
    const ExternalPosition& external = ExternalAt(plan.passes[row.pass], static_cast<size_t>(row.point));
    position.push_back(OnPartAtZero(plan, external, p.point.position));
    normal.push_back(external.empty() ? p.point.normal : ToZero(plan, external).linear() * p.point.normal);
  }
  return {{"number", PackUint32(number)}, {"pass", PackUint32(pass)},
          {"piece", PackUint32(piece)},   {"status", PackUint32(status)},
          {"branch", PackUint32(branch)}, {"kind", PackUint32(kind)},
          {"way_mm", PackFloats(way)},    {"position_mm", PackVectors(position)},
          {"normal", PackVectors(normal)}};
}

Json ColumnsJson(const std::vector<ReportColumn>& columns, const std::vector<ReportRow>& rows) {
  Json list = Json::array();
  std::vector<float> shown(rows.size());
  for (const ReportColumn& column : columns) {
    for (size_t i = 0; i < rows.size(); ++i) shown[i] = column.values[rows[i].number];
    list.push_back({{"key", column.key},
                    {"symbol", column.symbol},
                    {"label", column.label},
                    {"unit", column.unit},
                    {"worse", static_cast<int>(column.worse)},
                    {"bound", column.bound ? Json(*column.bound) : Json()},
                    {"values", PackFloats(shown)}});
  }
  return list;
}

Json PassesJson(const PlanResult& plan, const Layout& layout) {
  Json list = Json::array();
  for (size_t i = 0; i < plan.passes.size(); ++i) {
    const PassResult& pass = plan.passes[i];
    list.push_back({{"pass", pass.pass},
                    {"begin_mm", layout.begin[i]},
                    {"length_mm", layout.length[i]},
                    {"points", pass.points.size()},
                    {"pieces", pass.pieces.size()}});
  }
  return list;
}

/// Skipped points, the first `limit` of them by number, and how many there are for each reason.
Json SkippedJson(const PlanResult& plan, size_t limit) {
  Json list = Json::array();
  uint32_t number = 0;
  for (const PassResult& pass : plan.passes) {
    for (const PlannedPoint& p : pass.points) {
      if (p.skip != Infeasibility::kNone) {
        if (list.size() < limit)
          list.push_back(
              {{"point", number}, {"pass", pass.pass}, {"reason", ToString(p.skip)}, {"detail", p.detail}});
      }
      ++number;
    }
  }
  return {{"reasons", SkippedByReason(plan)}, {"rows", list}};
}

Json LinkMovesJson(const PlanResult& plan) {
  Json told = Json::array();
  size_t planned = 0;
  for (const LinkMove& gap : plan.gaps) {
    planned += gap.planned;
    if (gap.planned && gap.detail.empty()) continue;
    told.push_back({{"from_pass", gap.from_pass},
                    {"from_piece", gap.from_piece},
                    {"to_pass", gap.to_pass},
                    {"to_piece", gap.to_piece},
                    {"planned", gap.planned},
                    {"detail", gap.detail}});
  }
  return {{"total", plan.gaps.size()}, {"planned", planned}, {"told", told}};
}

Json CountsJson(const PlanResult& plan, size_t shown) {
  size_t total = 0, skipped = 0;
  for (const PassResult& pass : plan.passes) {
    total += pass.points.size();
    for (const PlannedPoint& p : pass.points) skipped += p.skip != Infeasibility::kNone;
  }
  return {{"total", total}, {"planned", total - skipped}, {"skipped", skipped}, {"shown", shown}};
}

Json OptimaJson(const PlanResult& plan, const std::vector<ReportRow>& rows) {
  const double scale = ShownScale(plan.objective_unit);
  std::vector<float> genetic, own, free;
  for (const ReportRow& row : rows) {
    const PlannedPoint& p = plan.passes[row.pass].points[row.point];
    const auto shown = [&](double value) {
      return value > 0 ? static_cast<float>(scale * value) : std::numeric_limits<float>::quiet_NaN();
    };
    genetic.push_back(shown(p.genetic_optimum));
    own.push_back(shown(p.own_optimum));
    free.push_back(shown(p.free_optimum));
  }
  return {{"genetic", PackFloats(genetic)}, {"own", PackFloats(own)}, {"free", PackFloats(free)}};
}

/// Figures of the finished face, µm; null when the job gives no cutting force.
Json DeflectionJson(const DeflectionReport* report) {
  if (!report) return nullptr;
  Json json{{"model", kDeflectionModel},
            {"mean_force_N", {report->force.mean.x(), report->force.mean.y(), report->force.mean.z()}},
            {"face", nullptr}};
  if (report->face)
    json["face"] = {{"level_um", 1e3 * report->face->level},
                    {"variation_um", 1e3 * report->face->variation},
                    {"largest_step_um", 1e3 * report->face->largest_step}};
  return json;
}

/// What fixed rotations would have given, one sentence each; null where it was not asked for.
Json FixedJson(const HtmlInput& input) {
  if (!input.fixed) return nullptr;
  const FixedComparison& fixed = *input.fixed;
  Json sentences = Json::array();
  for (const auto& [name, choice] : NamedChoices(fixed)) {
    std::string sentence = fmt::format("Plan ÷ {}:", name);
    for (const FixedFigure& figure : FixedFigures(fixed.plan, choice->figures))
      sentence += fmt::format(" {} {};", figure.label, FixedRatios(figure));
    const bool known = input.lost_motion != nullptr && input.lost_motion->Known();
    sentences.push_back(
        fmt::format("{} {}.", sentence, FixedReversals(fixed.plan_gears, choice->gears, known)));
  }
  const auto none = [&](const char* what, const std::string& why) {
    sentences.push_back(fmt::format("{}: none serves all points ({}).", what, why));
  };
  if (!fixed.job.Exists()) none("Single rotation of the job", fixed.job_in_the_way);
  if (!fixed.passes.Exists()) none("Rotation of each pass", fixed.passes_in_the_way);
  return sentences;
}

/// The budget of the face's error as rows of texts; null where it was not asked for.
Json BudgetRows(const Budget* budget) {
  if (budget == nullptr) return nullptr;
  Json rows = Json::array();
  for (const BudgetRow& row : budget->rows)
    rows.push_back(
        {row.name, row.largest ? fmt::format("{:.3g}", 1e3 * *row.largest) : "not stated", row.basis});
  const std::vector<std::string> left_out = budget->LeftOut();
  rows.push_back({"sum of what is stated", fmt::format("{:.3g}", 1e3 * budget->Sum()),
                  left_out.empty() ? "" : fmt::format("leaves out {}", fmt::join(left_out, ", "))});
  return rows;
}

/// What the path costs against each point's own best pose, line by line.
Json PriceJson(const PlanResult& plan) {
  const std::optional<Price> price = PriceOf(plan);
  return price ? Json(PriceLines(*price)) : Json::array();
}

/// How the paper's own formulation did; null where it did not run.
Json PaperJson(const PlanResult& plan) {
  const std::optional<PaperFigures> paper = Figures(plan).paper;
  if (!paper) return nullptr;
  Json json{{"searched", paper->searched},
            {"within_tolerance", paper->within_tolerance},
            {"usable", paper->usable},
            {"on_path", paper->on_path},
            {"position_error_mm", paper->position_error.worst},
            {"angle_error_deg", RadToDeg(paper->angle_error.worst)},
            {"above_percent", nullptr}};
  if (const auto& above = paper->above_exhaustive)
    json["above_percent"] = {100 * above->best, 100 * above->median, 100 * above->worst};
  return json;
}

/// How long every program takes: all of it as a text, and s per pass.
Json TimesJson(const HtmlInput& input) {
  Json times = Json::array();
  for (const ControllerTime& program : input.times) {
    Json passes = Json::array();
    for (const CycleTime& pass : program.time.passes) passes.push_back(std::round(10 * pass.Total()) / 10);
    times.push_back(
        {{"controller", program.controller}, {"text", TimeText(program.time.all)}, {"passes_s", passes}});
  }
  return times;
}

}  // namespace

std::string ReportJson(const HtmlInput& input, const HtmlLimits& limits) {
  const PlanResult& plan = input.plan;
  const std::vector<ReportColumn> columns = ReportColumns(plan, input.deflection, input.lost_motion);
  const std::vector<ReportRow> rows = RowsToShow(plan, columns, limits.points);
  const Layout layout = LayEndToEnd(plan);
  Json data{{"format", 1},
            {"job", input.Title()},
            {"cell", plan.cell},
            {"seed", plan.seed},
            {"input_hash", plan.input_hash},
            {"objective", {{"name", plan.objective_name}, {"unit", ShownUnit(plan.objective_unit)}}},
            {"stiffness_origin", WordOf(kStiffnessOriginWords, plan.stiffness_origin)},
            {"counts", CountsJson(plan, rows.size())},
            {"arm", ArmJson(plan.arm)},
            {"home_deg", Degrees(plan.home)},
            {"X_WB", Matrix(plan.X_WB)},
            {"X_FT", Matrix(plan.X_FT)},
            {"X_WP", Matrix(plan.X_WP)},
            {"passes", PassesJson(plan, layout)},
            {"rows", RowsJson(plan, rows, layout)},
            {"columns", ColumnsJson(columns, rows)},
            {"optima", OptimaJson(plan, rows)},
            {"curves", CurvesJson(input)},
            {"map", MapJson(input, rows)},
            {"timeline", TimelineJson(input, rows)},
            {"nearest", NearestJson(input, rows)},
            {"skipped", SkippedJson(plan, limits.skipped_rows)},
            {"gaps", LinkMovesJson(plan)},
            {"findings", input.findings},
            {"warnings", input.warnings},
            {"times", TimesJson(input)},
            {"air", input.stock ? Json(AirText(input.stock->air)) : Json(nullptr)},
            {"deflection", DeflectionJson(input.deflection)},
            {"reversals", input.lost_motion ? Json(LostMotionText(plan, *input.lost_motion)) : Json(nullptr)},
            {"budget", BudgetRows(input.budget)},
            {"fixed", FixedJson(input)},
            {"face", FaceMapJson(input)},
            {"removal", RemovalJson(input.removal)},
            {"price", PriceJson(plan)},
            {"paper", PaperJson(plan)},
            {"settings", input.settings}};
  data["bodies"] = BodiesJson(input.cell, limits);
  if (!plan.external_axes.empty()) data["bases"] = BasesJson(plan);
  if (MovesAlong(plan)) data["row_bases"] = RowBases(plan, rows);

  return ScriptText(data);
}

}  // namespace millpose
