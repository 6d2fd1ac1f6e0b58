// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "base/units.hpp"
#include "planning/result/station.hpp"
#include "report/budget_json.hpp"
#include "report/compensation_json.hpp"
#include "report/face_choices_json.hpp"
#include "report/face_json.hpp"
#include "report/fixed_json.hpp"
#include "report/lifts_json.hpp"
#include "report/lost_motion_json.hpp"
#include "report/report.hpp"
#include "report/stock_json.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

Json SpreadJson(const std::optional<Spread>& spread) {
  if (!spread) return {{"best", nullptr}, {"median", nullptr}, {"worst", nullptr}};
  return {{"best", spread->best}, {"median", spread->median}, {"worst", spread->worst}};
}

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json MatrixJson(const Pose& pose) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) {
    Json row = Json::array();
    for (int j = 0; j < 4; ++j) row.push_back(pose.matrix()(i, j));
    rows.push_back(row);
  }
  return rows;
}

Json SkippedJson(const PlanResult& plan) {
  Json skipped = Json::array();
  size_t number = 0;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      if (point.skip != Infeasibility::kNone)
        skipped.push_back({{"point", number},
                           {"pass", pass.pass},
                           {"reason", ToString(point.skip)},
                           {"detail", point.detail}});
      ++number;
    }
  return skipped;
}

// Gaps that could not be planned, or only with smaller clearances.
Json LinkMoveRemarksJson(const PlanResult& plan) {
  Json list = Json::array();
  for (size_t i = 0; i < plan.gaps.size(); ++i)
    if (!plan.gaps[i].detail.empty())
      list.push_back({{"gap", i}, {"planned", plan.gaps[i].planned}, {"detail", plan.gaps[i].detail}});
  return list;
}

// Where the external axes stand, pass by pass, in mm or degrees, and how they move between.
Json ExternalJson(const PlanResult& plan) {
  const auto shown = [&](const ExternalPosition& position) {
    std::vector<double> values = position;
    for (size_t i = 0; i < values.size(); ++i)
      if (plan.external_axes[i].kind == AxisKind::kRotary) values[i] = RadToDeg(values[i]);
    return values;
  };
  Json axes = Json::array(), passes = Json::array();
  for (const ExternalAxis& axis : plan.external_axes)
    axes.push_back({{"name", axis.name},
                    {"kind", WordOf(kAxisKindWords, axis.kind)},
                    {"carries", WordOf(kCarriesWords, axis.carries)},
                    {"unit", axis.kind == AxisKind::kLinear ? "mm" : "deg"}});
  for (const PassResult& pass : plan.passes) passes.push_back(shown(pass.external));
  Json along = Json::array();  // from where to where, where they move in a cut
  for (const PassResult& pass : plan.passes)
    if (MovesAlong(pass))
      along.push_back({{"pass", pass.pass},
                       {"from", shown(ExternalAt(pass, 0))},
                       {"to", shown(ExternalAt(pass, pass.points.size() - 1))}});
  size_t moves = 0;
  double seconds = 0;
  for (const LinkMove& gap : plan.gaps)
    if (gap.external) ++moves, seconds += gap.external->duration;
  Json external{{"axes", axes}, {"passes", passes}, {"moves", moves}, {"moves_s", seconds}};
  if (!along.empty()) external["along"] = along;
  return external;
}

Json JointsJson(const Joints& values) { return std::vector<double>(values.begin(), values.end()); }

// Stretches below 70 % of the programmed feed.
Json SlowJson(const FeedReduction& reduction) {
  Json list = Json::array();
  for (const SlowStretch& s : reduction.slow)
    list.push_back({{"pass", s.pass},
                    {"first_point", s.first},
                    {"last_point", s.last},
                    {"joint", s.joint + 1},
                    {"by", s.by_acceleration ? "acceleration" : "speed"},
                    {"feed_mm_min", 60 * s.feed},
                    {"feed_wanted_mm_min", 60 * s.wanted}});
  return list;
}

