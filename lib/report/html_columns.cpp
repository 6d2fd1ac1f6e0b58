// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html_columns.hpp"

#include <limits>
#include <numeric>

#include "base/units.hpp"
#include "planning/result/point_clearance.hpp"
#include "planning/result/skipped.hpp"
#include "report/compensation.hpp"
#include "report/leans.hpp"

namespace millpose {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr size_t kWorstKept = 50;  // of every column, when points are thinned

/// Speeds of the joints on the way from one point to the next, rad/s; empty where the plan has no such
/// motion.
std::optional<Joints> SpeedBetween(const PlannedPoint& from, const PlannedPoint& to) {
  const double way = to.point.arc_length - from.point.arc_length;
  const bool joined =
      from.skip == Infeasibility::kNone && to.skip == Infeasibility::kNone && from.piece == to.piece;
  if (!joined || !(way > 0) || !(to.point.feed_rate > 0)) return std::nullopt;
  return (to.q - from.q) * (to.point.feed_rate / way);
}

/// The faster of arriving at point `i` and leaving it, per joint, rad/s.
std::optional<Joints> SpeedAt(const PassResult& pass, size_t i) {
  std::optional<Joints> speed;
  const auto take = [&](const std::optional<Joints>& s) {
    if (s) speed = speed ? Joints(speed->cwiseMax(s->cwiseAbs())) : Joints(s->cwiseAbs());
  };
  if (i > 0) take(SpeedBetween(pass.points[i - 1], pass.points[i]));
  if (i + 1 < pass.points.size()) take(SpeedBetween(pass.points[i], pass.points[i + 1]));
  return speed;
}

class Collector {
 public:
  explicit Collector(const PlanResult& plan) : plan_(plan) {}

  /// Adds a column; `value(point)` is asked for planned points only, an empty answer is "none".
  void Add(std::string key, std::string symbol, std::string label, std::string unit, Worse worse,
           const auto& value) {
    ReportColumn column{.key = key,
                        .symbol = symbol,
                        .label = label,
                        .unit = unit,
                        .worse = worse,
                        .values = {},
                        .bound = {}};
    for (const PassResult& pass : plan_.passes) {
      for (size_t i = 0; i < pass.points.size(); ++i) {
        const std::optional<double> v =
            pass.points[i].skip == Infeasibility::kNone ? value(pass, i) : std::optional<double>();
        column.values.push_back(v && std::isfinite(*v) ? static_cast<float>(*v) : kNone);
      }
    }
    columns_.push_back(std::move(column));
  }
  /// The last column's values are reported up to `bound`.
  void Bound(double bound) { columns_.back().bound = bound; }
  std::vector<ReportColumn> Take() { return std::move(columns_); }

