// SPDX-License-Identifier: GPL-3.0-or-later
// Random CSV paths written by a writer that knows the points, and their reading.
#include <algorithm>

#include "base/error.hpp"
#include "tests/toolpath/generated_paths.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;

class CsvWriter {
 public:
  explicit CsvWriter(uint64_t index) : random_(index, 89) {}

  GeneratedPath Write() {
    separator_ = ",;\t"[random_.Below(3)];
    const size_t unit = random_.Below(3), feed = random_.Below(4);
    const std::string suffix = std::array{"_mm", "_m", "_in"}[unit];
    factor_ = std::array{1.0, 1000.0, 25.4}[unit];
    feed_factor_ = std::array{0.0, 1.0, 1 / 60.0, 25.4 / 60}[feed];
    std::vector<std::string> columns{"x" + suffix, "y" + suffix, "z" + suffix};
    if (random_.Chance(0.6)) columns.insert(columns.end(), {"i", "j", "k"});
    if (feed > 0) columns.emplace_back(std::array{"", "feed_mm_s", "feed_mm_min", "feed_in_min"}[feed]);
    if (random_.Chance(0.6)) columns.emplace_back("rapid");
    if (random_.Chance(0.3)) columns.emplace_back("pass");
    if (random_.Chance(0.3)) columns.emplace_back("comment");
    for (size_t i = columns.size(); i > 1; --i) std::swap(columns[i - 1], columns[random_.Below(i)]);
    Row(columns);
    const size_t rows = 2 + random_.Below(20);
    for (size_t i = 0; i < rows; ++i) Point(columns);
    return {text_, wants_, 0};
  }

 private:
  void Row(const std::vector<std::string>& cells) {
    if (random_.Chance(0.1)) text_ += "# a remark, 1,2,3\n";
    for (size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) text_ += separator_;
      text_ += random_.Chance(0.1) ? " " + cells[i] + " " : cells[i];
    }
    text_ += random_.Chance(0.2) ? "\r\n" : "\n";
  }

  std::string Number(double value) {
    std::string text = fmt::format("{:.9f}", value);
    if (separator_ == ';' && random_.Chance(0.5)) std::ranges::replace(text, '.', ',');
    return text;
  }

  void Point(const std::vector<std::string>& columns) {
    const Vector p = Printed(random_.Vector(200 / factor_));
    const Vector axis = Printed(Vector(random_.Vector(1) + Vector(0, 0, 1.5)));
    const double feed = Printed(random_.Between(1, 3000));
    const bool rapid = random_.Chance(0.2);
    Want want;
    want.to = factor_ * p;
    want.feed = feed * feed_factor_;
    std::vector<std::string> cells;
    for (const std::string& column : columns) {
      if (column == "i") want.axis = axis.normalized();
      if (column == "rapid" && rapid) want.kind = Want::Kind::kRapid;
      const bool place = column[0] >= 'x' && column[0] <= 'z';
      cells.push_back(place                ? Number(p[column[0] - 'x'])
                      : column.size() == 1 ? Number(axis[column[0] - 'i'])
                      : column[0] == 'f'   ? Number(feed)
                      : column == "rapid"  ? (rapid ? "1" : "0")
                      : column == "pass"   ? "3"
                                           : "GOTO/1");
    }
    Row(cells);
    wants_.push_back(want);
  }

  WriterRandom random_;
  char separator_ = ',';
  double factor_ = 1, feed_factor_ = 0;
  std::string text_;
  std::vector<Want> wants_;
};

TEST(CsvGenerator, PathsAreReadAsTheyAreMeant) {
  for (uint64_t i = 0; i < GeneratedCount(); ++i) {
    ExpectRead(CsvWriter(i).Write(), {}, i);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(CsvGenerator, EveryUnknownColumnIsRefused) {
  for (uint64_t i = 0; i < GeneratedCount() / 10; ++i) {
    RandomStream random(i, 97);
    const std::string word = RandomWord(random);
    const std::string text = "x_mm," + word + ",y_mm,z_mm\n1,2,3,4\n";
    try {
      ReadCamPath(text, "spoilt", {});
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("spoilt:1:6: \"column " + word), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace millpose
