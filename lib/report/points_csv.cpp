// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "report/leans.hpp"
#include "report/report.hpp"

namespace millpose {
namespace {

constexpr const char* kHeader =
    "point,pass,piece,kind,status,s_mm,x_mm,y_mm,z_mm,nx,ny,nz,tx,ty,tz,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,"
    "a6_deg,"
    "rotation_deg,branch,lambda_t1_mm_N,lambda_t2_mm_N,lambda_n_mm_N,mu,dexterity,objective,clearance_mm,"
    "normal_compliance_mm_N,fx,fy,fz,feed_mm_min,genetic_optimum,exhaustive_optimum,reason,"
    "lambda_3_mm_N,l3x,l3y,l3z,own_optimum";
// Behind them where the plan is compensated.
constexpr const char* kCommandedHeader =
    ",commanded_x_mm,commanded_y_mm,commanded_z_mm,commanded_tx,commanded_ty,commanded_tz,commanded_a1_deg,"
    "commanded_a2_deg,commanded_a3_deg,commanded_a4_deg,commanded_a5_deg,commanded_a6_deg";
constexpr int kCommandedColumns = 12;
// And behind these where the pose search has chosen how the tool leans.
constexpr const char* kLeanHeader = ",lead_deg,tilt_deg";
constexpr const char* kSpeedHeader = ",cutting_speed_m_min";  // of a ball
constexpr int kPlannedColumns = 16;  // a1_deg … normal_compliance_mm_N: empty for a skipped point

const char* KindName(PointKind kind) {
  switch (kind) {
    case PointKind::kLeadIn:
      return "lead-in";
    case PointKind::kLeadOut:
      return "lead-out";
    case PointKind::kCut:
      break;
  }
  return "cut";
}

/// Appends a row to a text.
class Row {
 public:
  explicit Row(std::string& text) : text_(text), begin_(text.size()) {}

  Row& Text(std::string_view text) {
    Separate();
    text_ += text;
    return *this;
  }
  Row& Number(double value) {
    Separate();
    fmt::format_to(std::back_inserter(text_), "{:.17g}", value);
    return *this;
  }
  Row& Whole(size_t value) {
    Separate();
    fmt::format_to(std::back_inserter(text_), "{}", value);
    return *this;
  }
  /// Empty where it is not above 0.
  Row& Optimum(double value) { return value > 0 ? Number(value) : Text(""); }
  Row& Vector(const Eigen::Vector3d& vector) {
    return Number(vector.x()).Number(vector.y()).Number(vector.z());
  }
  Row& Empty(int count) {
    text_.append(static_cast<size_t>(count), ',');
    return *this;
  }

 private:
  void Separate() {
    if (text_.size() > begin_) text_ += ',';
  }

