// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/inspect.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/units.hpp"
#include "small_plan.hpp"

namespace millpose {
namespace {

PointsTable SmallTable() { return PointsTable(PointsCsv(SmallPlan()), "points.csv"); }

InspectOptions AtPoint(size_t point, size_t worst = 10) {
  InspectOptions options;
  options.point = point;
  options.worst = worst;
  return options;
}

}  // namespace

TEST(PointsTable, ReadsWhatIsWritten) {
  const PointsTable points = SmallTable();
  ASSERT_EQ(points.size(), 4u);
  EXPECT_EQ(points.Number(2, "x_mm"), 2);
  EXPECT_EQ(points.Number(2, "objective"), 3);
  EXPECT_TRUE(points.IsPlanned(2));
  EXPECT_FALSE(points.IsPlanned(3));
  EXPECT_FALSE(points.Number(3, "objective").has_value());
}

TEST(PointsTable, NamesTheLineOfDamage) {
  const std::string good = PointsCsv(SmallPlan());
  const auto problem_of = [](const std::string& csv) {
    try {
      PointsTable(csv, "p.csv");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(problem_of(good), "accepted");
  EXPECT_TRUE(problem_of("").starts_with("p.csv: is empty"));
  EXPECT_TRUE(problem_of("point,pass\n").starts_with("p.csv:1: the column piece is missing"));
  EXPECT_TRUE(problem_of(good.substr(0, good.size() - 20)).starts_with("p.csv:5: given ")) << "cut off";
  std::string bad = good;
  bad.replace(bad.find("\n1,0") + 1, 1, "x");
  EXPECT_TRUE(problem_of(bad).starts_with("p.csv:3: point: given x; allowed: a number"));
}

TEST(Inspect, WorstPointsComeInOrder) {
  const PointsTable points = SmallTable();
  EXPECT_EQ(WorstRows(points, PlannedRows(points, std::nullopt), 2), (std::vector<size_t>{2, 1}));
  EXPECT_EQ(WorstRows(points, PlannedRows(points, std::nullopt), 99).size(), 3u);
  EXPECT_TRUE(PlannedRows(points, 7).empty());
}

TEST(Inspect, HistogramCountsEveryPlannedPointOnce) {
  const PointsTable points = SmallTable();
  for (const size_t bins : {1, 2, 3, 20}) {
    const Histogram histogram = ObjectiveHistogram(points, PlannedRows(points, std::nullopt), bins);
    size_t sum = 0;
    for (const size_t count : histogram.counts) sum += count;
    EXPECT_EQ(sum, 3u) << bins;
  }
  EXPECT_EQ(ObjectiveHistogram(points, {0}, 20).counts, std::vector<size_t>{1});
}

TEST(Inspect, TextShowsHistogramWorstAndOnePoint) {
  const std::string summary = SummaryJson(SmallPlan(), {});
  const std::string all = InspectText(SmallTable(), summary, "summary.json", {}, {});
  for (const char* part : {"points 3 planned of 4, 1 skipped", "worst 3 by objective", "3.0000e+00"})
    EXPECT_NE(all.find(part), std::string::npos) << all;
  const PointStory story{{{-3, 2, 1.5}, {0, 2, 4}, {3, 6, 9}}, {"that is the point's own optimum"}};
  const std::string one = InspectText(SmallTable(), summary, "summary.json", AtPoint(1), story);
  for (const char* part : {"a5_deg", "clearance_mm             39", "9.0000e+00 |", "*",
                           "why this pose\n  that is the point's own optimum\n"})
    EXPECT_NE(one.find(part), std::string::npos) << one;
}

TEST(Inspect, StepsAtThePointAreToldWhereTheToolIsKnown) {
  const std::string summary = SummaryJson(SmallPlan(), {});
  const auto shown = [&](const PointStory& story) {
    return InspectText(SmallTable(), summary, "s", AtPoint(1), story);
  };
  const auto json = [&](const PointStory& story) {
    return nlohmann::json::parse(InspectJson(SmallTable(), summary, "s", AtPoint(1), story)).at("pose_steps");
  };
  const std::string heading = "what the tool's own error can leave in the surface here\n";
  PointStory story;
  EXPECT_EQ(shown(story).find(heading), std::string::npos);
  EXPECT_TRUE(json(story).is_null());
  story.steps.emplace();
  EXPECT_NE(shown(story).find(heading + "  nothing: "), std::string::npos) << shown(story);
  EXPECT_EQ(json(story), nlohmann::json::array());
  story.steps->push_back({PoseStep::Why::kNeighbours, 1, 7, 0, 2, kPi / 3, true, 0.25});
  EXPECT_NE(
      shown(story).find(heading + "  step up to 0.25 mm (neighbours): points 1 and 7, rotation 60.0 deg "
                                  "apart, in another branch\n"),
      std::string::npos)
      << shown(story);
  EXPECT_EQ(json(story)[0].at("other_point"), 7);
  EXPECT_EQ(json(story)[0].at("height_mm"), 0.25);
}

TEST(Inspect, PointsAndPassesThatAreNotThereAreNamed) {
  const std::string summary = SummaryJson(SmallPlan(), {});
  EXPECT_THROW(InspectText(SmallTable(), summary, "s", AtPoint(4), {}), InputError);
  InspectOptions strange_pass;
  strange_pass.pass = 1;
  EXPECT_THROW(InspectText(SmallTable(), summary, "s", strange_pass, {}), InputError);
  EXPECT_THROW(InspectText(SmallTable(), "no json", "s", {}, {}), InputError);
  EXPECT_THROW(InspectText(SmallTable(), "{}", "s", {}, {}), InputError);
  EXPECT_THROW(InspectJson(SmallTable(), summary, "s", AtPoint(4), {}), InputError);
}

TEST(Inspect, FoldersOfAnotherVersionAreRefusedInWords) {
  std::string older = SummaryJson(SmallPlan(), {});
  older.replace(older.find("\"schema_version\": 2"), 19, "\"schema_version\": 1");
  const auto refusal = [&](const auto& show) -> std::string {
    try {
      show(SmallTable(), older, "out/summary.json", InspectOptions{}, PointStory{});
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  };
  EXPECT_TRUE(refusal(InspectText).starts_with("out/summary.json: schema_version: given 1; allowed: 2"));
  EXPECT_EQ(refusal(InspectJson), refusal(InspectText));
}

TEST(Inspect, JsonHasWhatTheTextHas) {
  const auto json =
      nlohmann::json::parse(InspectJson(SmallTable(), SummaryJson(SmallPlan(), {}), "s", AtPoint(3, 2), {}));
  EXPECT_EQ(json["worst"].size(), 2u);
  EXPECT_EQ(json["worst"][0]["objective"], 3);
  EXPECT_TRUE(json["point"]["objective"].is_null());
  EXPECT_EQ(json["point"]["reason"], "limit");
  EXPECT_EQ(json["summary"]["points"]["skipped"], 1);
}

}  // namespace millpose
