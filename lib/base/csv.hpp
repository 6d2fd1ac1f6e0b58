// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace millpose {

/// Which columns a CSV file of numbers must and may have; names carry their unit ("x_mm").
struct CsvColumns {
  std::vector<std::string> required, optional;
};

/// A CSV file of numbers as read.
class CsvTable {
 public:
  CsvTable(std::vector<std::string> header, std::vector<std::vector<double>> rows, std::vector<int> lines)
      : header_(std::move(header)), rows_(std::move(rows)), lines_(std::move(lines)) {}

  size_t size() const { return rows_.size(); }
  /// Line of the file that row `row` stands in, from 1.
  int line(size_t row) const { return lines_[row]; }
  bool Has(std::string_view column) const;
  /// The column must be there.
  double At(size_t row, std::string_view column) const;

 private:
  std::vector<std::string> header_;
  std::vector<std::vector<double>> rows_;
  std::vector<int> lines_;
};

/// Reads a header line that names the columns, then one row of finite numbers per line, separated by commas.
/// Blank lines and lines that start with # are passed over; LF or CRLF. Throws InputError with
/// file:line:column for a missing, unknown or doubled column (with the nearest known one), a row of another
/// length, and text that is no number; the first hundred problems are listed.
CsvTable ReadCsv(std::string_view text, const std::string& name, const CsvColumns& columns);

}  // namespace millpose