 private:
  const PlanResult& plan_;
  std::vector<ReportColumn> columns_;
};

using Value = std::optional<double>;

void AddStiffness(const PlanResult& plan, Collector& c) {
  const auto compliance = [&](std::string key, std::string symbol, std::string label,
                              double MillingPlaneIndices::*member) {
    c.Add(key, symbol, label, "µm/N", Worse::kHigh,
          [=](const PassResult& pass, size_t i) -> Value { return 1e3 * pass.points[i].indices.*member; });
  };
  const double scale = ShownScale(plan.objective_unit);
  c.Add("objective", "f", "Objective " + plan.objective_name, ShownUnit(plan.objective_unit), Worse::kHigh,
        [=](const PassResult& pass, size_t i) -> Value { return scale * pass.points[i].objective; });
  compliance("lambda_t1", "λτ1", "Larger semi-axis in the milling plane", &MillingPlaneIndices::lambda_t1);
  compliance("lambda_t2", "λτ2", "Smaller semi-axis in the milling plane", &MillingPlaneIndices::lambda_t2);
  compliance("lambda_n", "λn", "Ellipsoid radius along the normal", &MillingPlaneIndices::lambda_n);
  compliance("normal_compliance", "nᵀcn", "Displacement along the normal per newton along it",
             &MillingPlaneIndices::normal_compliance);
  c.Add("mu", "μ", "Isotropy λτ2/λτ1", "", Worse::kLow,
        [](const PassResult& pass, size_t i) -> Value { return pass.points[i].indices.mu; });
  c.Add("dexterity", "D", "Dexterity", "", Worse::kLow,
        [](const PassResult& pass, size_t i) -> Value { return pass.points[i].dexterity; });
  c.Add("price", "f/f*", "Objective over the point's own optimum", "", Worse::kHigh,
        [](const PassResult& pass, size_t i) -> Value {
          const PlannedPoint& p = pass.points[i];
          if (p.own_optimum > 0) return p.objective / p.own_optimum;
          return std::nullopt;
        });
}

void AddMotion(const PlanResult& plan, Collector& c) {
  const Arm& arm = plan.arm;
  c.Add("clearance", "clearance", "Smallest distance of any checked pair", "mm", Worse::kLow,
        [](const PassResult& pass, size_t i) -> Value { return pass.points[i].clearance; });
  c.Bound(kPointClearanceBound);
  c.Add("limit_reserve", "to limit", "Distance of the nearest joint from its limit", "°", Worse::kLow,
        [&](const PassResult& pass, size_t i) -> Value {
          const Joints& q = pass.points[i].q;
          double room = std::min((q - arm.lower).minCoeff(), (arm.upper - q).minCoeff());
          for (const CoupledLimit& limit : arm.coupled_limits) room = std::min(room, -limit.Beyond(q));
          return RadToDeg(room);
        });
  c.Add("speed_share", "v/vmax", "Fastest joint, share of its limit", "%", Worse::kHigh,
        [&](const PassResult& pass, size_t i) -> Value {
          const auto speed = SpeedAt(pass, i);
          if (!speed || !(arm.speed.minCoeff() > 0)) return std::nullopt;
          return 100 * speed->cwiseQuotient(arm.speed).maxCoeff();
        });
  c.Add("rotation", "rotation", "Rotation about the tool axis", "°", Worse::kNeither,
        [](const PassResult& pass, size_t i) -> Value {
          const PlannedPoint& p = pass.points[i];
          if (p.freedoms.empty()) return std::nullopt;
          return RadToDeg(p.freedoms[0]);
        });
  if (HasLeans(plan)) {
    c.Add("lead", "lead", "Lead of the tool axis towards the feed", "°", Worse::kNeither,
          [](const PassResult& pass, size_t i) -> Value { return RadToDeg(LeansOf(pass.points[i]).lead); });
    c.Add("tilt", "tilt", "Tilt of the tool axis to the feed's right", "°", Worse::kNeither,
          [](const PassResult& pass, size_t i) -> Value { return RadToDeg(LeansOf(pass.points[i]).tilt); });
  }
  for (int j = 0; j < 6; ++j) {
    c.Add(fmt::format("a{}", j + 1), fmt::format("A{}", j + 1), fmt::format("Joint {} angle", j + 1), "°",
          Worse::kNeither,
          [=](const PassResult& pass, size_t i) -> Value { return RadToDeg(pass.points[i].q[j]); });
  }
  for (int j = 0; j < 6; ++j) {
    c.Add(fmt::format("v{}", j + 1), fmt::format("V{}", j + 1), fmt::format("Joint {} speed", j + 1), "°/s",
          Worse::kHigh, [=](const PassResult& pass, size_t i) -> Value {
            const auto speed = SpeedAt(pass, i);
            if (!speed) return std::nullopt;
            return RadToDeg((*speed)[j]);
          });
  }
}

/// Where the external axes stand, under their own names.
void AddExternal(const PlanResult& plan, Collector& c) {
  for (size_t k = 0; k < plan.external_axes.size(); ++k) {
    const ExternalAxis& axis = plan.external_axes[k];
    const bool linear = axis.kind == AxisKind::kLinear;
    c.Add(fmt::format("e{}", k + 1), axis.name, "External axis " + axis.name, linear ? "mm" : "°",
          Worse::kNeither, [=](const PassResult& pass, size_t i) -> Value {
            const ExternalPosition& at = pass.points[i].external.value_or(pass.external);
            if (at.size() <= k) return std::nullopt;
            return linear ? at[k] : RadToDeg(at[k]);
          });
  }
}

/// Predicted deflections of the planned cut points, µm.
void AddDeflection(const PlanResult& plan, const DeflectionReport& report,
                   std::vector<ReportColumn>& columns) {
  const size_t total = CountPoints(plan);
  const auto add_column = [&](std::string key, std::string symbol, std::string label, std::string unit,
                              Worse worse, const auto& value) {
    ReportColumn column{.key = std::move(key),
                        .symbol = std::move(symbol),
                        .label = std::move(label),
                        .unit = std::move(unit),
                        .worse = worse,
                        .values = std::vector<float>(total, kNone),
                        .bound = {}};
    for (const DeflectedPoint& point : report.points)
      column.values.at(point.number) = static_cast<float>(value(point));
    columns.push_back(std::move(column));
  };
  const auto add = [&](std::string key, std::string symbol, std::string label, Worse worse,
                       double PredictedDeflection::*member) {
    add_column(std::move(key), std::move(symbol), std::move(label), "µm", worse,
               [&](const DeflectedPoint& point) { return 1e3 * point.deflection.*member; });
  };
  add("deflection", "|d|", "Predicted deflection under the mean cutting force", Worse::kHigh,
      &PredictedDeflection::length);
  add("deflection_normal", "d·n", "Its part along the normal, away from the part", Worse::kNeither,
      &PredictedDeflection::normal);
  add("deflection_feed", "d·f", "Its part along the feed", Worse::kNeither, &PredictedDeflection::feed);
  add("deflection_across", "d·(n×f)", "Its part across the feed", Worse::kNeither,
      &PredictedDeflection::across);
  add_column("cut_force", "|F|", "Mean cutting force", "N", Worse::kHigh,
             [](const DeflectedPoint& point) { return point.force.norm(); });
  // Above 0 where the cutter mills up, below where down, so that a zigzag shows; a slot is wide either way.
  add_column("cut_width", "a_e", "Radial width of cut: above 0 up milling, below 0 down milling", "mm",
             Worse::kNeither, [](const DeflectedPoint& point) {
               const Engagement& cut = point.engagement;
               return cut.side == CutSide::kDown ? -cut.width : cut.width;
             });
  add_column("cut_depth", "a_p", "Axial depth of cut", "mm", Worse::kHigh,
             [](const DeflectedPoint& point) { return point.engagement.depth; });
}

/// What compensation takes out of the deflection along the normal, and what remains; where the arm as it is
/// is commanded, by how much beside the plan.
void AddCompensation(const PlanResult& plan, Collector& c) {
  const std::optional<CompensationFigures> figures = FiguresOfCompensation(plan);
  if (!figures) return;
  if (figures->largest_arm_shift > 0)
    c.Add("arm_shift", "commanded", "Commanded tip from the planned one, for the deviations of the arm", "mm",
          Worse::kNeither, [](const PassResult& pass, size_t i) -> Value {
            const auto& compensation = pass.points[i].compensation;
            if (!compensation) return std::nullopt;
            return compensation->arm_shift.norm();
          });
  if (figures->largest_gear)
    c.Add("gear_shift", "for gears", "Of it, for the tables and couplings of the joints", "mm",
          Worse::kNeither, [](const PassResult& pass, size_t i) -> Value {
            const auto& compensation = pass.points[i].compensation;
            if (!compensation) return std::nullopt;
            return compensation->gear_shift.norm();
          });
  if (!figures->shifts) return;
  const auto along = [&](std::string key, std::string symbol, std::string label, Worse worse,
                         double (*value)(const Compensation::Along&)) {
    c.Add(std::move(key), std::move(symbol), std::move(label), "µm", worse,
          [=](const PassResult& pass, size_t i) -> Value {
            const auto& compensation = pass.points[i].compensation;
            if (!compensation || compensation->force.isZero(0.0)) return std::nullopt;
            return 1e3 * value(compensation->normal);
          });
  };
  using Along = Compensation::Along;
  along("before", "d·n before", "Expected error along the normal, uncompensated", Worse::kNeither,
        [](const Along& d) { return d.expected; });
  along("after", "d·n after", "Expected error along the normal, compensated", Worse::kNeither,
        [](const Along& d) { return d.expected - d.taken; });
  along("worst_before", "worst before", "Largest error along the normal that force and stiffness may make",
        Worse::kHigh, [](const Along& d) { return d.LargestBefore(); });
  along("worst_after", "worst after", "The same, compensated", Worse::kHigh,
        [](const Along& d) { return d.LargestAfter(); });
  c.Add("shift", "shift", "Shift of the commanded tip", "µm", Worse::kHigh,
        [](const PassResult& pass, size_t i) -> Value {
          const auto& compensation = pass.points[i].compensation;
          if (!compensation) return std::nullopt;
          return 1e3 * compensation->shift.norm();
        });
}

/// Marks where joints turn back, and what lost motion leaves of the tip along the normal.
void AddLostMotion(const PlanResult& plan, const LostMotionReport& report,
                   std::vector<ReportColumn>& columns) {
  const bool known = report.Known();
  ReportColumn marks{.key = "reversal",
                     .symbol = "mark",
                     .label = "Marks of joints that turn back, along the normal",
                     .unit = known ? "µm" : "µm/arcmin",
                     .worse = Worse::kHigh,
                     .values = {},
                     .bound = {}};
  for (const bool of_face : report.course.face) marks.values.push_back(of_face ? 0 : kNone);
  for (const GearMark& mark : report.course.marks)
    if (mark.crosses)
      marks.values[mark.point] += static_cast<float>(
          1e3 * HeightOf(mark, report.model).value_or(HeightPerUnit(mark, plan.external_axes)));
  columns.push_back(std::move(marks));
  if (!known) return;
  ReportColumn errors{.key = "lost_motion",
                      .symbol = "e",
                      .label = "Displacement along the normal by lost motion",
                      .unit = "µm",
                      .worse = Worse::kNeither,
                      .values = {},
                      .bound = {}};
  for (const std::optional<double>& error : report.course.errors)
    errors.values.push_back(error ? static_cast<float>(1e3 * *error) : kNone);
  columns.push_back(std::move(errors));
}

/// Marks the worst points of a column.
void KeepWorst(const ReportColumn& column, std::vector<char>& keep) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < column.values.size(); ++i)
    if (!std::isnan(column.values[i])) order.push_back(i);
  const float sign = static_cast<float>(column.worse);
  const auto worse = [&](uint32_t a, uint32_t b) {
    const float va = sign * column.values[a], vb = sign * column.values[b];
    return va != vb ? va > vb : a < b;
  };
  const size_t count = std::min(kWorstKept, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(), worse);
  for (size_t i = 0; i < count; ++i) keep[order[i]] = 1;
}

}  // namespace

