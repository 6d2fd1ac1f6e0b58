// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of an output folder.
#include <sstream>

#include "tests/audit/folder.hpp"

namespace millpose::audit {
namespace {

/// Comma-separated values by the name of their column.
class Table {
 public:
  Table(std::string name, const std::string& csv) : name_(std::move(name)), lines_(csv) {
    Next();
    for (size_t i = 0; i < cells_.size(); ++i) columns_.emplace(cells_[i], i);
  }

  bool Next() {
    std::string line;
    if (!std::getline(lines_, line)) return false;
    ++number_;
    cells_.assign(1, "");
    for (const char c : line) {
      if (c == ',')
        cells_.emplace_back();
      else
        cells_.back() += c;
    }
    return true;
  }

  bool Has(const char* name) const { return columns_.contains(name); }
  const std::string& At(const char* name) const { return cells_.at(columns_.at(name)); }
  Real Number(const char* name) const {
    size_t used = 0;
    const Real value = std::stold(At(name), &used);
    if (used != At(name).size() || !std::isfinite(value))
      throw std::runtime_error(name_ + ":" + std::to_string(number_) + ": " + name + " is '" + At(name) +
                               "'");
    return value;
  }
  Vector3 Three(const char* x, const char* y, const char* z) const {
    return {Number(x), Number(y), Number(z)};
  }

 private:
  std::string name_;
  std::istringstream lines_;
  std::map<std::string, size_t> columns_;
  std::vector<std::string> cells_;
  int number_ = 0;
};

void ReadMarks(const Table& table, Row& row) {
  constexpr Real kMicrometre = 1e-3L;
  const auto cell = [&](const std::string& name) -> std::optional<Real> {
    if (table.At(name.c_str()).empty()) return std::nullopt;
    return kMicrometre * table.Number(name.c_str());
  };
  for (size_t gear = 0; gear < 6 + row.external.size(); ++gear) {
    const std::string name =
        "mark_" + std::string(gear < 6 ? "a" : "e") + std::to_string(gear < 6 ? gear + 1 : gear - 5) + "_um";
    for (const char* per : {"", "_per_arcmin", "_per_um"})
      if (table.Has((name + per).c_str())) row.marks.push_back(cell(name + per));
  }
  if (table.Has("lost_motion_um")) row.lost_motion = cell("lost_motion_um");
}

}  // namespace

std::map<int, Deflected> ReadDeflected(const std::string& csv, const Matrix3& R_WP) {
  constexpr Real kMicrometre = 1e-3L;
  Table table("deflection.csv", csv);
  std::map<int, Deflected> rows;
  while (table.Next())
    rows[std::stoi(table.At("point"))] = {R_WP * table.Three("force_x_N", "force_y_N", "force_z_N"),
                                          kMicrometre * R_WP * table.Three("x_um", "y_um", "z_um"),
                                          kMicrometre * table.Number("normal_um"),
                                          kMicrometre * table.Number("feed_um"),
                                          kMicrometre * table.Number("across_um"),
                                          kMicrometre * table.Number("length_um"),
                                          table.At("side") == "air"};
  return rows;
}

std::map<int, Compensated> ReadCompensated(const std::string& csv, const Matrix3& R_WP) {
  constexpr Real kMicrometre = 1e-3L;
  Table table("compensation.csv", csv);
  std::map<int, Compensated> rows;
  while (table.Next())
    rows[std::stoi(table.At("point"))] = {
        R_WP * table.Three("force_x_N", "force_y_N", "force_z_N"),
        kMicrometre * table.Number("normal_low_um"),
        kMicrometre * table.Number("normal_expected_um"),
        kMicrometre * table.Number("normal_high_um"),
        kMicrometre * table.Number("normal_taken_um"),
        kMicrometre * table.Number("normal_worst_after_um"),
        kMicrometre * R_WP * table.Three("shift_x_um", "shift_y_um", "shift_z_um"),
        kMicrometre * R_WP * table.Three("arm_x_um", "arm_y_um", "arm_z_um")};
  return rows;
}

std::vector<Row> ReadPoints(const std::string& csv) {
  Table table("points.csv", csv);
  std::vector<Row> rows;
  while (table.Next()) {
    Row row{};
    row.point = std::stoi(table.At("point"));
    row.pass = std::stoi(table.At("pass"));
    row.cut = table.At("kind") == "cut";
    row.position = table.Three("x_mm", "y_mm", "z_mm");
    row.normal = table.Three("nx", "ny", "nz");
    row.axis = table.Three("tx", "ty", "tz");
    row.feed_direction = table.Three("fx", "fy", "fz");
    row.planned = !table.At("a1_deg").empty();
    if (row.planned) {
      row.piece = std::stoi(table.At("piece"));
      const char* names[] = {"a1_deg", "a2_deg", "a3_deg", "a4_deg", "a5_deg", "a6_deg"};
      for (size_t i = 0; i < 6; ++i) row.angles[i] = table.Number(names[i]) * kDegree;
      row.rotation = table.Number("rotation_deg") * kDegree;
      row.lambda_t1 = table.Number("lambda_t1_mm_N");
      row.lambda_t2 = table.Number("lambda_t2_mm_N");
      row.lambda_n = table.Number("lambda_n_mm_N");
      row.mu = table.Number("mu");
      row.dexterity = table.Number("dexterity");
      row.objective = table.Number("objective");
      row.feed = table.Number("feed_mm_min") / 60;
      if (table.Has("lead_deg"))
        row.lean = {table.Number("lead_deg") * kDegree, table.Number("tilt_deg") * kDegree};
    }
    if (row.planned && table.Has("commanded_x_mm")) {
      Row::Commanded& commanded = row.commanded.emplace();
      commanded.position = table.Three("commanded_x_mm", "commanded_y_mm", "commanded_z_mm");
      commanded.axis = table.Three("commanded_tx", "commanded_ty", "commanded_tz");
      for (size_t i = 0; i < 6; ++i)
        commanded.angles[i] =
            table.Number(("commanded_a" + std::to_string(i + 1) + "_deg").c_str()) * kDegree;
    }
    for (int i = 1; i <= 3; ++i) {
      const std::string name = "e" + std::to_string(i);
      if (table.Has((name + "_mm").c_str())) row.external.push_back(table.Number((name + "_mm").c_str()));
      if (table.Has((name + "_deg").c_str()))
        row.external.push_back(table.Number((name + "_deg").c_str()) * kDegree);
    }
    if (row.planned) ReadMarks(table, row);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace millpose::audit
