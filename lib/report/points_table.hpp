// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace millpose {

/// The cells of a line of our CSV files, which have no quotes.
std::vector<std::string> SplitCells(std::string_view line);

/// points.csv as read back: columns by name, rows in the file's order.
class PointsTable {
 public:
  /// Throws InputError with `name` and line for what is no points.csv: missing columns, rows of another
  /// length, cells that are no numbers.
  PointsTable(std::string csv, const std::string& name);

  size_t size() const { return rows_.size(); }
  const std::vector<std::string>& columns() const { return columns_; }
  /// The cell as written; empty where the point has no such value.
  const std::string& Text(size_t row, std::string_view column) const;
  /// Empty where the cell is.
  std::optional<double> Number(size_t row, std::string_view column) const;
  bool IsPlanned(size_t row) const { return Text(row, "status") == "planned"; }

 private:
  size_t ColumnIndex(std::string_view column) const;

  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace millpose