std::string ShownUnit(const std::string& unit) {
  return unit == "mm/N" ? "µm/N" : unit == "mm" ? "µm" : unit;
}
double ShownScale(const std::string& unit) { return unit == "mm/N" || unit == "mm" ? 1e3 : 1; }

std::vector<ReportColumn> ReportColumns(const PlanResult& plan, const DeflectionReport* deflection,
                                        const LostMotionReport* lost_motion) {
  Collector collector(plan);
  AddStiffness(plan, collector);
  AddMotion(plan, collector);
  AddExternal(plan, collector);
  AddCompensation(plan, collector);
  std::vector<ReportColumn> columns = collector.Take();
  if (deflection) AddDeflection(plan, *deflection, columns);
  if (lost_motion) AddLostMotion(plan, *lost_motion, columns);
  return columns;
}

std::vector<ReportRow> RowsToShow(const PlanResult& plan, const std::vector<ReportColumn>& columns,
                                  size_t limit) {
  const size_t total = CountPoints(plan);
  const size_t stride = (total + limit - 1) / std::max<size_t>(limit, 1);
  std::vector<char> keep(total, 0);
  if (stride > 1) {
    for (const ReportColumn& column : columns)
      if (column.worse != Worse::kNeither) KeepWorst(column, keep);
  }
  std::vector<ReportRow> rows;
  uint32_t number = 0;
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    const std::vector<PlannedPoint>& points = plan.passes[p].points;
    for (size_t i = 0; i < points.size(); ++i, ++number) {
      const bool end = i == 0 || i + 1 == points.size() || points[i].piece != points[i - 1].piece ||
                       points[i].piece != points[i + 1].piece;
      if (stride <= 1 || end || i % stride == 0 || keep[number])
        rows.push_back({static_cast<int>(p), static_cast<int>(i), number});
    }
  }
  return rows;
}

}  // namespace millpose