Json ContinuityJson(const ReportInputs& inputs, const PlanFigures& plan) {
  const std::optional<ContinuityFigures>& figures = inputs.continuity;
  const FeedReduction& reduction = inputs.feed_reduction;
  if (!figures) return nullptr;
  Json not_held = Json::array();
  for (const FeedFinding& f : figures->feed_not_held)
    not_held.push_back({{"point", f.point},
                        {"pass", f.pass},
                        {"joint", f.joint + 1},
                        {"by", f.by_acceleration ? "acceleration" : "speed"},
                        {"feed_mm_min", 60 * f.feed},
                        {"feed_possible_mm_min", 60 * f.feed_possible}});
  return {
      {"joint_speed_share_max", JointsJson(figures->speed_share)},
      {"joint_acceleration_share_max", JointsJson(figures->acceleration_share)},
      {"joint_acceleration_rms_deg_s2", JointsJson(kDegPerRad * figures->acceleration_rms)},
      {"singularity_min",
       {{"wrist", figures->wrist}, {"elbow", figures->elbow}, {"shoulder_mm", figures->shoulder}}},
      {"smoothing",
       {{"acceleration_rms_ratio", OrNull(plan.acceleration_ratio)},
        {"objective_lost_percent", plan.smoothing_loss ? Json(100 * *plan.smoothing_loss) : Json(nullptr)}}},
      {"halfway_deviation_max_mm", figures->halfway_deviation},
      {"halfway_axis_deviation_max_deg", RadToDeg(figures->halfway_axis)},
      {"feed_not_held", not_held},
      {"feed_reduced",
       {{"points", reduction.points},
        {"least_mm_min", reduction.points ? Json(60 * reduction.least) : Json(nullptr)},
        {"slow", SlowJson(reduction)}}}};
}

Json PriceJson(const std::optional<Price>& price) {
  if (!price) return nullptr;
  const auto parts = [](bool given, const PriceParts& p, double scale) -> Json {
    if (!given) return nullptr;
    return {{"interference", scale * p.interference},
            {"continuity", scale * p.continuity},
            {"smoothing", scale * p.smoothing},
            {"total", scale * p.total}};
  };
  const auto percent = [](const std::optional<double>& share) { return share ? Json(100 * *share) : Json(); };
  return {{"points", price->points},
          {"ratio", parts(!price->is_length && price->ratio.total > 0, price->ratio, 1)},
          {"mean_um", parts(price->is_length, price->mean, 1e3)},
          {"worst_um", parts(price->is_length, price->worst, 1e3)},
          {"gap_percent", {{"sum", percent(price->sum_gap)}, {"worst", percent(price->worst_gap)}}}};
}

Json AuditJson(const std::optional<AuditFigures>& audit) {
  if (!audit) return nullptr;
  Json pairs = Json::array();
  for (const AuditPair& pair : audit->pairs)
    pairs.push_back({{"first", pair.first},
                     {"second", pair.second},
                     {"contacts", pair.contacts},
                     {"too_near", pair.too_near},
                     {"least_mm", pair.too_near > 0 ? Json(pair.least_mm) : Json()},
                     {"wanted_mm", pair.too_near > 0 ? Json(pair.wanted_mm) : Json()},
                     {"first_on", pair.where}});
  return {{"ga_share_within_0p1_percent", audit->ga_share_within_0p1_percent},
          {"ga_worst_gap_percent", audit->ga_worst_gap_percent},
          {"ga_share_without_table_percent", OrNull(audit->ga_share_without_table_percent)},
          {"limit_violations", audit->limit_violations},
          {"interferences", audit->interferences},
          {"clearance_violations", audit->clearance_violations},
          {"pairs", pairs},
          {"max_slice_distance_mm", audit->max_slice_distance_mm}};
}

Json PaperJson(const std::optional<PaperFigures>& figures) {
  if (!figures) return nullptr;
  const auto spread = [](const Spread& s, double scale) {
    return Json{{"best", scale * s.best}, {"median", scale * s.median}, {"worst", scale * s.worst}};
  };
  return {{"points", figures->searched},
          {"within_tolerance", figures->within_tolerance},
          {"admissible_on_exact_pose", figures->usable},
          {"on_path", figures->on_path},
          {"position_error_mm", spread(figures->position_error, 1)},
          {"angle_error_deg", spread(figures->angle_error, kDegPerRad)},
          {"above_exhaustive_percent",
           figures->above_exhaustive ? spread(*figures->above_exhaustive, 100) : Json(nullptr)}};
}

