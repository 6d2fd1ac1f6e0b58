// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.hpp"
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

class Row {
 public:
  Row& Text(std::string_view text) {
    if (!line_.empty()) line_ += ',';
    line_ += text;
    return *this;
  }
  Row& Number(double value) { return Text(fmt::format("{:.17g}", value)); }
  Row& Vector(const Eigen::Vector3d& vector) {
    return Number(vector.x()).Number(vector.y()).Number(vector.z());
  }
  Row& Empty(int count) {
    line_.append(static_cast<size_t>(count), ',');
    return *this;
  }
  const std::string& line() const { return line_; }

 private:
  std::string line_;
};

void AppendPlanned(const PlannedPoint& point, Row* row) {
  for (int i = 0; i < 6; ++i) row->Number(RadToDeg(point.q[i]));
  row->Number(RadToDeg(point.freedoms.at(0))).Text(std::to_string(point.branch));
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
  row->Vector(planned.point.position + c.shift).Vector(planned.point.tool_axis);
  for (int i = 0; i < 6; ++i) row->Number(RadToDeg(c.q[i]));
}

}  // namespace

std::string PointsCsv(const PlanResult& plan) {
  const bool commanded = FiguresOfCompensation(plan).has_value();
  std::string csv = kHeader;
  if (commanded) csv += kCommandedHeader;
  csv += '\n';
  size_t number = 0;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& planned : pass.points) {
      const MillingPoint& point = planned.point;
      const bool skipped = planned.skip != Obstacle::kNone;
      Row row;
      row.Text(std::to_string(number++)).Text(std::to_string(pass.pass));
      row.Text(skipped ? "" : std::to_string(planned.piece));
      row.Text(KindName(point.kind)).Text(skipped ? "skipped" : "planned").Number(point.arc_length);
      row.Vector(point.position).Vector(point.normal).Vector(point.tool_axis);
      if (skipped)
        row.Empty(kPlannedColumns);
      else
        AppendPlanned(planned, &row);
      row.Vector(point.feed).Number(point.feed_rate * 60);
      row.Text(planned.genetic_optimum > 0 ? fmt::format("{:.17g}", planned.genetic_optimum) : "");
      row.Text(planned.exhaustive_optimum > 0 ? fmt::format("{:.17g}", planned.exhaustive_optimum) : "");
      row.Text(skipped ? ToString(planned.skip) : "");
      if (skipped)
        row.Empty(4);
      else
        row.Number(planned.lambda_3).Vector(planned.lambda_3_direction);
      row.Text(planned.own_optimum > 0 ? fmt::format("{:.17g}", planned.own_optimum) : "");
      if (commanded) AppendCommanded(planned, &row);
      csv += row.line() + '\n';
    }
  return csv;
}

}  // namespace millpose
