// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/points_table.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

namespace millpose {
namespace {

const std::vector<std::string>& RequiredColumns() {
  static const std::vector<std::string> columns{
      "point",          "pass",          "piece",  "kind",         "status",    "s_mm",
      "x_mm",           "y_mm",          "z_mm",   "a1_deg",       "a2_deg",    "a3_deg",
      "a4_deg",         "a5_deg",        "a6_deg", "rotation_deg", "branch",    "lambda_t1_mm_N",
      "lambda_t2_mm_N", "lambda_n_mm_N", "mu",     "dexterity",    "objective", "clearance_mm"};
  return columns;
}

bool IsText(std::string_view column) { return column == "kind" || column == "status" || column == "reason"; }

}  // namespace

std::vector<std::string> SplitCells(std::string_view line) {
  std::vector<std::string> cells;
  for (size_t begin = 0; begin <= line.size();) {
    const size_t end = std::min(line.find(',', begin), line.size());
    cells.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

PointsTable::PointsTable(std::string csv, const std::string& name) {
  std::vector<Problem> problems;
  int number = 0;
  for (size_t begin = 0; begin < csv.size() && problems.size() < 20;) {
    const size_t end = std::min(csv.find('\n', begin), csv.size());
    std::vector<std::string> cells = SplitCells(std::string_view(csv).substr(begin, end - begin));
    begin = end + 1;
    if (++number == 1) {
      columns_ = std::move(cells);
      for (const std::string& column : RequiredColumns())
        if (std::ranges::find(columns_, column) == columns_.end())
          problems.push_back({{name, 1}, fmt::format("the column {} is missing", column)});
      continue;
    }
    if (cells.size() != columns_.size()) {
      problems.push_back(
          {{name, number}, fmt::format("given {} cells; allowed: {}", cells.size(), columns_.size())});
      continue;
    }
    for (size_t i = 0; i < cells.size(); ++i)
      if (!IsText(columns_[i]) && !cells[i].empty() && !ParseNumber(cells[i]))
        problems.push_back(
            {{name, number}, fmt::format("{}: given {}; allowed: a number", columns_[i], cells[i])});
    rows_.push_back(std::move(cells));
  }
  if (number == 0) problems.push_back({{name}, "is empty; allowed: points as written by millpose plan"});
  if (!problems.empty()) throw InputError(std::move(problems));
}

size_t PointsTable::ColumnIndex(std::string_view column) const {
  const auto found = std::ranges::find(columns_, column);
  if (found == columns_.end()) throw std::out_of_range(fmt::format("points.csv has no column {}", column));
  return static_cast<size_t>(found - columns_.begin());
}

const std::string& PointsTable::Text(size_t row, std::string_view column) const {
  return rows_.at(row)[ColumnIndex(column)];
}

std::optional<double> PointsTable::Number(size_t row, std::string_view column) const {
  return ParseNumber(Text(row, column));
}

}  // namespace millpose