Json DeflectionJson(const std::optional<DeflectionReport>& report) {
  if (!report) return nullptr;
  const CuttingForce& force = report->force;
  const auto of_face = [&](double FaceDeflection::*field) {
    return report->face ? Json((*report->face).*field) : Json(nullptr);
  };
  Json sides{{"up", 0}, {"down", 0}, {"slot", 0}, {"air", 0}};
  for (const DeflectedPoint& point : report->points) {
    Json& count = sides[Name(point.engagement.side)];
    count = count.get<int>() + 1;
  }
  return {{"model", kDeflectionModel},
          {"mean_force_N", {{"feed", force.mean.x()}, {"across", force.mean.y()}, {"axial", force.mean.z()}}},
          {"peak_force_N", force.peak},
          {"points", sides},
          {"level_mm", of_face(&FaceDeflection::level)},
          {"variation_mm", of_face(&FaceDeflection::variation)},
          {"largest_step_between_passes_mm", of_face(&FaceDeflection::largest_step)}};
}

Json ButForJson(const std::optional<ReportedBound>& bound) {
  if (!bound) return nullptr;
  return {{"what", "corner"},
          {"bound_mm", bound->position},
          {"bound_deg", RadToDeg(bound->angle)},
          {"assumption", bound->assumption}};
}

Json ProgramsJson(const std::vector<ReportedProgram>& programs) {
  Json list = Json::array();
  for (const ReportedProgram& program : programs)
    list.push_back({{"path", program.path},
                    {"controller", program.controller},
                    {"motions_per_pass", program.motions_per_pass},
                    {"points_saved", program.points_saved},
                    {"points_near", program.points_near},
                    {"verified", program.verified},
                    {"withheld", program.withheld.empty() ? Json(nullptr) : Json(program.withheld)},
                    {"but_for", ButForJson(program.but_for)}});
  return list;
}

Json SizesJson(const std::vector<ProgramSize>& sizes) {
  Json list = Json::array();
  for (const ProgramSize& size : sizes)
    list.push_back({{"controller", size.controller},
                    {"files", size.files},
                    {"kbytes", static_cast<double>(size.bytes) / 1000},
                    {"memory_kbytes", size.memory > 0 ? Json(size.memory / 1000) : Json(nullptr)}});
  return list;
}

Json TimeJson(const CycleTime& time) {
  return {{"total_s", time.Total()},
          {"cuts_s", time.cuts},
          {"approaches_s", time.approaches},
          {"gaps_s", time.gaps},
          {"stops_s", time.stops}};
}

Json TimesJson(const std::vector<ControllerTime>& times) {
  Json list = Json::array();
  for (const ControllerTime& program : times) {
    Json item{{"controller", program.controller}};
    item.update(TimeJson(program.time.all));
    item["passes"] = Json::array();
    for (const CycleTime& pass : program.time.passes) item["passes"].push_back(TimeJson(pass));
    list.push_back(std::move(item));
  }
  return list;
}

Json PathSpeedsJson(const std::vector<PathSpeed>& speeds) {
  Json list = Json::array();
  for (const PathSpeed& speed : speeds) {
    Json slow = Json::array();
    for (const PathSpeed::Place& place : speed.slow)
      slow.push_back({{"pass", place.pass},
                      {"point", place.point},
                      {"feed_mm_min", 60 * place.feed},
                      {"estimated_mm_min", 60 * place.speed},
                      {"cause", place.cause}});
    list.push_back(
        {{"controller", speed.controller}, {"lowest_feed_share", speed.lowest_share}, {"slow_places", slow}});
  }
  return list;
}

Json RegistrationJson(const RegistrationFigures& figures) {
  return {{"face_um_95", 1e3 * figures.off_95},
          {"face_um_50", 1e3 * figures.median_off},
          {"beside_um_95", 1e3 * figures.beside_95},
          {"tolerance_um", figures.tolerance ? Json(1e3 * *figures.tolerance) : Json(nullptr)},
          {"bent_mm", figures.bent ? Json(*figures.bent) : Json(nullptr)}};
}

Json BaseWindowJson(const std::optional<BaseWindow>& window) {
  if (!window) return nullptr;
  return {{"shift_mm", window->shift},
          {"turn_deg", window->turn * kDegPerRad},
          {"obstacle", window->obstacle.empty() ? Json(nullptr) : Json(window->obstacle)}};
}

}  // namespace

