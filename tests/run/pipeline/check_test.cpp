// SPDX-License-Identifier: GPL-3.0-or-later
// millpose check as a library: what it counts, and that its texts say it.
#include "run/pipeline/commands/check.hpp"

#include <nlohmann/json.hpp>

#include "base/trig.hpp"
#include "base/units.hpp"
#include "job/workpiece.hpp"
#include "tests/base/refusal.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

using Json = nlohmann::json;

/// A closed box as an OBJ file, `scale` times 120 × 80 × 20.
std::string BoxObj(double scale) {
  const Triangles box = BoxMesh(scale * Eigen::Vector3d(120, 80, 20));
  std::string text;
  for (const Eigen::Vector3d& v : box.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& f : box.faces) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  return text;
}

MeshCheck Checked(const std::string& name, const std::string& text, std::optional<double> unit = {}) {
  const TestFolder folder("check");
  folder.Write(name, text);
  return CheckMesh({folder.path() / name, unit});
}

TEST(CheckMesh, MeasuresABox) {
  const MeshCheck check = Checked("box.obj", BoxObj(1));
  EXPECT_EQ(check.report.triangles, 12u);
  EXPECT_EQ(check.report.vertices, 8u);
  EXPECT_EQ(check.report.pieces, 1u);
  EXPECT_EQ(check.report.closed_pieces, 1u);
  EXPECT_EQ(check.report.rims, 0u);
  EXPECT_EQ(check.creases, 12u);
  EXPECT_EQ(check.median_bend, 0);
  EXPECT_NEAR(check.report.area, 2 * (120 * 80 + 120 * 20 + 80 * 20), 1e-9);
  EXPECT_TRUE(check.unit_plausible && check.warnings.empty() && !HasFindings(check));
  const std::string text = ToText(check);
  EXPECT_NE(text.find("size                120 x 80 x 20 mm\n"), std::string::npos) << text;
  EXPECT_NE(text.find("pieces              1, 1 of them closed\n"), std::string::npos) << text;
  const Json json = Json::parse(ToJson(check));
  EXPECT_EQ(json["triangles"], 12);
  EXPECT_EQ(json["upper_mm"][0], 60);
  EXPECT_EQ(json["closed_area_share"], 1);
}

TEST(CheckMesh, ListsFacesByPlaceNormalAndArea) {
  const MeshCheck check = Checked("box.obj", BoxObj(1));
  ASSERT_EQ(check.faces.size(), 6u);
  double area = 0;
  for (const MeshCheck::Face& face : check.faces) {
    area += face.source.area;
    const Eigen::Vector3d half(60, 40, 10);
    EXPECT_NEAR(face.part.normal.dot(face.part.place), face.part.normal.cwiseAbs().dot(half), 1e-9)
        << "on the box";
    EXPECT_EQ(face.part.radius, 0);
  }
  EXPECT_NEAR(area, check.report.area, 1e-9);
  const Json json = Json::parse(ToJson(check));
  ASSERT_EQ(json["mesh_faces"].size(), 6u);
  EXPECT_TRUE(json["step_faces"].empty());
  EXPECT_TRUE(json["mesh_faces"][0]["radius_mm"].is_null());
  EXPECT_NE(ToText(check).find("looking (0.000, 0.000, 1.000)"), std::string::npos) << ToText(check);
}

