// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements of an arm's stiffness: both forms of the file, and what identify writes into a cell.
#include "job/config/measurements.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/random.hpp"
#include "base/yaml/edit.hpp"
#include "job/config/config.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

const std::string kYaml = R"(millpose_measurements: 1
cell: ../cell.yaml
load_point_mm: [0, 0, 100]
measured_point_mm: [1, 2, 3]
displacement_deviation_mm: 0.02
measurements:
  - {joints_deg: [0, -90, 90, 0, 45, 0], force_N: [0, 0, -1000], displacement_mm: [0.01, 0, -0.7]}
  - {joints_deg: [10, -80, 90, 0, 45, 180], moment_Nm: [0, 300, 0], load_point_mm: [5, 6, 7], displacement_mm: [0, 0.2, 0], rotation_rad: [0, 1.0e-4, 0]}
)";

TEST(Measurements, AreReadInInsideUnits) {
  const MeasurementsSettings read = ParseMeasurements(kYaml, "m.yaml");
  EXPECT_EQ(read.cell_file, "../cell.yaml");
  EXPECT_EQ(read.load_point, Eigen::Vector3d(0, 0, 100));
  EXPECT_EQ(read.displacement_deviation, 0.02);
  EXPECT_EQ(read.rotation_deviation, 1e-5);
  ASSERT_EQ(read.measurements.size(), 2u);
  const MeasurementSettings &first = read.measurements[0], &second = read.measurements[1];
  EXPECT_DOUBLE_EQ(first.joints[1], -kPi / 2);
  EXPECT_EQ(first.force, Eigen::Vector3d(0, 0, -1000));
  EXPECT_EQ(first.line, 7);
  EXPECT_FALSE(first.rotation || first.load_point);
  EXPECT_EQ(second.moment, Eigen::Vector3d(0, 300e3, 0));
  EXPECT_EQ(second.load_point, Eigen::Vector3d(5, 6, 7));
  EXPECT_EQ(second.rotation, Eigen::Vector3d(0, 1e-4, 0));
}

TEST(Measurements, ALoadAndADisplacementAreRequired) {
  const auto refused = [](const std::string& from, const std::string& to) {
    std::string text = kYaml;
    return RefusalOf([&] { ParseMeasurements(text.replace(text.find(from), from.size(), to), "m.yaml"); });
  };
  EXPECT_EQ(refused("force_N: [0, 0, -1000]", "force_N: [0, 0, 0]"),
            "m.yaml:7:5: measurements[0]: no load; allowed: force_N or moment_Nm other than 0");
  EXPECT_TRUE(refused(", displacement_mm: [0.01, 0, -0.7]", "")
                  .starts_with("m.yaml:7:5: measurements[0].displacement_mm: missing"));
  EXPECT_NE(refused("force_N", "force_kN").find("measurements[0].force_kN: unknown key"), std::string::npos);
}

const std::string kColumns = "a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,fx_N,fy_N,fz_N,dx_mm,dy_mm,dz_mm";

TEST(Measurements, TheCsvFormSaysTheSameAsTheYamlForm) {
  RandomStream random(1, 0);
  std::string csv = kColumns + ",mx_Nm,my_Nm,mz_Nm,rx_rad,ry_rad,rz_rad\n",
              yaml = "millpose_measurements: 1\nmeasurements:\n";
  for (int i = 0; i < 20; ++i) {
    std::vector<std::string> cells;
    for (int k = 0; k < 18; ++k) cells.push_back(fmt::format("{}", random.Uniform(-7, 7)));
    csv += fmt::format("{}\n", fmt::join(cells, ","));
    const auto list = [&](int first, int count) {
      return fmt::format("[{}]", fmt::join(cells.begin() + first, cells.begin() + first + count, ", "));
    };
    yaml += fmt::format(
        "  - {{joints_deg: {}, force_N: {}, displacement_mm: {}, moment_Nm: {}, rotation_rad: {}}}\n",
        list(0, 6), list(6, 3), list(9, 3), list(12, 3), list(15, 3));
  }
  const auto a = ParseMeasurementsCsv(csv, "m.csv").measurements,
             b = ParseMeasurements(yaml, "m.yaml").measurements;
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].joints, b[i].joints);
    EXPECT_EQ(a[i].force, b[i].force);
    EXPECT_EQ(a[i].moment, b[i].moment);
    EXPECT_EQ(a[i].displacement, b[i].displacement);
    EXPECT_EQ(a[i].rotation, b[i].rotation);
  }
}

