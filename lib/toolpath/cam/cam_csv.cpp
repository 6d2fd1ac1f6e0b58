// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "toolpath/cam/cam_path.hpp"
#include "toolpath/cam/word_tally.hpp"

namespace millpose {
namespace {

// Columns that a header may name; lengths carry their unit.
enum Column : uint8_t { kX, kY, kZ, kI, kJ, kK, kFeed, kRapid, kPass, kColumns };

struct Named {
  Column column;
  double factor;  // to mm, mm/s
};

std::optional<Named> ColumnOf(const std::string& name) {
  static const std::map<std::string, Named> names{{"x_mm", {kX, 1}},
                                                  {"y_mm", {kY, 1}},
                                                  {"z_mm", {kZ, 1}},
                                                  {"x_m", {kX, 1000}},
                                                  {"y_m", {kY, 1000}},
                                                  {"z_m", {kZ, 1000}},
                                                  {"x_in", {kX, 25.4}},
                                                  {"y_in", {kY, 25.4}},
                                                  {"z_in", {kZ, 25.4}},
                                                  {"i", {kI, 1}},
                                                  {"j", {kJ, 1}},
                                                  {"k", {kK, 1}},
                                                  {"feed_mm_s", {kFeed, 1}},
                                                  {"feed_mm_min", {kFeed, 1.0 / 60}},
                                                  {"feed_in_min", {kFeed, 25.4 / 60}},
                                                  {"rapid", {kRapid, 1}},
                                                  {"pass", {kPass, 1}}};
  const auto found = names.find(name);
  return found == names.end() ? std::nullopt : std::optional(found->second);
}

// Columns that say nothing about the path; their cells may hold anything.
bool IsHarmlessColumn(const std::string& name) {
  static const std::set<std::string> names{"line", "point", "index", "comment", "note", "name", "operation"};
  return names.contains(name);
}

class CsvReader {
 public:
  CsvReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  CamPath Read() {
    std::vector<std::string> cells;
    while (TakeLine(cells)) {
      if (columns_.empty()) {
        TakeHeader(cells);
      } else {
        TakeRow(cells);
      }
    }
    if (columns_.empty()) throw InputError({name_}, "the file is empty");
    if (path_.points.empty()) throw InputError({name_}, "the file holds no points");
    tally_.AddNote(path_.notes);
    CheckReach(path_, name_);
    path_.source = {"CSV", unit_, "as written", has_axis_ ? "" : "+z", {}};
    return std::move(path_);
  }

 private:
  // The next line that is neither empty nor a comment, split at the separator; false at the end.
  bool TakeLine(std::vector<std::string>& cells) {
    while (at_ < bytes_.size()) {
      const size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
      std::string_view line = bytes_.substr(at_, end - at_);
      at_ = end + 1;
      ++line_;
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
      if (line.find_first_not_of(" \t") == std::string_view::npos || line.starts_with('#')) continue;
      if (columns_.empty()) {
        const size_t mark = line.find_first_of(",;\t");
        separator_ = mark == std::string_view::npos ? ',' : line[mark];
      }
      Split(line, cells);
      return true;
    }
    return false;
  }

  void Split(std::string_view line, std::vector<std::string>& cells) {
    cells.clear();
    starts_.clear();
    for (size_t begin = 0; begin <= line.size();) {
      const size_t end = std::min(line.find(separator_, begin), line.size());
      std::string cell(line.substr(begin, end - begin));
      starts_.push_back(static_cast<int>(begin) + 1);
      cell.erase(0, cell.find_first_not_of(' '));
      cell.erase(cell.find_last_not_of(' ') + 1);
      if (separator_ == ';') std::ranges::replace(cell, ',', '.');  // decimal commas
      cells.push_back(std::move(cell));
      begin = end + 1;
    }
  }

  SourceLocation At(size_t cell) const { return {name_, line_, cell < starts_.size() ? starts_[cell] : 0}; }

  void TakeHeader(const std::vector<std::string>& cells) {
    std::array<int, kColumns> count{};
    for (size_t i = 0; i < cells.size(); ++i) {
      columns_.push_back(ColumnOf(cells[i]));
      if (columns_.back() && columns_.back()->column == kX) unit_ = cells[i].substr(2) + ", by its header";
      if (!columns_.back()) {
        TakeOtherColumn(cells[i], At(i));
      } else if (++count[columns_.back()->column] > 1) {
        throw InputError(At(i), fmt::format("column \"{}\" is there twice", cells[i]));
      }
    }
    tally_.RefuseUnknown({});
    for (const auto& [column, name] : {std::pair(kX, "x"), std::pair(kY, "y"), std::pair(kZ, "z")})
      if (count[column] == 0)
        throw InputError(At(0), fmt::format("the header names no column {0}_mm (or {0}_m, {0}_in)", name));
    const int axes = count[kI] + count[kJ] + count[kK];
    if (axes != 0 && axes != 3) throw InputError(At(0), "the tool axis needs all of the columns i, j, k");
    has_axis_ = axes == 3;
  }

  void TakeOtherColumn(const std::string& name, const SourceLocation& place) {
    if (IsHarmlessColumn(name))
      tally_.CountHarmless("column " + name);
    else
      tally_.AddUnknown("column " + name, place);
  }

  void TakeRow(const std::vector<std::string>& cells) {
    if (cells.size() != columns_.size())
      throw InputError(At(0),
                       fmt::format("{} values, the header names {} columns", cells.size(), columns_.size()));
    std::array<double, kColumns> values{};
    for (size_t i = 0; i < cells.size(); ++i) {
      if (!columns_[i]) continue;
      const std::optional<double> number = ParseNumber(cells[i]);
      if (!number)
        throw InputError(At(i),
                         fmt::format("expected a finite number, found \"{}\"", cells[i].substr(0, 40)));
      values[columns_[i]->column] = *number * columns_[i]->factor;
    }
    CamPoint point;
    point.position = {values[kX], values[kY], values[kZ]};
    if (has_axis_) point.axis = {values[kI], values[kJ], values[kK]};
    if (!(point.axis.norm() > 1e-6)) throw InputError(At(0), "the tool axis has no length");
    point.axis.normalize();
    point.feed_rate = values[kFeed];
    if (values[kRapid] != 0 && values[kRapid] != 1)
      throw InputError(At(0), fmt::format("rapid is 0 or 1, found {}", values[kRapid]));
    if (!(values[kFeed] >= 0)) throw InputError(At(0), fmt::format("a feed below 0: {} mm/s", values[kFeed]));
    point.rapid = values[kRapid] != 0;
    point.fresh = !path_.points.empty() && values[kPass] != pass_;
    pass_ = values[kPass];
    point.line = line_;
    path_.points.push_back(point);
  }

  std::string_view bytes_;
  const std::string& name_;
  size_t at_ = 0;
  int line_ = 0;
  char separator_ = ',';
  std::vector<int> starts_;  // column of each cell of the line
  std::vector<std::optional<Named>> columns_;
  WordTally tally_;
  std::string unit_;
  bool has_axis_ = false;
  double pass_ = 0;
  CamPath path_;
};

}  // namespace

CamPath ReadCamCsv(std::string_view bytes, const std::string& name) { return CsvReader(bytes, name).Read(); }

}  // namespace millpose
