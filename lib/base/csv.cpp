// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/csv.hpp"

#include <algorithm>
#include <cassert>

#include "base/error.hpp"
#include "base/text.hpp"

namespace millpose {
namespace {

constexpr size_t kMostOfTable = 100;

struct Cell {
  std::string_view text;
  int column;  ///< from 1
};

std::string_view Trim(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<Cell> Split(std::string_view line) {
  std::vector<Cell> cells;
  size_t start = 0;
  while (true) {
    const size_t end = std::min(line.find(',', start), line.size());
    cells.push_back({Trim(line.substr(start, end - start)), static_cast<int>(start) + 1});
    if (end == line.size()) return cells;
    start = end + 1;
  }
}

bool Contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

class Reader {
 public:
  Reader(const std::string& name, const CsvColumns& columns) : name_(name), columns_(columns) {}

  CsvTable Read(std::string_view text) {
    int number = 0;
    while (!text.empty() && problems_.size() < kMostOfTable) {
      const size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      ++number;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
      if (Trim(line).empty() || Trim(line).front() == '#') continue;
      if (header_.empty()) {
        ReadHeader(line, number);
        if (!problems_.empty()) break;
      } else {
        ReadRow(line, number);
      }
    }
    if (header_.empty() && problems_.empty()) Add(0, 0, "no header line; wanted: " + Wanted());
    if (!problems_.empty()) throw InputError(std::move(problems_));
    return {std::move(header_), std::move(rows_), std::move(lines_)};
  }

 private:
  std::string Wanted() const {
    std::string text = fmt::format("{}", fmt::join(columns_.required, ","));
    if (!columns_.optional.empty())
      text += fmt::format(" and optionally {}", fmt::join(columns_.optional, ","));
    return text;
  }

  void Add(int line, int column, std::string message) {
    problems_.push_back({{name_, line, column}, std::move(message)});
  }

  void ReadHeader(std::string_view line, int number) {
    std::vector<std::string> known = columns_.required;
    known.insert(known.end(), columns_.optional.begin(), columns_.optional.end());
    for (const Cell& cell : Split(line)) {
      const std::string column(cell.text);
      if (Contains(header_, column))
        Add(number, cell.column, fmt::format("column \"{}\" is given twice", column));
      if (!Contains(known, column)) {
        const std::string nearest = NearestName(column, known);
        Add(number, cell.column,
            fmt::format("unknown column \"{}\"; known: {}{}", column, fmt::join(known, ", "),
                        nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest)));
      }
      header_.push_back(column);
    }
    for (const std::string& column : columns_.required)
      if (!Contains(header_, column)) Add(number, 0, fmt::format("column \"{}\" is missing", column));
  }

  void ReadRow(std::string_view line, int number) {
    const std::vector<Cell> cells = Split(line);
    if (cells.size() != header_.size())
      return Add(number, 0, fmt::format("given {} cells; the header names {}", cells.size(), header_.size()));
    std::vector<double> row;
    for (size_t i = 0; i < cells.size(); ++i) {
      const std::optional<double> value = ParseNumber(cells[i].text);
      if (!value)
        Add(number, cells[i].column,
            fmt::format("{}: given \"{}\"; allowed: a finite number", header_[i], cells[i].text));
      row.push_back(value.value_or(0));
    }
    rows_.push_back(std::move(row));
    lines_.push_back(number);
  }

  const std::string& name_;
  const CsvColumns& columns_;
  std::vector<Problem> problems_;
  std::vector<std::string> header_;
  std::vector<std::vector<double>> rows_;
  std::vector<int> lines_;
};

}  // namespace

bool CsvTable::Has(std::string_view column) const { return Contains(header_, column); }

double CsvTable::At(size_t row, std::string_view column) const {
  const auto found = std::find(header_.begin(), header_.end(), column);
  assert(found != header_.end());
  return rows_[row][static_cast<size_t>(found - header_.begin())];
}

CsvTable ReadCsv(std::string_view text, const std::string& name, const CsvColumns& columns) {
  return Reader(name, columns).Read(text);
}

}  // namespace millpose
