// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/report/page_data.hpp"

namespace millpose {
namespace {

// The page's 16-bit steps are the spans to half a step, and what stands nowhere is told apart.
TEST(ReportHtml, CarriesTheMaterialAsItFalls) {
  Removal removal;
  removal.along = 1, removal.spacing = 2, removal.rows = 1, removal.columns = 3, removal.volume = 5000;
  removal.blank = {{-10, 50}, {0, -1}, {-10, 47.25}};
  removal.part = {{-10, 12.5}, {0, -1}, {0, -1}};
  removal.frames = {{1.5, 4000, 1}, {2.5, 3500, 1}};
  removal.lines = {0, 2};
  removal.ends = {{-10, 33.3}, {0, -1}};
  HtmlInput input = SmallPanel().Input();
  EXPECT_TRUE(DataOf(ReportHtml(input)).at("removal").is_null());
  input.removal = &removal;
  const Json json = DataOf(ReportHtml(input)).at("removal");
  const double low = json.at("range_mm")[0], step = (json.at("range_mm")[1].get<double>() - low) / 65534;
  const auto expect = [&](const char* key, const std::vector<Span>& spans) {
    const std::vector<uint8_t> bytes = Decoded(json.at(key).get<std::string>());
    ASSERT_EQ(bytes.size(), 4 * spans.size());
    for (size_t i = 0; i < spans.size(); ++i) {
      const auto at = [&](size_t k) { return bytes[4 * i + k] | bytes[4 * i + k + 1] << 8; };
      if (spans[i].high < spans[i].low) {
        EXPECT_EQ(at(0), 65535);
        EXPECT_EQ(at(2), 0);
        continue;
      }
      EXPECT_NEAR(low + step * at(0), spans[i].low, 0.51 * step);
      EXPECT_NEAR(low + step * at(2), spans[i].high, 0.51 * step);
    }
  };
  expect("blank", removal.blank);
  expect("part", removal.part);
  expect("ends", removal.ends);
  EXPECT_EQ(json.at("cm3"), 5);
  EXPECT_EQ(Decoded(json.at("changed").get<std::string>()), (std::vector<uint8_t>{1, 0, 0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(json.at("along"), 1);
}

}  // namespace
}  // namespace millpose
