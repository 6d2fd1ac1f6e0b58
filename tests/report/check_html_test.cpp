// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/check_html.hpp"

#include <nlohmann/json.hpp>
#include <regex>

#include "report/samples/plan_removal.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose {
namespace {

using Json = nlohmann::json;

Mesh Wedge() {
  return Mesh(Triangles{{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}, {0, 0, 10}, {10, 0, 10}},
                        {{0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}}});
}

CheckHtmlInput Input(const Cell& cell, const Mesh& part, const Toolpath& path) {
  CheckHtmlInput input;
  input.title = "</script><b>";
  input.cell = &cell;
  input.part = &part;
  input.in_region = {1, 1, 0, 0};
  input.toolpath = &path;
  input.reach = {{Infeasibility::kNone, 2, 0.1, Joints::Constant(0.5)},
                 {},
                 {Infeasibility::kLimit, 4, -0.2, Joints::Constant(1)}};
  input.findings = {"a finding"};
  return input;
}

Json CheckDataOf(const std::string& page) {
  const std::string open = "id=\"check-data\">";
  const size_t from = page.find(open) + open.size();
  return Json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(CheckHtml, CarriesFacesEdgesPointsAndWhatLimitsThem) {
  const Cell cell = test::SampleCell();
  const Mesh part = Wedge();
  Toolpath path;
  path.passes.resize(1);
  path.passes[0].points.resize(3);
  const Json data = CheckDataOf(CheckHtml(Input(cell, part, path)));
  EXPECT_EQ(data["part"]["faces"].size(), 2u);
  EXPECT_EQ(data["part"]["faces"][0]["normal"], Json({0.0, 0.0, -1.0}));
  EXPECT_EQ(data["part"]["edges"].size(), 3u);  // the crease and an open border of each
  EXPECT_EQ(data["part"]["faces"][1]["number"], 2);
  EXPECT_EQ(data["path"]["total"], 3);
  EXPECT_EQ(data["cell"]["bodies"].size(), cell.bodies.size());
  EXPECT_EQ(data["findings"], Json({"a finding"}));
}

TEST(CheckHtml, SameInputSameBytesAndNothingFromOutside) {
  const Cell cell = test::SampleCell();
  const Mesh part = Wedge();
  Toolpath path;
  path.passes.resize(1);
  path.passes[0].points.resize(3);
  const std::string page = CheckHtml(Input(cell, part, path));
  EXPECT_EQ(page, CheckHtml(Input(cell, part, path)));
  EXPECT_EQ(page.find("{{"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;/script&gt;&lt;b&gt;"), std::string::npos);
  std::string own = page;
  const size_t three = own.find("(function(global,factory)");
  ASSERT_NE(three, std::string::npos);
  own.erase(three, own.find("</script>", three) - three);
  EXPECT_FALSE(std::regex_search(own, std::regex("https?://|@import|url\\(|fetch\\(|XMLHttpRequest|src=")));
}

TEST(CheckHtml, DrawsFromTheSideWhatIsTheWrongWayRound) {
  const Cell cell = test::SampleCell();
  const Mesh part = Wedge();
  Toolpath path;
  path.passes.resize(1);
  path.passes[0].points.resize(3);
  CheckHtmlInput input = Input(cell, part, path);
  const auto picture = [&] {
    const std::string page = CheckHtml(input);
    const size_t figure = page.find("<figure id=\"wrong-side\""), from = page.find("<svg", figure);
    return figure == std::string::npos ? "" : page.substr(from, page.find("</svg>", from) - from);
  };
  EXPECT_EQ(picture(), "");
  const Eigen::Vector3d base = cell.X_WB.translation();
  input.wrong_side = WrongSide{base + Eigen::Vector3d(2000, 0, 800), Eigen::Vector3d::UnitX(),
                               -Eigen::Vector3d::UnitZ(), true, true};
  const std::string drawn = picture();
  EXPECT_NE(drawn.find("normal: looks away from the arm"), std::string::npos);
  // The arrow of the normal runs to the right, away from the shoulder; the tool hangs below its tip.
  std::smatch line;
  const std::string number = "=\"([-.0-9]+)\"";
  for (const std::string name : {"normal", "tool"}) {
    ASSERT_TRUE(std::regex_search(drawn, line,
                                  std::regex("x1" + number + " y1" + number + " x2" + number + " y2" +
                                             number + " class=\"" + name + "\"")));
    const double right = std::stod(line[3]) - std::stod(line[1]),
                 down = std::stod(line[4]) - std::stod(line[2]);
    EXPECT_GT(name == "normal" ? right : down, 10) << name;
    EXPECT_NEAR(name == "normal" ? down : right, 0, 0.11) << name;
  }
  EXPECT_FALSE(std::regex_search(drawn, std::regex("https?://|url\\(")));
}

// A block of 20 x 20 x 10 mm whose top a cutter goes over once, 4 mm deep.
TEST(CheckHtml, CarriesTheMaterialAsItComesAndAsThePathLeavesIt) {
  const Mesh part = Wedge();
  const auto place = [](double x) { return CutterPlace{{x, 0, 1}, Eigen::Vector3d::UnitZ()}; };
  const CutsOfTool cuts{{5, 0, 20}, {{place(-30), place(30), 0}}};
  const std::vector<CutsOfTool> none;
  const Removal removal =
      PathRemoval(cuts, {test::BoxMesh({20, 20, 10}), part.triangles(), none, 0.5}, {.threads = 1});
  CheckHtmlInput input;
  input.part = &part;
  EXPECT_TRUE(CheckDataOf(CheckHtml(input))["removal"].is_null());
  input.removal = &removal;
  const Json told = CheckDataOf(CheckHtml(input))["removal"];
  EXPECT_NEAR(told["cm3"].get<double>(), 4, 0.05);
  EXPECT_EQ(told["along"], 2);
  EXPECT_LE(told["rows"].get<int>() * told["columns"].get<int>(), 10'000);
  ASSERT_EQ(removal.frames.size(), 1u);
  EXPECT_NEAR(removal.frames[0].volume / 1e3, 4 - 0.02 * 10 * 4, 0.05);
  // Nothing is cut: it is left as it comes.
  const Removal untouched = PathRemoval(
      {cuts.cutter, {}}, {test::BoxMesh({20, 20, 10}), part.triangles(), none, 0.5}, {.threads = 1});
  ASSERT_EQ(untouched.frames.size(), 1u);
  EXPECT_EQ(untouched.frames[0].volume, untouched.volume);
}

TEST(CheckHtml, APartOrACellAloneIsAPageToo) {
  const Mesh part = Wedge();
  CheckHtmlInput alone;
  alone.part = &part;
  EXPECT_TRUE(CheckDataOf(CheckHtml(alone))["cell"].is_null());
  const Cell cell = test::SampleCell();
  alone.part = nullptr;
  alone.cell = &cell;
  EXPECT_TRUE(CheckDataOf(CheckHtml(alone))["part"].is_null());
  EXPECT_TRUE(CheckDataOf(CheckHtml(alone))["path"].is_null());
}

}  // namespace
}  // namespace millpose