  std::string& text_;
  const size_t begin_;
};

void AppendPlanned(const PlannedPoint& point, Row* row) {
  for (int i = 0; i < 6; ++i) row->Number(RadToDeg(point.q[i]));
  row->Number(RadToDeg(point.freedoms.at(0))).Whole(static_cast<size_t>(point.branch));
  row->Number(point.indices.lambda_t1).Number(point.indices.lambda_t2).Number(point.indices.lambda_n);
  row->Number(point.indices.mu).Number(point.dexterity).Number(point.objective).Number(point.clearance);
  row->Number(point.indices.normal_compliance);
}

void AppendCommanded(const PlannedPoint& planned, Row* row) {
  if (!planned.compensation) {
    row->Empty(kCommandedColumns);
    return;
  }
  const Compensation& c = *planned.compensation;
  row->Vector(planned.point.position + c.shift + c.arm_shift);
  row->Vector(c.arm_turn.isZero(0.0) ? planned.point.tool_axis
                                     : FromRotationVector(c.arm_turn) * planned.point.tool_axis);
  for (int i = 0; i < 6; ++i) row->Number(RadToDeg(c.q[i]));
}

void AppendRow(const PassResult& pass, const PlannedPoint& planned, size_t number, bool commanded,
               std::string& csv) {
  const MillingPoint& point = planned.point;
  const bool skipped = planned.skip != Infeasibility::kNone;
  Row row(csv);
  row.Whole(number).Whole(static_cast<size_t>(pass.pass));
  row.Text(skipped ? "" : std::to_string(planned.piece));
  row.Text(KindName(point.kind)).Text(skipped ? "skipped" : "planned").Number(point.arc_length);
  row.Vector(point.position).Vector(point.normal).Vector(point.tool_axis);
  if (skipped)
    row.Empty(kPlannedColumns);
  else
    AppendPlanned(planned, &row);
  row.Vector(point.feed).Number(point.feed_rate * 60);
  row.Optimum(planned.genetic_optimum).Optimum(planned.exhaustive_optimum);
  row.Text(skipped ? ToString(planned.skip) : "");
  if (skipped)
    row.Empty(4);
  else
    row.Number(planned.lambda_3).Vector(planned.lambda_3_direction);
  row.Optimum(planned.own_optimum);
  if (commanded) AppendCommanded(planned, &row);
}

// What stands behind a row.
std::string EndOfRow(const std::vector<ExternalAxis>& axes, const ExternalPosition& external) {
  std::string text;
  for (size_t i = 0; i < axes.size(); ++i)
    fmt::format_to(std::back_inserter(text), ",{:.17g}",
                   axes[i].kind == AxisKind::kLinear ? external[i] : RadToDeg(external[i]));
  return text;
}

void AppendLean(const PlanResult& plan, const PlannedPoint& planned, const CutterShape& cutter,
                std::string& csv) {
  constexpr double kMetresPerMinute = 60e-3;  // of a mm/s
  if (planned.skip != Infeasibility::kNone) {
    csv.append(cutter.IsBall() ? 3 : 2, ',');
    return;
  }
  const MillingPoint& point = planned.point;
  const Leans leans = LeansOf(planned);
  csv += ',';  // goes on with a row
  Row row(csv);
  row.Number(RadToDeg(leans.lead)).Number(RadToDeg(leans.tilt));
  if (!cutter.IsBall()) return;
  const double radius = ContactRadius(cutter, point.normal, point.tool_axis);
  row.Number(2 * kPi * radius * plan.spindle_speed * kMetresPerMinute);
}

// What marks of a gear are told in.
double MarkShown(const LostMotionReport& lost, const GearMark& mark, const std::vector<ExternalAxis>& axes) {
  return 1e3 * HeightOf(mark, lost.model).value_or(HeightPerUnit(mark, axes));
}

std::string LostMotionHeader(const LostMotionReport& lost, const std::vector<ExternalAxis>& axes) {
  std::string header;
  for (size_t i = 0; i < 6 + axes.size(); ++i) {
    const bool linear = i >= 6 && axes[i - 6].kind == AxisKind::kLinear;
    fmt::format_to(std::back_inserter(header), ",mark_{}{}_um{}", i < 6 ? 'a' : 'e', i < 6 ? i + 1 : i - 5,
                   lost.model.known[i] ? ""
                   : linear            ? "_per_um"
                                       : "_per_arcmin");
  }
  return header + ",lost_motion_um";
}

void AppendLostMotion(const LostMotionReport& lost, const std::vector<ExternalAxis>& axes, size_t number,
                      std::string& csv) {
  std::array<std::optional<double>, kMostGears> marks;
  const std::vector<GearMark>& all = lost.course.marks;
  for (auto mark = std::ranges::lower_bound(all, number, {}, &GearMark::point);
       mark != all.end() && mark->point == number; ++mark)
    marks[static_cast<size_t>(mark->gear)] = MarkShown(lost, *mark, axes);
  const auto cell = [&](const std::optional<double>& value) {
    csv += ',';
    if (value) fmt::format_to(std::back_inserter(csv), "{:.17g}", *value);
  };
  for (size_t i = 0; i < 6 + axes.size(); ++i) cell(marks[i]);
  const std::optional<double>& error = lost.course.errors[number];
  cell(error ? std::optional(1e3 * *error) : std::nullopt);
}

}  // namespace

void WritePointsCsv(const PlanResult& plan, const CutterShape& cutter, const LostMotionReport* lost_motion,
                    int threads, const ByteSink& sink) {
  const bool commanded = FiguresOfCompensation(plan).has_value(), leans = HasLeans(plan);
  sink(kHeader);
  if (commanded) sink(kCommandedHeader);
  if (leans) sink(kLeanHeader);
  if (leans && cutter.IsBall()) sink(kSpeedHeader);
  const std::vector<ExternalAxis>& axes = plan.external_axes;
  for (size_t i = 0; i < axes.size(); ++i)
    sink(fmt::format(",e{}_{}", i + 1, axes[i].kind == AxisKind::kLinear ? "mm" : "deg"));
  if (lost_motion) sink(LostMotionHeader(*lost_motion, axes));
  sink("\n");
  std::vector<size_t> first_numbers;
  size_t total = 0;
  for (const PassResult& pass : plan.passes) {
    first_numbers.push_back(total);
    total += pass.points.size();
  }
  const auto rows = [&](size_t p) {
    std::string csv;
    const PassResult& pass = plan.passes[p];
    const std::string standing = EndOfRow(axes, pass.external);
    for (size_t i = 0; i < pass.points.size(); ++i) {
      std::string row;
      AppendRow(pass, pass.points[i], first_numbers[p] + i, commanded, row);
      if (leans) AppendLean(plan, pass.points[i], cutter, row);
      row += pass.points[i].external ? EndOfRow(axes, *pass.points[i].external) : standing;
      if (lost_motion) AppendLostMotion(*lost_motion, axes, first_numbers[p] + i, row);
      csv += row + '\n';
    }
    return csv;
  };
  WriteInOrder(plan.passes.size(), threads, {}, rows, sink);
}

}  // namespace millpose
