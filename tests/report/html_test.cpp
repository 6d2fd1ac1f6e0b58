// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html.hpp"

#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "base/units.hpp"
#include "planning/result/point_clearance.hpp"
#include "report/html_columns.hpp"
#include "report/packed.hpp"
#include "report/samples/sample_curves.hpp"
#include "tests/report/page_data.hpp"

namespace millpose {
namespace {

size_t Count(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

std::vector<float> ColumnValues(const Json& data, const std::string& key) {
  for (const Json& column : data["columns"])
    if (column["key"] == key) return Floats(column["values"]);
  ADD_FAILURE() << "no column " << key;
  return {};
}

TEST(Packed, Base64IsThatOfRfc4648) {
  const std::string text = "foobar";
  const char* expected[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (size_t n = 0; n <= text.size(); ++n)
    EXPECT_EQ(Base64({reinterpret_cast<const uint8_t*>(text.data()), n}), expected[n]);
}

TEST(Packed, FloatsAreLittleEndian) {
  EXPECT_EQ(PackFloats(std::vector<float>{1.0f}), "AACAPw==");
  EXPECT_EQ(PackUint16(std::vector<uint16_t>{0x0102}), "AgE=");
}

TEST(ReportHtml, CountsAreThoseOfThePlan) {
  const Json data = DataOf(SmallPage());
  EXPECT_EQ(data["counts"]["total"], 80);
  EXPECT_EQ(data["counts"]["shown"], 80);
  size_t skipped = 0;
  for (const PassResult& pass : SmallPanel().plan.passes)
    for (const PlannedPoint& p : pass.points) skipped += p.skip != Infeasibility::kNone;
  ASSERT_GE(skipped, 2u);
  EXPECT_EQ(data["counts"]["skipped"], skipped);
  EXPECT_EQ(data["skipped"]["rows"].size(), skipped);
  EXPECT_EQ(data["passes"].size(), 4u);
  EXPECT_EQ(data["gaps"]["total"], 5);
  EXPECT_EQ(data["gaps"]["planned"], 4);
  ASSERT_EQ(data["gaps"]["told"].size(), 2u);
  EXPECT_EQ(data["gaps"]["told"][0]["detail"], "link3 against platform");
  EXPECT_EQ(data["gaps"]["told"][1]["planned"], true);
  EXPECT_EQ(Uint32s(data["rows"]["number"]).size(), 80u);
  for (const Json& column : data["columns"]) EXPECT_EQ(Floats(column["values"]).size(), 80u) << column["key"];
}

TEST(ReportHtml, PlaysTheTimelineOfThePlan) {
  const Panel& panel = SmallPanel();
  const Json timeline = DataOf(SmallPage())["timeline"];
  const auto time = Floats(timeline["time_s"]), joints = Floats(timeline["joints_deg"]),
             tip = Floats(timeline["tip_mm"]);
  const auto row = Uint32s(timeline["row"]), stretch = Uint32s(timeline["stretch"]),
             pass = Uint32s(timeline["pass"]);
  ASSERT_EQ(time.size(), panel.timeline.size());
  EXPECT_GT(time.back(), 10);
  EXPECT_EQ(timeline["seconds"], panel.timeline.back().time);
  size_t own = 0, points = 0;
  for (size_t i = 0; i < time.size(); ++i) {
    const RunInstant& instant = panel.timeline[i];
    EXPECT_FLOAT_EQ(time[i], static_cast<float>(instant.time));
    EXPECT_EQ(stretch[i], static_cast<uint32_t>(instant.stretch));
    EXPECT_EQ(pass[i], static_cast<uint32_t>(instant.pass));
    if (instant.point >= 0) {
      EXPECT_EQ(row[i], 20u * static_cast<uint32_t>(instant.pass) + static_cast<uint32_t>(instant.point));
      ++points;
      continue;
    }
    EXPECT_EQ(row[i], 0xffffffffu);
    for (int j = 0; j < 6; ++j)
      EXPECT_FLOAT_EQ(joints.at(6 * own + j), static_cast<float>(RadToDeg(instant.q[j])));
    for (int k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(tip.at(3 * own + k), static_cast<float>(instant.tip[k]));
    ++own;
  }
  EXPECT_EQ(points, DataOf(SmallPage())["counts"]["planned"]);
  EXPECT_EQ(joints.size(), 6 * own);
}

TEST(ReportHtml, ATimelineOfAThinnedPlanKeepsToTheRowsShown) {
  const Panel panel = MakePanel({.passes = 6, .points = 60});
  HtmlLimits limits;
  limits.points = 90;
  const Json data = DataOf(ReportHtml(panel.Input(), limits));
  const auto row = Uint32s(data["timeline"]["row"]);
  const size_t shown = data["counts"]["shown"];
  size_t points = 0;
  for (const uint32_t r : row) {
    if (r == 0xffffffffu) continue;
    EXPECT_LT(r, shown);
    ++points;
  }
  EXPECT_GT(points, 90u);
  EXPECT_LT(points, 300u);
  EXPECT_FLOAT_EQ(Floats(data["timeline"]["time_s"]).back(), static_cast<float>(panel.timeline.back().time));
}

TEST(ReportHtml, NamesTheNearestPairOfEveryPoint) {
  const Panel& panel = SmallPanel();
  const Json nearest = DataOf(SmallPage())["nearest"];
  const auto pair = Uint32s(nearest["pair"]);
  const auto ends = Floats(nearest["ends_mm"]);
  ASSERT_EQ(pair.size(), 80u);
  const World world(panel.cell);
  Checker checker(world);
  size_t named = 0;
  for (size_t i = 0; i < pair.size(); ++i) {
    const PlannedPoint& point = panel.plan.passes[i / 20].points[i % 20];
    if (point.skip != Infeasibility::kNone) {
      EXPECT_EQ(pair[i], 0u);
      continue;
    }
    const auto found = checker.Nearest(point.q, Phase::kCutting, kPointClearanceBound);
    if (!found || point.clearance >= kPointClearanceBound) {
      EXPECT_EQ(pair[i], 1u);
      continue;
    }
    EXPECT_EQ(nearest["pairs"][pair[i] - 2], Json({found->first, found->second}));
    ASSERT_GE(ends.size(), 6 * (named + 1));
    for (size_t k = 0; k < 6; ++k)
      EXPECT_FLOAT_EQ(ends[6 * named + k],
                      static_cast<float>(found->ends[k / 3][static_cast<Eigen::Index>(k % 3)]));
    ++named;
  }
  EXPECT_GT(named, 5u);
  EXPECT_EQ(ends.size(), 6 * named);
}

TEST(ReportHtml, TellsWhichClearancesAreOnlyBounds) {
  const Json data = DataOf(SmallPage());
  for (const Json& column : data["columns"]) {
    if (column["key"] == "clearance")
      EXPECT_EQ(column["bound"], kPointClearanceBound);
    else
      EXPECT_TRUE(column["bound"].is_null()) << column["key"];
  }
}

TEST(ReportHtml, CarriesFindingsAndWarnings) {
  HtmlInput input = SmallPanel().Input();
  input.findings = {"no program was written: a gap"};
  input.warnings = {"panel.stl: 3 flat triangles removed"};
  const Json data = DataOf(ReportHtml(input));
  EXPECT_EQ(data["findings"], Json({"no program was written: a gap"}));
  EXPECT_EQ(data["warnings"].size(), 1u);
}

TEST(ReportHtml, ShowsPredictedDeflectionsWhereThereAreSome) {
  EXPECT_TRUE(DataOf(SmallPage())["deflection"].is_null());
  DeflectionReport report;
  report.force.mean = {1, 2, 3};
  report.points.push_back(
      {2, 0, {}, {1, 2, 3}, {.normal = 0.001, .feed = -0.002, .across = 0.003, .length = 0.004}, {0, 0, 0}});
  report.face = FaceDeflection{.level = 0.01, .variation = 0.0002, .largest_step = 0.0001};
  HtmlInput input = SmallPanel().Input();
  input.deflection = &report;
  const std::string page = ReportHtml(input);
  const Json data = DataOf(page);
  EXPECT_NEAR(data["deflection"]["face"]["level_um"], 10, 1e-12);
  EXPECT_NEAR(data["deflection"]["face"]["variation_um"], 0.2, 1e-12);
  EXPECT_EQ(data["deflection"]["mean_force_N"], Json({1.0, 2.0, 3.0}));
  EXPECT_NE(data["deflection"]["model"].get<std::string>().find("no chatter"), std::string::npos);
  const auto length = ColumnValues(data, "deflection");
  EXPECT_FLOAT_EQ(length[2], 4);
  EXPECT_FLOAT_EQ(ColumnValues(data, "deflection_normal")[2], 1);
  EXPECT_TRUE(std::isnan(length[1]));
}

// The page names what the plan has as a number.
TEST(ReportHtml, KnowsEveryReasonForSkipping) {
  std::string reasons = "[\"\"";
  for (int i = 1; i <= static_cast<int>(Infeasibility::kStock); ++i)
    reasons += fmt::format(", \"{}\"", ToString(static_cast<Infeasibility>(i)));
  EXPECT_NE(SmallPage().find("m.SKIP_REASONS = " + reasons + "];"), std::string::npos) << reasons;
}

// A key that the page looks up and no column has would leave its chart out without a word.
TEST(ReportHtml, EveryChartFindsItsColumns) {
  DeflectionReport report;
  HtmlInput input = SmallPanel().Input();
  input.deflection = &report;
  PlanResult compensated = input.plan;
  Compensation& compensation = compensated.passes.front().points.front().compensation.emplace();
  compensation.force = compensation.arm_shift = Eigen::Vector3d::UnitX();
  compensation.gear_shift = Eigen::Vector3d::UnitX();
  LostMotionReport lost = ReportLostMotion(compensated, {}, "", 0);
  lost.model.known.fill(true);
  HtmlInput shown{compensated, input.cell, input.grid, input.curves, input.settings, input.deflection};
  shown.lost_motion = &lost;
  const std::string page = ReportHtml(shown);
  std::set<std::string> known;
  const Json data = DataOf(page);
  for (const Json& column : data["columns"]) known.insert(column["key"]);
  static const std::regex kChart("chart\\(\"[^\"]*\", \\[([^\\]]*)\\]"), kKey("\"([a-z0-9_]+)\"");
  size_t charts = 0, keys = 0;
  for (std::sregex_iterator chart(page.begin(), page.end(), kChart), none; chart != none; ++chart, ++charts) {
    const std::string list = (*chart)[1];
    for (std::sregex_iterator key(list.begin(), list.end(), kKey); key != none; ++key, ++keys)
      EXPECT_TRUE(known.contains((*key)[1])) << (*key)[1];
  }
  EXPECT_EQ(charts, 13u);
  EXPECT_EQ(keys, 25u);
}

TEST(ReportHtml, ColumnsHoldThePlanInTheirUnits) {
  const Json data = DataOf(SmallPage());
  const auto lambda = ColumnValues(data, "lambda_t1"), angle = ColumnValues(data, "a5");
  size_t i = 0;
  for (const PassResult& pass : SmallPanel().plan.passes) {
    for (const PlannedPoint& p : pass.points) {
      if (p.skip == Infeasibility::kNone) {
        EXPECT_FLOAT_EQ(lambda[i], static_cast<float>(1e3 * p.indices.lambda_t1));
        EXPECT_FLOAT_EQ(angle[i], static_cast<float>(RadToDeg(p.q[4])));
      } else {
        EXPECT_TRUE(std::isnan(lambda[i]));
        EXPECT_TRUE(std::isnan(angle[i]));
      }
      ++i;
    }
  }
}

TEST(ReportHtml, SpeedsAreStepsOverTime) {
  Panel panel = MakePanel({.passes = 1, .points = 5});
  std::vector<PlannedPoint>& points = panel.plan.passes[0].points;
  for (size_t i = 0; i < points.size(); ++i) {
    points[i].skip = Infeasibility::kNone;
    points[i].q = Joints::Constant(DegToRad(2.0 * static_cast<double>(i)));
    points[i].point.arc_length = 5.0 * static_cast<double>(i);
    points[i].point.feed_rate = 10;  // half a second a step
  }
  const auto columns = ReportColumns(panel.plan);
  const auto v3 = std::find_if(columns.begin(), columns.end(), [](const auto& c) { return c.key == "v3"; });
  for (float v : v3->values) EXPECT_NEAR(v, 4, 1e-5);
}

TEST(ReportHtml, CurvesFollowTheScorer) {
  const Panel& panel = SmallPanel();
  const Json curves = DataOf(SmallPage())["curves"];
  EXPECT_EQ(curves["count"], 120);
  const auto least = Floats(curves["least"]), span = Floats(curves["span"]);
  const std::vector<uint8_t> values = Decoded(curves["values"]), states = Decoded(curves["states"]);
  ASSERT_EQ(values.size(), 80u * 4 * 120 * 2);
  ASSERT_EQ(states.size(), 80u * 120 * 2);
  const auto at = [](const std::vector<uint8_t>& bytes, size_t i) {
    return bytes[2 * i] | bytes[2 * i + 1] << 8;
  };
  size_t seen = 0;
  for (size_t k = 0; k < 80; ++k) {
    for (size_t i = 0; i < 120; ++i) {
      for (size_t branch = 0; branch < 8; ++branch) {
        const Infeasibility state = panel.curves[k].state[i][branch];
        EXPECT_EQ(at(states, 120 * k + i) >> (2 * branch) & 3, TestsPassed(state));
        if (state == Infeasibility::kUnreachable) continue;
        const int code = at(values, 480 * k + 120 * (branch & 3) + i);
        const double truth = 1e3 * panel.curves[k].objective[i][branch];
        if (!std::isfinite(truth)) continue;
        if (code < 65534) {
          EXPECT_NEAR(least[k] + span[k] * code / 65534.0, truth, 2e-5 * (least[k] + span[k]));
        }
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 10000u);
}

TEST(SampleCurves, AgreesWithTheSlowWayWithinBoundsAndBeyond) {
  const Panel& panel = SmallPanel();
  const PoseProblem& problem = panel.problem;
  const RotationGrid grid = CurveGrid();
  std::array<int, 4> seen{};
  for (size_t k = 0; k < panel.curves.size(); k += 7) {
    const PointCurves& curves = panel.curves[k];
    const PassResult& pass = panel.plan.passes[curves.pass];
    const MillingPoint& point = pass.points[curves.point].point;
    const PointScorer scorer(problem, point, pass.rotation_reference);
    for (int i = 0; i < grid.count; i += 5) {
      const Pose X_WF = scorer.ToolPose({grid.first + i * grid.step}) * problem.X_FT.inverse();
      const InverseResult inverse = Inverse(problem.arm, problem.X_WB.inverse() * X_WF);
      for (int s = 0; s < inverse.count; ++s) {
        const ArmSolution& solution = inverse.solutions[s];
        const Infeasibility state = curves.state[i][solution.branch];
        ++seen[static_cast<size_t>(state)];
        const Matrix6 J = Jacobian(problem.arm, solution.q, problem.X_FT.translation());
        const auto indices =
            IndicesInPlane(Compliance(J, problem.arm.stiffness).topLeftCorner<3, 3>(), point.normal);
        ASSERT_TRUE(indices);
        const double f = 0.5 * indices->lambda_t2 + 0.5 * indices->lambda_n;
        EXPECT_NEAR(curves.objective[i][solution.branch], f, 1e-9 * f);
      }
    }
  }
  EXPECT_EQ(seen[static_cast<size_t>(Infeasibility::kUnreachable)], 0);
  EXPECT_GT(seen[static_cast<size_t>(Infeasibility::kLimit)], 100);
  EXPECT_GT(seen[static_cast<size_t>(Infeasibility::kNone)], 100);
}

TEST(SampleCurves, TakesTheWorstWhenNotAllAreSampled) {
  const Panel& panel = SmallPanel();
  const auto some =
      SampleCurves(panel.plan, Stations(World(panel.cell), panel.problem), {}, 20, {.threads = 2});
  EXPECT_LE(some.size(), 20u);
  EXPECT_GT(some.size(), 10u);
  double worst = 0;
  for (const PassResult& pass : panel.plan.passes)
    for (const PlannedPoint& p : pass.points) worst = std::max(worst, p.objective);
  EXPECT_TRUE(std::ranges::any_of(some, [&](const PointCurves& c) {
    return panel.plan.passes[c.pass].points[c.point].objective == worst;
  }));
}

TEST(ReportHtml, HostileNamesStayText) {
  const std::string& page = SmallPage();
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(Count(page, "<script"), 4u);
  EXPECT_EQ(Count(page, "</script>"), 4u);
  EXPECT_NE(page.find("<title>&lt;/script&gt;"), std::string::npos);
  const std::string job = DataOf(page)["job"];
  EXPECT_TRUE(job.starts_with("</script><script>alert(1)</script> & \"ü\""));
}

TEST(ReportHtml, LoadsNothingFromOutside) {
  const std::string& page = SmallPage();
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  // What follows is ours alone: three.js names addresses in comments and namespaces but loads none.
  std::string own = page;
  const size_t three = own.find("(function(global,factory)");
  ASSERT_NE(three, std::string::npos);
  own.erase(three, own.find("</script>", three) - three);
  EXPECT_FALSE(std::regex_search(own, std::regex("https?://|@import|url\\(|fetch\\(|XMLHttpRequest|src=")));
}

TEST(ReportHtml, HasAllSectionsAndNotices) {
  const std::string& page = SmallPage();
  for (const char* id :
       {"scene",          "view",          "index",       "scale",     "player",       "time",    "speed",
        "theme",          "keys",          "with-leads",  "show-gaps", "show-nearest", "point",   "worst",
        "rotation-chart", "genetic-chart", "path-charts", "skipped",   "gaps",         "settings"})
    EXPECT_EQ(Count(page, fmt::format("id=\"{}\"", id)), 1u) << id;
  EXPECT_NE(page.find("three.js authors"), std::string::npos);
  EXPECT_EQ(page.find("{{"), std::string::npos);
}

TEST(ReportHtml, SameInputGivesTheSameBytes) { EXPECT_EQ(ReportHtml(SmallPanel().Input()), SmallPage()); }

TEST(ReportHtml, ThinsLargePlansButKeepsTheWorst) {
  const Panel panel = MakePanel({.passes = 6, .points = 60});
  HtmlLimits limits;
  limits.points = 90;
  const Json data = DataOf(ReportHtml(panel.Input(), limits));
  const auto number = Uint32s(data["rows"]["number"]);
  EXPECT_EQ(data["counts"]["total"], 360);
  EXPECT_EQ(data["counts"]["shown"], number.size());
  EXPECT_LT(number.size(), 360u);
  EXPECT_TRUE(std::is_sorted(number.begin(), number.end()));
  for (uint32_t pass = 0; pass < 6; ++pass)
    for (uint32_t end : {60 * pass, 60 * pass + 59})
      EXPECT_TRUE(std::binary_search(number.begin(), number.end(), end)) << end;
  for (const ReportColumn& column : ReportColumns(panel.plan)) {
    if (column.worse == Worse::kNeither) continue;
    uint32_t worst = 0;
    float value = -std::numeric_limits<float>::infinity();
    for (uint32_t i = 0; i < column.values.size(); ++i) {
      const float v = static_cast<float>(column.worse) * column.values[i];
      if (v > value) value = v, worst = i;
    }
    EXPECT_TRUE(std::binary_search(number.begin(), number.end(), worst)) << column.key;
  }
}

TEST(ReportHtml, MeshesAreThinnedForTheViewAlone) {
  HtmlLimits limits;
  limits.workpiece_triangles = 300;
  const Json data = DataOf(ReportHtml(SmallPanel().Input(), limits));
  for (const Json& body : data["bodies"]) {
    if (body["class"] != "workpiece") continue;
    EXPECT_EQ(body["triangles"], 1600);
    EXPECT_LE(body["triangles_shown"], 300);
    EXPECT_EQ(Uint32s(body["faces"]).size(), 3 * body["triangles_shown"].get<size_t>());
  }
}

TEST(ReportHtml, APlanWithoutAnyPoseIsAPageToo) {
  Panel panel = MakePanel({.passes = 1, .points = 3});
  for (PlannedPoint& p : panel.plan.passes[0].points) {
    p.skip = Infeasibility::kUnreachable;
    p.detail = "too far";
    p.freedoms.clear();
  }
  EXPECT_EQ(DataOf(ReportHtml(panel.Input()))["counts"]["planned"], 0);
}

TEST(Html, TheAxisMapIsThatOfThePlanAndSmall) {
  const Panel& panel = SmallPanel();
  const Json map = DataOf(SmallPage())["map"];
  EXPECT_EQ(map["pairs"], Json({"link4 and panel", "spindle and platform"}));
  EXPECT_FALSE(map["full"]);
  const std::vector<uint8_t> runs = Decoded(map["runs"].get<std::string>());
  const std::vector<uint32_t> start = Uint32s(map["start"]);
  ASSERT_EQ(start.size(), panel.curves.size() + 1);
  ASSERT_EQ(start.back(), runs.size());
  int met = 0;
  for (size_t k = 0; k + 1 < start.size(); ++k) {
    std::vector<uint8_t> zones;
    for (size_t at = start[k]; at < start[k + 1]; at += 2) zones.insert(zones.end(), runs[at + 1], runs[at]);
    EXPECT_EQ(zones, panel.map.zones[k]);
    met += static_cast<int>(std::ranges::count(zones, kPairZone + 1));
    for (size_t i = 0; i < zones.size(); i += 31) {
      const Infeasibility state = panel.curves[k].state[i % 120][i / 120];
      EXPECT_EQ(zones[i] >= kUncheckedZone, state == Infeasibility::kNone);
      EXPECT_EQ(zones[i] >= kLimitZone && zones[i] < kUncheckedZone, state == Infeasibility::kLimit);
    }
  }
  EXPECT_GT(met, 0);
  EXPECT_EQ(Uint32s(map["barred"])[0], 1u);
  EXPECT_EQ(Uint32s(map["barred"])[1], 0u);
  EXPECT_LT(map.dump().size() / panel.curves.size(), 600u) << "bytes a point; the curves take 1,600";
}

}  // namespace
}  // namespace millpose