TEST(Measurements, OfACsvEveryWrongRowIsNamed) {
  const auto refused = [](const std::string& columns, const std::string& rows) {
    return RefusalOf([&] { ParseMeasurementsCsv(columns + "\n" + rows, "m.csv"); });
  };
  EXPECT_EQ(refused(kColumns, "0,0,0,0,0,0,0,0,0,1,1,1\n3601,0,0,0,0,0,1,0,0,1,1,1\n"),
            "m.csv:2: no load; allowed: a force or a moment other than 0\n"
            "m.csv:3: a1_deg: given 3601; allowed: -3600 to 3600");
  EXPECT_EQ(refused(kColumns, "0,0,0,0,0,0,2e9,0,0,1,1,1\n0,0,0,0,0,0,1,0,0,2e6,1,1\n"),
            "m.csv:2: a number is too large; allowed: within ±1e9 N and N·m, ±1e6 mm and ±7 rad\n"
            "m.csv:3: a number is too large; allowed: within ±1e9 N and N·m, ±1e6 mm and ±7 rad");
  EXPECT_EQ(refused(kColumns + ",mx_Nm", "0,0,0,0,0,0,1,0,0,1,1,1,1\n"),
            "m.csv:1: only part of mx_Nm,my_Nm,mz_Nm; allowed: all three, or none");
}

std::string CellText() { return ReadFile(std::filesystem::path(SourceDir()) / "cells/kr500_r2830.yaml"); }

TEST(ReplaceJointStiffness, ChangesItsKeysAndNothingElse) {
  const std::string before = CellText();
  IdentifiedStiffness found;
  found.stiffness << 1e9, 2e9, 3e9, 4e9, 5e9, 6.25e9;
  found.uncertainty << 0.01, 0.02, 0.03, 0.04, 0.05, 0.5;
  found.source = "measured: 3 of 5, \"good\"";
  const std::string after = ReplaceJointStiffness(before, "cell.yaml", found);
  const CellSettings was = ParseCell(before, "cell.yaml");
  CellSettings is = ParseCell(after, "cell.yaml");
  EXPECT_TRUE(is.arm.stiffness.isApprox(found.stiffness, 1e-15));
  EXPECT_TRUE(is.arm.stiffness_uncertainty.isApprox(found.uncertainty, 1e-15));
  EXPECT_EQ(is.arm.stiffness_source, found.source);
  is.arm.stiffness = was.arm.stiffness;
  is.arm.stiffness_uncertainty = was.arm.stiffness_uncertainty;
  is.arm.stiffness_source = was.arm.stiffness_source;
  EXPECT_EQ(WriteCell(is), WriteCell(was));
  // Comments too: what was a line still is one, but for those two and a new one.
  size_t kept = 0;
  for (size_t at = 0; at < before.size();) {
    const size_t end = before.find('\n', at);
    kept += after.find(before.substr(at, end - at)) != std::string::npos ? 1 : 0;
    at = end + 1;
  }
  const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  EXPECT_EQ(static_cast<long>(kept), lines(before) - 2);
  EXPECT_EQ(lines(after), lines(before) + 1);
  EXPECT_EQ(ReplaceJointStiffness(after, "cell.yaml", found), after);
}

TEST(ReplaceJointStiffness, ACellWithoutTheKeyIsRefused) {
  EXPECT_EQ(RefusalOf([] { ReplaceJointStiffness("millpose_cell: 1\narm: {name: a}\n", "c.yaml", {}); }),
            "c.yaml: arm.joint_stiffness_Nm_per_rad is missing");
}