TEST(CheckMesh, ACylindersFaceHasItsRadius) {
  constexpr int kSides = 64;
  constexpr double kRadius = 12.5;
  std::string text;
  for (const double z : {0.0, 30.0})
    for (int i = 0; i < kSides; ++i) {
      const SineCosine t = SinCos(2 * kPi * i / kSides);
      text += fmt::format("v {:.17g} {:.17g} {}\n", 100 + kRadius * t.cos, kRadius * t.sin - 7, z);
    }
  text += fmt::format("v 100 -7 0\nv 100 -7 30\n");
  for (int i = 0; i < kSides; ++i) {
    const int a = i + 1, b = (i + 1) % kSides + 1, below = 2 * kSides + 1, above = below + 1;
    text += fmt::format("f {0} {1} {3}\nf {0} {3} {2}\nf {1} {0} {4}\nf {2} {3} {5}\n", a, b, a + kSides,
                        b + kSides, below, above);
  }
  const MeshCheck check = Checked("cylinder.obj", text);
  ASSERT_EQ(check.faces.size(), 3u) << ToText(check);
  size_t round = 0;
  for (const MeshCheck::Face& face : check.faces) {
    if (face.part.radius == 0) continue;
    ++round;
    EXPECT_NEAR(face.part.radius, kRadius, 1e-9);
  }
  EXPECT_EQ(round, 1u);
  EXPECT_NE(ToText(check).find(", radius 12.500 mm"), std::string::npos) << ToText(check);
}

TEST(CheckMesh, AUnitThatCannotBeIsWarnedOfWithThoseThatCould) {
  const MeshCheck metres = Checked("box.obj", BoxObj(0.001)), told = Checked("box.obj", BoxObj(0.001), 1000);
  EXPECT_FALSE(metres.unit_plausible);
  EXPECT_TRUE(HasFindings(metres));
  EXPECT_NE(ToText(metres).find("not plausible for the arm, see below"), std::string::npos);
  EXPECT_TRUE(told.unit_plausible) << ToText(told);
  EXPECT_NEAR(told.report.upper.x(), 60, 1e-9);
}

TEST(CheckMesh, AnOpenBoxHasARim) {
  std::string text = BoxObj(1);
  text.erase(text.rfind("f "));  // one triangle less
  const MeshCheck check = Checked("box.obj", text);
  EXPECT_EQ(check.report.closed_pieces, 0u);
  EXPECT_EQ(check.report.rims, 1u);
  EXPECT_GT(check.report.rim_length, 100);
  EXPECT_TRUE(HasFindings(check)) << ToText(check);
  EXPECT_LT(Json::parse(ToJson(check))["closed_area_share"], 1);
}

TEST(CheckMesh, WhatIsNoMeshIsRefusedWithItsName) {
  EXPECT_NE(RefusalOf([] { Checked("cell.stl", "millpose_cell: 1\n"); }).find("cell.stl"), std::string::npos);
  const TestFolder folder("check");
  folder.Write("box.obj", BoxObj(1));
  std::filesystem::create_directories(folder.path() / "root");
  EXPECT_NE(
      RefusalOf([&] {
        CheckMesh({.mesh = folder.path() / "box.obj", .unit = {}, .root = FileRoot(folder.path() / "root")});
      }).find("lies outside of"),
      std::string::npos);
}

TEST(CheckCell, CountsAndReadsAsTheCellItIs) {
  const CellCheck check = CheckCell({SamplePath("cells/kr500_r2830.yaml")});
  EXPECT_EQ(check.cell, "kr500_r2830");
  EXPECT_EQ(check.controllers, (std::vector<std::string>{"krl", "linuxcnc", "sinumerik"}));
  EXPECT_FALSE(HasFindings(check)) << ToText(check);
  EXPECT_GT(check.reach, 2830);
  EXPECT_EQ(Json::parse(ToJson(check))["bodies"], check.bodies);
  EXPECT_NE(ToText(check).find(check.arm), std::string::npos);
  EXPECT_TRUE(IsCellFile(SamplePath("cells/kr500_r2830.yaml"), {}));
  EXPECT_FALSE(IsCellFile(SamplePath("toolpaths/support_pad/job.yaml"), {}));
}

