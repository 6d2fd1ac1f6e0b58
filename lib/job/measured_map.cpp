// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/measured_map.hpp"

#include "base/csv.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kMicrometres = 1000;
constexpr std::array<const char*, 6> kJointColumns = {"a1_deg", "a2_deg", "a3_deg",
                                                      "a4_deg", "a5_deg", "a6_deg"};

/// A map's rows beside the points of a plan; what does not fit is collected.
class MapReader {
 public:
  MapReader(const JobInputs& inputs, const PlanResult& plan)
      : file_(inputs.job.compensation.map_file),
        plan_(plan),
        table_(ReadCsv(inputs.map_bytes, file_, Columns())) {
    for (size_t p = 0; p < plan.passes.size(); ++p)
      for (size_t i = 0; i < plan.passes[p].points.size(); ++i) points_.emplace_back(p, i);
  }

  /// Calls `visit(row, pass, point)` for each row of a planned point.
  template <class Visit>
  void ForEach(Visit visit) {
    std::vector<char> given(points_.size(), 0);
    for (size_t row = 0; row < table_.size(); ++row) {
      const double number = table_.At(row, "point");
      if (number != std::floor(number) || number < 0 || number >= static_cast<double>(points_.size())) {
        Add(row, fmt::format("point: given {}; allowed: 0 to {}, the points of this plan", number,
                             points_.size() - 1));
        continue;
      }
      const auto at = static_cast<size_t>(number);
      if (std::exchange(given[at], 1) != 0) Add(row, fmt::format("point {} is given twice", at));
      visit(row, points_[at].first, points_[at].second);
    }
    for (size_t at = 0; at < points_.size(); ++at)
      if (given[at] == 0 && Point(points_[at]).skip == Infeasibility::kNone)
        AddAt({file_}, fmt::format("point {} of this plan has no row", at));
    if (!problems_.empty()) throw InputError(std::move(problems_));
  }

  double Value(size_t row, const char* column) const { return table_.At(row, column); }
  void Add(size_t row, std::string message) { AddAt({file_, table_.line(row)}, std::move(message)); }

 private:
  static constexpr size_t kMostProblems = 20;

  static CsvColumns Columns() {
    CsvColumns columns{{"point", "x_mm", "y_mm", "z_mm", "other_um", "map_um", "sd_um"}, {}};
    columns.required.insert(columns.required.begin() + 4, kJointColumns.begin(), kJointColumns.end());
    return columns;
  }
  const PlannedPoint& Point(const std::pair<size_t, size_t>& at) const {
    return plan_.passes[at.first].points[at.second];
  }
  void AddAt(SourceLocation place, std::string message) {
    if (problems_.size() < kMostProblems) problems_.push_back({std::move(place), std::move(message)});
  }

  std::string file_;
  const PlanResult& plan_;
  CsvTable table_;
  std::vector<std::pair<size_t, size_t>> points_;
  std::vector<Problem> problems_;
};

}  // namespace

std::string MapCsv(const std::vector<MapRow>& rows) {
  std::string csv = "point,x_mm,y_mm,z_mm";
  for (const char* column : kJointColumns) csv += fmt::format(",{}", column);
  csv += ",other_um,map_um,sd_um\n";
  for (const MapRow& row : rows) {
    csv += fmt::format("{},{:.4f},{:.4f},{:.4f}", row.point, row.place.x(), row.place.y(), row.place.z());
    for (int j = 0; j < 6; ++j) csv += fmt::format(",{:.5f}", RadToDeg(row.q[j]));
    csv += fmt::format(",{:.3f},{:.3f},{:.3f}\n", kMicrometres * row.other, kMicrometres * row.amount,
                       kMicrometres * row.sd);
  }
  return csv;
}

double OtherAlongNormal(const PlannedPoint& point) {
  if (!point.compensation) return 0;
  const Compensation& c = *point.compensation;
  return c.normal.taken + (c.weight - c.arm_shift).dot(point.point.normal);
}

PointAmounts ReadMap(const JobInputs& inputs, const PlanResult& plan) {
  constexpr double kSamePlace = 0.01, kSameJoint = 0.1, kMost = 1e4;  // mm, degrees, µm
  PointAmounts amounts;
  for (const PassResult& pass : plan.passes) amounts.emplace_back(pass.points.size(), 0.0);
  MapReader reader(inputs, plan);
  reader.ForEach([&](size_t row, size_t p, size_t i) {
    const PassResult& pass = plan.passes[p];
    const PlannedPoint& point = pass.points[i];
    const Vector3d given(reader.Value(row, "x_mm"), reader.Value(row, "y_mm"), reader.Value(row, "z_mm"));
    const Pose X_PW = PartAt(plan, ExternalAt(pass, i)).inverse(Eigen::Isometry);
    const double off = (X_PW * point.point.position - given).norm();
    if (off > kSamePlace)
      return reader.Add(row, fmt::format("the point of this plan is {:.3f} mm from x_mm, y_mm, z_mm on the "
                                         "part; allowed: {} mm: the map is of another path",
                                         off, kSamePlace));
    if (point.skip != Infeasibility::kNone) return;
    for (int j = 0; j < 6; ++j) {
      const double turned = std::abs(RadToDeg(point.q[j]) - reader.Value(row, kJointColumns[j]));
      if (turned > kSameJoint)
        return reader.Add(row,
                          fmt::format("A{} of this plan is {:.3f}° from {}; allowed: {}°: the measured part "
                                      "was milled in other poses (another tool, place of the part, arm or "
                                      "setting), whose errors are others",
                                      j + 1, turned, kJointColumns[j], kSameJoint));
    }
    const double amount = reader.Value(row, "map_um");
    if (std::abs(amount) > kMost)
      return reader.Add(row, fmt::format("map_um: given {}; allowed: within ±{}", amount, kMost));
    amounts[p][i] = amount / kMicrometres;
  });
  return amounts;
}

void CheckOthers(const JobInputs& inputs, const PlanResult& plan) {
  constexpr double kSame = 1;  // µm
  MapReader reader(inputs, plan);
  reader.ForEach([&](size_t row, size_t p, size_t i) {
    const double now = kMicrometres * OtherAlongNormal(plan.passes[p].points[i]);
    const double then = reader.Value(row, "other_um");
    if (std::abs(now - then) > kSame)
      reader.Add(row,
                 fmt::format("compensation takes out {:.2f} µm here beside the map, and {:.2f} when the "
                             "measured part was milled; allowed: the same to {} µm, with process, stiffness, "
                             "deviations and compensation as they were then",
                             now, then, kSame));
  });
}

}  // namespace millpose