ComplianceSettings Tilting(int link, double compliance) {
  ComplianceSettings one;
  one.name = fmt::format("tilting of link {}", link);
  one.link = link;
  one.rotational.z() = compliance;
  return one;
}

TEST(ReplaceCompliances, WhatWasFoundReadsBackAndGoesAgain) {
  const std::string before = CellText();
  const std::string after =
      ReplaceCompliances(before, "cell.yaml", {Tilting(3, 1.23456e-13), Tilting(2, 7e-12)});
  const std::vector<ComplianceSettings> read = ParseCell(after, "cell.yaml").compliances;
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].name, "identified tilting of link 3");
  EXPECT_EQ(read[0].link, 3);
  EXPECT_NEAR(read[0].rotational.z(), 1.23e-13, 1e-27);
  EXPECT_EQ(ReplaceCompliances(after, "cell.yaml", {Tilting(3, 1.23456e-13), Tilting(2, 7e-12)}), after);
  EXPECT_TRUE(ParseCell(ReplaceCompliances(after, "cell.yaml", {}), "cell.yaml").compliances.empty());
}

TEST(ReplaceCompliances, ThoseOfOtherOriginStandAloneWhereOnlyJointsAreFound) {
  std::string cell = CellText();
  const std::string own =
      yaml::WithKey(cell, "cell.yaml", "stiffness", "compliances",
                    "[{name: spindle, mount: link6, translational_mm_N: [1e-6, 1e-6, 0]}]");
  EXPECT_EQ(ReplaceCompliances(own, "cell.yaml", {}), own);
  const std::string refusal = RefusalOf([&] { ReplaceCompliances(own, "cell.yaml", {Tilting(3, 1e-12)}); });
  EXPECT_NE(refusal.find("--springs"), std::string::npos) << refusal;
}

TEST(ReplaceDeviations, WhatItWritesIsReadBackAndWhatNobodyReadsIsNotWritten) {
  DeviationSettings found;
  found.shifts.assign(7, Eigen::Vector3d(0.25, -0.125, 0));
  found.turns.assign(7, Eigen::Vector3d(0, 1e-3, -3e-4));
  found.uncertainty = 0.08;
  found.source = "a file \"x: y\" # of 60";
  found.date = "2026-11-26";
  const std::string after = ReplaceDeviations(CellText(), "cell.yaml", found, "88: 2");
  const CellSettings read = ParseCell(after, "cell.yaml");
  EXPECT_EQ(read.arm.serial, "88: 2");
  EXPECT_EQ(read.arm.deviations->source, found.source);
  EXPECT_TRUE(read.arm.deviations->turns[3].isApprox(found.turns[3], 1e-15));
  // What the joints of the same arm do is not forgotten; another arm's are not taken over.
  const std::string with_gears = yaml::WithKey(after, "cell.yaml", "arm", "deviations",
                                               "{couplings: [{joint: 3, follows: 2, factor: 0.00045}], "
                                               "gears: [{joint: 1, harmonic: 1, amplitude_arcsec: 9, "
                                               "phase_deg: 30}], source: encoders, date: 2026-11-27}");
  const auto read_again = [&](const std::string& serial) {
    return *ParseCell(ReplaceDeviations(with_gears, "cell.yaml", found, serial), "cell.yaml").arm.deviations;
  };
  EXPECT_EQ(read_again("88: 2").gears.size(), 1u);
  EXPECT_EQ(read_again("88: 2").couplings.size(), 1u);
  EXPECT_TRUE(read_again("88: 2").turns[3].isApprox(found.turns[3], 1e-15));
  EXPECT_TRUE(read_again("88: 3").gears.empty());
  EXPECT_TRUE(read_again("88: 3").couplings.empty());
  found.date = "yesterday";
  EXPECT_NE(
      RefusalOf([&] { ReplaceDeviations(CellText(), "cell.yaml", found, "1"); }).find("given yesterday"),
      std::string::npos);
}

}  // namespace
}  // namespace millpose
