// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of a setup sheet where the part or the robot stands at many stations.
#include "run/pipeline/commands/setup_views.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/report/small_plan.hpp"

namespace millpose {
namespace {

/// A rail under the robot, and a plan with one pass at each of `stations` places of it.
std::vector<OperationWithTree> OnARail(int stations) {
  FolderOperation one;
  one.name = "pad";
  one.summary = "{}";
  one.plan = SmallPlan();
  ExternalAxis rail;
  rail.name = "rail";
  rail.upper = 5000;
  one.plan.external_axes = {rail};
  const PassResult pass = one.plan.passes.front();
  one.plan.passes.clear();
  for (int i = 0; i < stations; ++i) {
    one.plan.passes.push_back(pass);
    one.plan.passes.back().external = {100.0 * i};
  }
  return {OperationWithTree(one)};
}

size_t CountOf(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The lines of the path of a class: what begins with M in its `d`.
size_t LinesOfClass(const std::string& svg, const std::string& name) {
  const size_t at = svg.find("class=\"" + name + "\"");
  if (at == std::string::npos) return 0;
  const std::string rest = svg.substr(svg.find(" d=\"", at) + 4);
  return CountOf(rest.substr(0, rest.find('"')), "M");
}

TEST(SetupViews, EachStationHasAPictureOfWhatIsMilledThere) {
  const std::vector<OperationWithTree> operations = OnARail(3);
  const std::vector<SheetSection> views = SetupViews(operations, {}, Mesh(Triangles()), Language::kEnglish);
  ASSERT_EQ(views.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(views[i].title, fmt::format("Setup at rail {} mm", 100 * i));
    EXPECT_NE(views[i].note.find(fmt::format("Station {} of 3: passes {} are milled here;", i + 1, i)),
              std::string::npos)
        << views[i].note;
    EXPECT_EQ(LinesOfClass(views[i].picture, "cut"), 1u);
    EXPECT_EQ(LinesOfClass(views[i].picture, "elsewhere"), 2u);
    EXPECT_EQ(CountOf(views[i].picture, "class=\"skipped\""), 1u);
    EXPECT_TRUE(CanSay(views[i].note)) << views[i].note;
    EXPECT_TRUE(CanSay(views[i].title)) << views[i].title;
  }
}

TEST(SetupViews, OneStationNamesNoOther) {
  const std::vector<SheetSection> views = SetupViews(OnARail(1), {}, Mesh(Triangles()), Language::kEnglish);
  ASSERT_EQ(views.size(), 1u);
  EXPECT_EQ(views[0].title, "Setup at rail 0 mm");
  EXPECT_EQ(views[0].note.find("Station"), std::string::npos);
  EXPECT_EQ(LinesOfClass(views[0].picture, "elsewhere"), 0u);
}

TEST(SetupViews, ThePicturesAreLimitedAndTheSheetSaysSo) {
  const int stations = static_cast<int>(kMostStationPictures) + 3;
  const std::vector<SheetSection> views =
      SetupViews(OnARail(stations), {}, Mesh(Triangles()), Language::kEnglish);
  ASSERT_EQ(views.size(), kMostStationPictures);
  const std::string words =
      fmt::format("The first {} of {} stations have a picture;", kMostStationPictures, stations);
  EXPECT_NE(views.back().note.find(words), std::string::npos) << views.back().note;
  EXPECT_EQ(views.front().note.find(words), std::string::npos);
  EXPECT_TRUE(CanSay(views.back().note)) << views.back().note;
}

// The arm's arrow goes with the rail: the pictures of two stations are not the same.
TEST(SetupViews, TheArmStandsWhereTheRailHasIt) {
  std::vector<OperationWithTree> operations = OnARail(2);
  operations[0].plan.X_WB.translation() = Eigen::Vector3d(-50, 0, 0);
  const std::vector<SheetSection> views = SetupViews(operations, {}, Mesh(Triangles()), Language::kEnglish);
  const auto arrow = [](const std::string& svg) { return svg.substr(svg.rfind("<path")); };
  EXPECT_NE(arrow(views[0].picture), arrow(views[1].picture));
}

}  // namespace
}  // namespace millpose
