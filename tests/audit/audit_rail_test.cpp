// SPDX-License-Identifier: GPL-3.0-or-later
// The judge on a folder whose robot stands on a rail.
#include <fmt/format.h>

#include <sstream>

#include "tests/audit/audit_fixture.hpp"

namespace millpose::audit {
namespace {

TEST_F(AuditTest, ARailMayStandOrMoveAlongCuts) {
  for (const double step : {0.0, 15.0, -40.0}) {
    const Verdict verdict = Judged(MakeFolder({.rail_step_mm = step, .forces = true}));
    EXPECT_TRUE(verdict.Holds()) << step << ToJson(verdict);
    for (const std::string controller : {"krl", "sinumerik", "linuxcnc"}) {
      EXPECT_LT(verdict["program_deviation_mm_" + controller].value, 1e-3);
      EXPECT_LT(verdict["program_deviation_external_" + controller].value, 1e-3);
    }
  }
}

TEST_F(AuditTest, AWrongPositionOfARailIsFoundInEveryProgram) {
  // Counted in, a wrong value moves the arm and not the tip.
  const std::array<std::tuple<const char*, const char*, const char*>, 3> programs{
      {{"krl", "src", "E1 "}, {"sinumerik", "mpf", "RAIL_AX="}, {"linuxcnc", "ngc", "U"}}};
  for (const auto& [controller, extension, word] : programs)
    for (const bool in_cut : {true, false})
      for (const double by : {-1.0, 0.05}) {
        const std::string name = fmt::format("out/programs/{}/by_hand.{}", controller, extension);
        Texts texts = MakeFolder({.rail_step_mm = 15});
        std::istringstream stream(texts[name]);
        std::vector<size_t> lines;  // with a word of the rail: home twice, approach, six points, …
        std::string text;
        for (size_t line = 0; std::getline(stream, text); ++line)
          if (text.find(word) != std::string::npos) lines.push_back(line);
        ASSERT_EQ(lines.size(), 22u) << controller;
        EditLine(texts[name], lines[in_cut ? 5 : 2],
                 [&](const std::string& line) { return AddAfter(line, word, by); });
        const Names broken = Broken(texts);
        EXPECT_TRUE(broken.contains(
            fmt::format("program_{}_{}", in_cut ? "deviation_external" : "external_violations", controller)))
            << controller << in_cut << by;
        EXPECT_EQ(broken.contains(std::string("program_deviation_mm_") + controller),
                  in_cut && std::string(controller) == "linuxcnc")
            << controller << by;
      }
}

TEST_F(AuditTest, ARailThatRunsTheOtherWayIsFound) {
  Texts texts = MakeFolder({.rail_step_mm = 15});
  std::string& cell = texts["cell.yaml"];
  cell.replace(cell.find("direction: y"), 12, "direction: -y");
  EXPECT_TRUE(Broken(texts).contains("program_deviation_mm_krl"));
  texts = MakeFolder({.rail_step_mm = 15});
  std::string& uncounted = texts["cell.yaml"];
  const std::string counted = "axis: rail, coupled: true}]}";  // SINUMERIK's
  uncounted.replace(uncounted.find(counted), counted.size(), "axis: rail, coupled: false}]}");
  const Names broken = Broken(texts);
  EXPECT_TRUE(broken.contains("program_deviation_mm_sinumerik"));
  EXPECT_TRUE(broken.contains("program_external_violations_sinumerik"));
}

TEST_F(AuditTest, ARailKeepsItsLimitsAndItsSpeed) {
  // 3 s from point to point, and 14 mm/s.
  EXPECT_EQ(Broken(MakeFolder({.rail_step_mm = 45})).contains("step_violations"), true);
  EXPECT_EQ(Broken(MakeFolder({.rail_step_mm = -60})).contains("limit_violations"), true);
}

}  // namespace
}  // namespace millpose::audit