std::string SummaryJson(const PlanResult& plan, const ReportInputs& inputs) {
  const PlanFigures figures = Figures(plan);
  Json json;
  json["schema_version"] = kSummaryVersion;
  json["job"] = plan.job;
  json["input_hash"] = plan.input_hash;
  json["points"] = {
      {"total", figures.total}, {"planned", figures.planned}, {"skipped", figures.total - figures.planned}};
  json["skipped"] = SkippedJson(plan);
  json["passes"] = plan.passes.size();
  json["pieces"] = figures.pieces;
  json["lifts"] = LiftsJson(plan);
  json["passes_left_open"] = OpenRingsJson(plan);
  json["gaps"] = {{"total", plan.gaps.size()}, {"planned", figures.gaps_planned}};
  json["gap_remarks"] = LinkMoveRemarksJson(plan);
  json["stiffness"] = {{"origin", WordOf(kStiffnessOriginWords, plan.stiffness_origin)},
                       {"lambda_t1", SpreadJson(figures.lambda_t1)},
                       {"lambda_t2", SpreadJson(figures.lambda_t2)},
                       {"lambda_n", SpreadJson(figures.lambda_n)},
                       {"objective", SpreadJson(figures.objective)},
                       {"units",
                        {{"lambda_t1", "mm/N"},
                         {"lambda_t2", "mm/N"},
                         {"lambda_n", "mm/N"},
                         {"objective", plan.objective_unit}}}};
  json["objective"] = plan.objective_name;
  json["price_of_continuity"] = PriceJson(figures.price);
  json["ga_nodes_share"] = OrNull(figures.ga_nodes_share);
  json["paper_formulation"] = PaperJson(figures.paper);
  json["continuity"] = ContinuityJson(inputs, figures);
  json["interference"] = {{"poses_checked", figures.poses_checked},
                          {"candidates", figures.candidates},
                          {"candidates_checked", figures.candidates_checked},
                          {"candidates_never_checked", figures.candidates - figures.candidates_checked},
                          {"pairs_checked", figures.pairs_checked},
                          {"pairs_saved", figures.pairs_saved}};
  json["clearance_min_mm"] = OrNull(figures.clearance_min);
  json["cell"] = {{"name", plan.cell},
                  {"robot", plan.arm.name},
                  {"X_WB", MatrixJson(plan.X_WB)},
                  {"X_FT", MatrixJson(plan.X_FT)},
                  {"X_WP", MatrixJson(plan.X_WP)}};
  if (!plan.external_axes.empty()) json["external"] = ExternalJson(plan);
  json["seed"] = plan.seed;
  json["programs"] = ProgramsJson(inputs.programs);
  json["program_sizes"] = SizesJson(inputs.program_sizes);
  json["cycle_times"] = TimesJson(inputs.times);
  json["path_speed_estimated"] = PathSpeedsJson(inputs.path_speeds);
  json["base_window"] = BaseWindowJson(inputs.base_window);
  json["warnings"] = inputs.warnings;
  json["findings"] = inputs.findings;
  json["audit"] = AuditJson(inputs.audit);
  json["deflection"] = DeflectionJson(inputs.deflection);
  if (inputs.registration) json["registration"] = RegistrationJson(*inputs.registration);
  if (inputs.stock) json["stock"] = StockJson(*inputs.stock);
  if (inputs.compensation) json["compensation"] = CompensationJson(*inputs.compensation);
  json["pose_steps"] = StepsJson(inputs.steps);
  json["fixed_rotation"] = FixedRotationJson(plan, inputs);
  json["budget"] = BudgetJson(inputs.budget);
  json["face_choices"] = FaceChoicesJson(inputs.faces);
  json["reversals"] = inputs.lost_motion ? ReversalsJson(plan, *inputs.lost_motion) : Json(nullptr);
  json["face"] = inputs.face ? FaceReportJson(*inputs.face) : Json(nullptr);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string RunJson(const RunFigures& figures) {
  Json json;
  json["wall_s"] = figures.wall_s;
  json["stages"] = Json::object();
  std::map<std::string, double> seconds;  // a stage may come several times
  for (const RunFigures::Stage& stage : figures.stages) {
    seconds[stage.name] += stage.wall_s;
    json["stages"][stage.name] = {{"wall_s", seconds[stage.name]}};
  }
  json["peak_memory_MB"] = figures.peak_memory_MB;
  json["threads"] = figures.threads;
  json["host"] = figures.host;
  json["version"] = figures.version;
  json["program_id"] = figures.program_id;
  json["resumed_passes"] = figures.resumed_passes;
  json["resumed_gaps"] = figures.resumed_gaps;
  json["job_folder"] = {{"absolute", figures.job_folder.absolute}, {"relative", figures.job_folder.relative}};
  json["job"] = {{"name", figures.job.name}, {"file", figures.job.file}};
  json["manifest"] = figures.manifest;
  json["asked"] = figures.asked;
  json["exit_status"] = figures.exit_status;
  json["told"] = figures.told;
  json["details"] = figures.details;
  // Folders need not be named in UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace millpose