TEST(CheckCell, AHomeThatInterferesIsAWarning) {
  const TestFolder folder("check");
  CopySmallJob(folder);
  folder.Change("cell.yaml", "home_deg: [0, -90, 90, 0, 0, 0]", "home_deg: [0, 20, 144, 0, 0, 0]");
  const CellCheck check = CheckCell({folder.path() / "cell.yaml"});
  ASSERT_TRUE(HasFindings(check));
  EXPECT_NE(ToText(check).find("home_deg: "), std::string::npos);
}

/// The small job's arm, calibrated: its base stands 5 mm elsewhere, its flange is turned by 2 mrad.
void Calibrate(const TestFolder& folder) {
  const std::string zeros = "[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]";
  folder.Change("cell.yaml", "  lengths_mm:",
                "  serial: A-17\n  deviations:\n    shifts_mm: [[3, 4, 0], [0, 0, 0], " + zeros +
                    "]\n    turns_mrad: [[0, 0, 0], " + zeros +
                    ", [0, 2, 0]]\n    uncertainty_mm: 0.08\n    source: laser tracker, 60 poses\n"
                    "    date: 2026-11-26\n  lengths_mm:");
}

TEST(CheckCell, TellsWhatWasMeasuredOfTheArm) {
  const TestFolder folder("check");
  CopySmallJob(folder);
  Calibrate(folder);
  const CellCheck check =
      CheckCell({.cell = folder.path() / "cell.yaml", .view = PageTarget{folder.path() / "cell.html"}});
  const std::string text = ToText(check);
  for (const char* line :
       {"calibration         arm A-17, measured on 2026-11-26: laser tracker, 60 poses\n",
        "deviations          frames shifted by up to 5.000 mm and turned by up to 2.000 mrad; at home the "
        "flange is 5.000 mm and 0.115° from where the controller has it\n",
        "how sure            0.08 mm at the flange, 95 %\n",
        "programs            for arm A-17 alone where a job has compensation.deviations: true; ",
        "lost motion         [0.3, 0.3, 0.3, 0.3, 0.3, 0.3] arcmin: assumed; published for cycloidal gears",
        "gear error          not known\n",
        "joint stiffness     [8.9e+06, 6.78e+06, 1.13e+07, 2.01e+06, 1.65e+06, 1.35e+06] N·m/rad: Chen et "
        "al.",
        "limits              -185 to 185, -130 to 20, -100 to 144, -350 to 350, -120 to 120, -350 to 350 "
        "deg\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
  const Json json = Json::parse(ToJson(check)), &arm = json["measured"];
  EXPECT_EQ(arm["calibration"]["serial"], "A-17");
  EXPECT_EQ(arm["calibration"]["date"], "2026-11-26");
  EXPECT_NEAR(arm["calibration"]["home_flange_shift_mm"], 5, 1e-9);
  EXPECT_NEAR(arm["calibration"]["home_flange_turn_deg"], RadToDeg(2e-3), 1e-9);
  EXPECT_EQ(arm["lost_motion"]["arcmin"][5], 0.3);
  EXPECT_TRUE(arm["gear_error"].is_null());
  EXPECT_EQ(json["arrival"]["limits_deg"][1], Json({-130, 20}));
  EXPECT_NE(folder.Read("cell.html").find("\"measured\":\"A-17, measured on 2026-11-26\""),
            std::string::npos);
}

TEST(CheckCell, AnArmThatNobodyMeasuredIsSaidToBeNone) {
  const CellCheck check = CheckCell({SamplePath("cells/kr500_r2830.yaml")});
  EXPECT_NE(ToText(check).find("calibration         none: the arm counts as its sheet has it\n"),
            std::string::npos)
      << ToText(check);
  EXPECT_TRUE(Json::parse(ToJson(check))["measured"]["calibration"].is_null());
}

TEST(CheckCell, TablesOfGearsAreNamed) {
  const TestFolder folder("check");
  CopySmallJob(folder);
  folder.Change("cell.yaml", "  lengths_mm:",
                "  serial: A-17\n  deviations:\n    gears: [{joint: 2, harmonic: 1, amplitude_arcsec: 22, "
                "phase_deg: 35}, {joint: 2, harmonic: 171, amplitude_arcsec: 9, phase_deg: 0}]\n    "
                "couplings: [{joint: 3, follows: 2, factor: 0.00045}]\n    source: encoders\n    date: "
                "2026-11-28\n  lengths_mm:");
  const CellCheck check = CheckCell({folder.path() / "cell.yaml"});
  EXPECT_NE(ToText(check).find("gear tables         waves of A2 (2), A3 with A2; up to 22 arcsec\n"),
            std::string::npos)
      << ToText(check);
  EXPECT_NE(ToText(check).find("how sure            not stated\n"), std::string::npos);
  const Json calibration = Json::parse(ToJson(check))["measured"]["calibration"];
  EXPECT_EQ(calibration["gears"][1]["amplitude_arcsec"], 9);
  EXPECT_EQ(calibration["couplings"][0]["follows"], 2);
}

TEST(CheckJob, SaysForWhichArmItsProgramsAre) {
  const TestFolder folder("check");
  CopySmallJob(folder);
  Calibrate(folder);
  const auto checked = [&](const std::string& taken_out) {
    return CheckJob(LoadJobInputs(folder.path() / "job.yaml", {{"compensation.deviations", taken_out}}),
                    {.threads = 1}, Silent(), {});
  };
  const JobCheck bound = checked("true"), free = checked("false");
  EXPECT_NE(ToText(bound).find("programs            for this arm alone: A-17, measured on 2026-11-26\n"),
            std::string::npos)
      << ToText(bound);
  EXPECT_EQ(Json::parse(ToJson(bound))["for_arm"], "A-17, measured on 2026-11-26");
  EXPECT_EQ(ToText(free).find("A-17"), std::string::npos);
  EXPECT_TRUE(Json::parse(ToJson(free))["for_arm"].is_null());
}

TEST(CheckJob, CountsThePointsThatTheArmReaches) {
  const JobCheck check = CheckJob(SmallInputs(), {.threads = 2}, Silent(), {});
  EXPECT_EQ(check.job, "support_pad");
  EXPECT_EQ(check.passes, 2u);
  EXPECT_EQ(check.points, 6u);
  EXPECT_EQ(check.reach, (std::array<size_t, 4>{6, 0, 0, 0}));
  EXPECT_TRUE(check.out_of_reach.empty());
  EXPECT_EQ(check.gouges, 0u);
  EXPECT_NE(ToText(check).find("within reach        6 (100.0 %)\n"), std::string::npos) << ToText(check);
  EXPECT_EQ(Json::parse(ToJson(check))["reach"]["admissible"], 6);
}

TEST(CheckJob, NamesThePointsOutOfReachAndTheAxesThatForbidThem) {
  JobCheck check =
      CheckJob(SmallInputs({{"workpiece.pose.xyz_mm", "[4000, 0, 1006]"}}), {.threads = 2}, Silent(), {});
  EXPECT_EQ(check.reach[1], 6u);
  EXPECT_EQ(check.out_of_reach, (std::vector<size_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_TRUE(HasFindings(check));
  EXPECT_NE(ToText(check).find("too far or too near"), std::string::npos);
  check =
      CheckJob(SmallInputs({{"limits.joints_deg",
                             "[[-45, 45], [-140, -30], [38, 120], [-350, 350], [-10, 10], [-350, 350]]"}}),
               {.threads = 2}, Silent(), {});
  EXPECT_EQ(check.reach[2], 6u);
  EXPECT_EQ(check.limited[4], 6u) << "axis 5";
  EXPECT_NE(ToText(check).find("  farthest: A5      6 (100.0 %)\n"), std::string::npos) << ToText(check);
}

TEST(CheckJob, APartTheWrongWayRoundIsAFinding) {
  const auto findings = [](const std::string& abc) {
    return ToText(CheckJob(SmallInputs({{"workpiece.pose.abc_deg", abc}}), {.threads = 2}, Silent(), {}));
  };
  // The wall's back, which the arm would have to reach round.
  const std::string back = findings("[0, 90, 0]");
  EXPECT_NE(
      back.find("6 of 6 points have a normal that looks away from the arm, such as (1.000, 0.000, 0.000)"),
      std::string::npos)
      << back;
  EXPECT_EQ(back.find("comes from below"), std::string::npos) << back;
  const std::string upside_down = findings("[0, 180, 0]");
  EXPECT_NE(upside_down.find(
                "at 6 of 6 points the tool comes from below the part, with the axis (0.000, 0.000, -1.000)"),
            std::string::npos)
      << upside_down;
  const std::string right = findings("[0, -90, 0]");
  EXPECT_EQ(right.find("looks away"), std::string::npos) << right;
  EXPECT_EQ(right.find("from below"), std::string::npos) << right;
}

TEST(CheckJob, RefusesWhatPlanWouldRefuseInTheSameWords) {
  for (const Override& wrong :
       {Override{"toolpath.region", "{facing: {direction: [1, 1, 0], within_deg: 1}}"},
        Override{"limits.margin_deg", "45"}}) {
    const std::string by_check =
                          RefusalOf([&] { CheckJob(SmallInputs({wrong}), {.threads = 1}, Silent(), {}); }),
                      by_plan =
                          RefusalOf([&] { PlanJob(SmallInputs({wrong}), NoCheckpoints(), {.threads = 1}); });
    EXPECT_NE(by_check, "accepted");
    EXPECT_EQ(by_check, by_plan);
  }
}

TEST(CheckJob, ThePageIsWrittenWhereItIsAskedFor) {
  const TestFolder folder("check");
  CheckJob(SmallInputs(), {.threads = 1, .view = PageTarget{folder.path() / "page.html"}}, Silent(), {});
  const std::string page = folder.Read("page.html");
  EXPECT_NE(page.find("support_pad"), std::string::npos);
  CheckCell({.cell = SamplePath("cells/kr500_r2830.yaml"), .view = PageTarget{folder.path() / "cell.html"}});
  EXPECT_GT(folder.Read("cell.html").size(), 10000u);
}

TEST(CheckCell, NamesEveryExternalAxisInTheUnitsOfTheCell) {
  const CellCheck rail = CheckCell({.cell = SamplePath("cells/irb6640_rail.yaml")});
  EXPECT_NE(
      ToText(rail).find("external axis       rail: linear, carries the robot, -2000 to 2000 mm, home 0 mm, "
                        "1000 mm/s, 500 mm/s², yields\n"),
      std::string::npos)
      << ToText(rail);
  const CellCheck table = CheckCell({.cell = SamplePath("cells/irb6640_turntable.yaml")});
  ASSERT_EQ(table.external_axes.size(), 1u);
  const ExternalAxis& axis = table.external_axes.front();
  EXPECT_NE(ToText(table).find(fmt::format("{}: rotary, carries the workpiece, {:.6g} to {:.6g} deg",
                                           axis.name, RadToDeg(axis.lower), RadToDeg(axis.upper))),
            std::string::npos)
      << ToText(table);
  EXPECT_NE(ToJson(table).find("\"carries\": \"workpiece\""), std::string::npos);
  EXPECT_EQ(ToText(CheckCell({.cell = SamplePath("cells/kr500_r2830.yaml")})).find("external axis"),
            std::string::npos);
}

TEST(SurfaceStage, OfAStepFileSaysWhatItMayTake) {
  EXPECT_EQ(SurfaceStage("solid x\n", 10, 100), "surface");
  EXPECT_EQ(SurfaceStage("ISO-10303-21;\nHEADER;\n", 10, 100), "surface (STEP: at most 10 s, 100 MB)");
}

}  // namespace
}  // namespace millpose::test
