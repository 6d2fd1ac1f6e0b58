// SPDX-License-Identifier: GPL-3.0-or-later
// Slips in the sections that few jobs have, each at its place: leans, compensation, placement, external axes.
// In the texts ^ stands before what the message must point at.
#include "base/error.hpp"
#include "base/yaml/section.hpp"
#include "job/config/config.hpp"
#include "tests/job/config/cell_head.hpp"

namespace millpose {
namespace {

constexpr const char* kSlipJob = R"(millpose_job: 1
name: part
cell: cell.yaml
workpiece: {mesh: part.stl, unit: mm, pose: {xyz_mm: [1, 2, 3]}}
toolpath:
  strategy: parallel_planes
  planes: {normal: [0, 1, 0]}
  stepover_mm: 8
<toolpath>process: {feed_mm_min: 80, spindle_rpm: 7000}
<job>)";

const std::string kSlipCell =
    std::string(kCellHead) + R"(  stack: [{name: cutter, class: cutter, length_mm: 60, diameter_mm: 20}]
external_axes:
<axes>bodies:
  - {name: base, class: link, mount: base, shape: {sphere: {diameter_mm: 900}}}
<bodies>)";

constexpr const char* kRail =
    "  - {name: rail, kind: linear, carries: robot, axis: [1, 0, 0], limits_mm: [0, 4000], speed_mm_s: 500, "
    "acceleration_mm_s2: 800}\n";

std::string Filled(std::string text, const std::vector<std::pair<std::string, std::string>>& places) {
  for (const auto& [place, with] : places) text.replace(text.find(place), place.size(), with);
  return text;
}

std::string JobWith(const std::string& toolpath, const std::string& job = "") {
  return Filled(kSlipJob, {{"<toolpath>", toolpath}, {"<job>", job}});
}
std::string CellWith(const std::string& axes, const std::string& bodies = "") {
  return Filled(kSlipCell, {{"<axes>", axes}, {"<bodies>", bodies}});
}

/// Refused in one sentence that begins with `message`, at the mark.
template <class Parse>
void Expect(const Parse& parse, std::string text, const std::string& message) {
  const size_t mark = text.find('^');
  ASSERT_NE(mark, std::string::npos) << text;
  text.erase(mark, 1);
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(mark), '\n');
  const size_t before = text.rfind('\n', mark);
  try {
    parse(text);
    ADD_FAILURE() << "accepted: " << message;
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 1u) << error.what();
    const Problem& problem = error.problems()[0];
    EXPECT_TRUE(problem.message.starts_with(message)) << error.what();
    EXPECT_EQ(problem.place.line, line) << error.what();
    EXPECT_EQ(static_cast<size_t>(problem.place.column), mark - before) << error.what();
  }
}
void ExpectJob(const std::string& text, const std::string& message) {
  Expect([](const std::string& job) { ParseJob(job, "f.yaml"); }, text, message);
}
void ExpectCell(const std::string& text, const std::string& message) {
  Expect([](const std::string& cell) { ParseCell(cell, "f.yaml"); }, text, message);
}

TEST(SectionSlips, OfLeans) {
  ASSERT_NO_THROW(ParseJob(JobWith("  lead_deg: {from: 1, to: 3, step: 1}\n"), "f.yaml"));
  ExpectJob(JobWith("  lead_deg: {from: 3, to: ^3, step: 1}\n"), "toolpath.lead_deg.to: given 3");
  ExpectJob(JobWith("  lead_deg: {from: 1, to: 3, step: ^2.5}\n"), "toolpath.lead_deg.step: given 2.5");
  ExpectJob(JobWith("  lead_deg: {from: 0, to: 30, step: ^1}\n"), "toolpath.lead_deg.step: given 1");
  ExpectJob(JobWith("  tilt_deg: {from: 1, to: 3, step: 1, nominal: ^0}\n"),
            "toolpath.tilt_deg.nominal: given 0");
  ExpectJob(JobWith("  ^min_cutting_speed_share: 0.5\n"),
            "toolpath.min_cutting_speed_share: has no effect here: needs a range in lead_deg");
  ExpectJob(JobWith("  tilt_deg: {from: -3, to: 3, step: 1}\n  ^min_cutting_speed_share: 0.5\n"),
            "toolpath.min_cutting_speed_share: has no effect here: at the nominal lean, 0");
  ExpectJob(
      JobWith("  ^lead_deg: {from: 1, to: 3, step: 1}\n  tool_axis: {rule: fixed, direction: [0, 0, 1]}\n"),
      "toolpath.lead_deg: a range leans the tool from the surface's normal");
  ExpectJob(JobWith("", "path: {^max_lean_change_deg_per_mm: 1}\n"),
            "path.max_lean_change_deg_per_mm: has no effect here: needs a range");
  ExpectJob(JobWith("  lead_deg: {from: 1, to: 3, step: 1}\n",
                    "pose: {objective: {name: chen2021}, ^formulation: paper}\n"),
            "pose.formulation: paper knows the rotation about the tool axis alone");
}

TEST(SectionSlips, TheNominalLeanIsTheOneNearestToUpright) {
  const auto nominal = [](const char* range) {
    const JobSettings job = ParseJob(JobWith(fmt::format("  lead_deg: {}\n", range)), "f.yaml");
    EXPECT_EQ(job.toolpath.lead, job.toolpath.Find("lead")->Nominal()) << "the path is laid at it";
    return RadToDeg(job.toolpath.lead);
  };
  EXPECT_DOUBLE_EQ(nominal("{from: 1, to: 3, step: 1}"), 1);
  EXPECT_DOUBLE_EQ(nominal("{from: -4, to: -2, step: 1}"), -2);
  EXPECT_DOUBLE_EQ(nominal("{from: -4, to: 2, step: 1}"), 0);
  EXPECT_DOUBLE_EQ(nominal("{from: -4, to: 2, step: 1, nominal: -3}"), -3);
  EXPECT_FALSE(ParseJob(JobWith("  lead_deg: 2\n"), "f.yaml").toolpath.Leans());
}

TEST(SectionSlips, OfCompensation) {
  for (const char* key : {"shrink: 0.5", "stiffness_uncertainty_percent: 20", "layers: all"}) {
    const std::string name = std::string(key).substr(0, std::string(key).find(':'));
    ExpectJob(JobWith("", fmt::format("compensation: {{weight: true, ^{}}}\n", key)),
              "compensation." + name + ": has no effect here: compensation.deflection is off");
  }
  ExpectJob(JobWith("", "compensation: {^max_mm: 0.2}\n"),
            "compensation.max_mm: has no effect here: nothing is compensated");
  EXPECT_NO_THROW(ParseJob(JobWith("", "compensation: {weight: true, max_mm: 0.2}\n"), "f.yaml"));
}

TEST(SectionSlips, OfPlacement) {
  const auto placement = [](const std::string& keys) { return JobWith("", "placement: " + keys + "\n"); };
  ASSERT_NO_THROW(ParseJob(placement("{x_mm: {from: -1, to: 1}, map: [x_mm]}"), "f.yaml"));
  ExpectJob(placement("{x_mm: ^{from: 1, to: 1}}"), "placement.x_mm: `to` must be more than `from`");
  ExpectJob(placement("^{points: 3}"),
            "placement: give a range for one of x_mm, y_mm, z_mm, a_deg, b_deg, c_deg");
  ExpectJob(placement("{x_mm: {from: 0, to: 1}, ^map: [y_mm]}"),
            "placement.map: given y_mm, which has no range");
  ExpectJob(placement("{x_mm: {from: 0, to: 1}, ^map: [x_mm, x_mm]}"),
            "placement.map: give one direction or two different ones");
  ExpectJob(placement("{x_mm: {from: 0, to: 1}, stations: {most: ^1, error_mm: 1}}"),
            "placement.stations.most: given 1; allowed: integer 2…9");
  ExpectJob(placement("{x_mm: {from: 0, to: 1}, stations: ^{most: 2}}"),
            "placement.stations.error_mm: missing");
}

TEST(SectionSlips, OfExternalAxes) {
  ASSERT_NO_THROW(ParseCell(CellWith(kRail), "f.yaml"));
  const auto rail = [](const std::string& from, const std::string& to) {
    return CellWith(Filled(kRail, {{from, to}}));
  };
  ExpectCell(rail("limits_mm: [0, 4000]", "limits_mm: ^[4000, 0]"),
             "external_axes[0].limits_mm: given no range");
  ExpectCell(rail("limits_mm: [0, 4000]", "limits_mm: ^[4000]"),
             "external_axes[0].limits_mm: given no range");
  ExpectCell(rail("  - {name: rail", "  - ^{name: rail, home_mm: -1"),
             "external_axes[0].home_mm: given -1; allowed: within limits_mm");
  ExpectCell(rail("speed_mm_s: 500", "speed_mm_s: 500, ^home_deg: 1"),
             "external_axes[0].home_deg: has no effect here: kind is linear; allowed: home_mm");
  ExpectCell(rail("speed_mm_s: 500", "speed_mm_s: 500, ^origin_mm: [0, 0, 0]"),
             "external_axes[0].origin_mm: has no effect here: a linear axis has no place");
  ExpectCell(rail("  - {name: rail", "  - ^{name: rail, stiffness_N_mm: 1e5"),
             "external_axes[0].stiffness_source: missing; required with a stiffness");
  ExpectCell(rail("name: rail", "name: rail, ^stiffness_source: guessed"),
             "external_axes[0].stiffness_source: has no effect here");
  ExpectCell(
      CellWith("  - ^{name: table, kind: rotary, carries: workpiece, axis: [0, 0, 1], limits_deg: [-180, "
               "180], speed_deg_s: 50, acceleration_deg_s2: 80}\n"),
      "external_axes[0].origin_mm: missing; required where kind is rotary");
  ExpectCell(rail("speed_mm_s: 500, ", "").replace(rail("speed_mm_s: 500, ", "").find("{name: rail"), 0, "^"),
             "external_axes[0].speed_mm_s: missing; required where kind is linear");
  std::string twice = Filled(kRail, {{"  - {", "  - ^{"}});
  ExpectCell(CellWith(kRail + twice), "external_axes[1].name: given rail twice");
  const std::string column = ", class: fixture, shape: {sphere: {diameter_mm: 9}}";
  ExpectCell(CellWith(kRail, "  - ^{name: a, mount: carriage, axis: rial" + column + "}\n"),
             "bodies[1].axis: given 'rial'; allowed: the name of one of external_axes; did you mean 'rail'?");
  ExpectCell(CellWith(kRail, "  - {name: a, mount: world, ^axis: rail" + column + "}\n"),
             "bodies[1].axis: has no effect here: mount is not carriage");
}

TEST(SectionSlips, AStiffnessOfAnExternalAxisIsReadAsCompliance) {
  const CellSettings cell = ParseCell(
      CellWith(Filled(kRail, {{"{name: rail", "{name: rail, stiffness_N_mm: 2e5, stiffness_source: maker"}})),
      "f.yaml");
  ASSERT_EQ(cell.external_axes.size(), 1u);
  EXPECT_DOUBLE_EQ(cell.external_axes[0].compliance.value_or(0), 5e-6);
  EXPECT_FALSE(ParseCell(CellWith(kRail), "f.yaml").external_axes[0].compliance) << "rigid";
}

TEST(SectionSlips, OfWhereExternalAxesStand) {
  const auto external = [](const std::string& keys) {
    return JobWith("", "external:\n  - {axis: rail, " + keys + "}\n");
  };
  ASSERT_NO_THROW(ParseJob(external("scope: constant, at_mm: 1500"), "f.yaml"));
  ASSERT_NO_THROW(ParseJob(external("scope: continuous, step_mm: 500"), "f.yaml"));
  ExpectJob(external("scope: continuous, ^at_mm: 3"),
            "external[0].at_mm: has no effect here: with scope continuous the planner chooses");
  ExpectJob(external("scope: per_pass, ^at_mm: 3"),
            "external[0].at_mm: has no effect here: with scope per_pass the planner chooses");
  ExpectJob(external("scope: constant, at_mm: 3, ^step_mm: 3"),
            "external[0].step_mm: has no effect here: the position is given");
  ExpectJob(external("scope: constant, at_mm: 3, ^at_deg: 3"),
            "external[0].at_deg: given beside the other unit");
  ExpectJob(external("scope: per_pass, step_mm: 3, ^step_deg: 3"),
            "external[0].step_deg: given beside the other unit");
}

TEST(SectionSlips, OfDeviations) {
  const auto cell = [](const std::string& arm) {
    return Filled(CellWith(kRail, ""), {{"home_deg:", arm + "home_deg:"}});
  };
  const std::string zeros = "[[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], ";
  const auto given = [&](const std::string& more, const std::string& key = "deviations") {
    return "  " + key + ": {shifts_mm: " + zeros + "[0, 0.5, 0]], " + more + "}\n";
  };
  const std::string turns = "turns_mrad: " + zeros + "[0, 0, 2]], ",
                    whole = turns + "source: tracker, date: ";
  const std::string serial = "  serial: A17\n";
  const CellSettings read = ParseCell(cell(serial + given(whole + "2026-11-26")), "f.yaml");
  EXPECT_EQ(read.arm.deviations->shifts[6].y(), 0.5);
  EXPECT_NEAR(read.arm.deviations->turns[6].z(), 2e-3, 1e-18);
  EXPECT_EQ(WriteCell(ParseCell(WriteCell(read), "f.yaml")), WriteCell(read));
  ExpectCell(cell(given(whole + "2026-11-26", "^deviations")),
             "arm.serial: missing; required with deviations");
  ExpectCell(cell("  ^serial: A17\n"), "arm.serial: has no effect here: deviations is missing");
  ExpectCell(cell(serial + "  absolute_accuracy: true\n" + given(whole + "2026-11-26", "^deviations")),
             "arm.deviations: given together with absolute_accuracy: true");
  ExpectCell(cell(serial + given(turns + "source: tracker, ^date: 26.11.2026")),
             "arm.deviations.date: given 26.11.2026; allowed: a date such as 2026-11-26");
  const std::string rows = zeros + "[0, 0, 2]]";
  EXPECT_EQ(ParseCell(cell(serial + given("patterns: [{shifts_mm: " + rows + ", turns_mrad: " + rows +
                                          "}], " + whole + "2026-11-26")),
                      "f.yaml")
                .arm.deviations->patterns[0]
                .shifts[6]
                .z(),
            2);
  ExpectCell(cell(serial + given("patterns: [{shifts_mm: " + rows + ", ^turns_mrad: [[0, 0, 0]]}], " + whole +
                                 "2026-11-26")),
             "arm.deviations.patterns[0].turns_mrad: given 1 rows; allowed: seven");
  ExpectCell(cell(serial + "  deviations: ^{" + whole + "2026-11-26}\n"),
             "arm.deviations.shifts_mm: missing; required without gears or couplings");
  ExpectCell(cell(serial + given("^turns_mrad: [[0, 0, 0]], source: tracker, date: 2026-11-26")),
             "arm.deviations.turns_mrad: given 1 rows; allowed: seven");
}

TEST(SectionSlips, OfGearTables) {
  const auto cell = [](const std::string& gears, const std::string& more = "") {
    return Filled(CellWith(kRail, ""),
                  {{"home_deg:", "  serial: A17\n  deviations: {" + gears +
                                     "source: encoders, date: 2026-11-26}\n" + more + "home_deg:"}});
  };
  const auto wave = [](const std::string& joint, const std::string& harmonic, const std::string& amplitude) {
    return "{joint: " + joint + ", harmonic: " + harmonic + ", amplitude_arcsec: " + amplitude +
           ", phase_deg: 90}";
  };
  const CellSettings read = ParseCell(
      cell("gears: [" + wave("2", "171", "12") + "], couplings: [{joint: 3, follows: 2, factor: 0.00045}], "),
      "f.yaml");
  EXPECT_NEAR(read.arm.deviations->gears[0].amplitude, DegToRad(1.0 / 300), 1e-18);
  EXPECT_EQ(read.arm.deviations->couplings[0].factor, 0.00045);
  EXPECT_EQ(read.arm.deviations->shifts.size(), 7u);
  EXPECT_EQ(WriteCell(ParseCell(WriteCell(read), "f.yaml")), WriteCell(read));
  ExpectCell(cell("gears: [" + wave("^7", "1", "12") + "], "), "arm.deviations.gears[0].joint: given 7");
  ExpectCell(cell("gears: [" + wave("1", "^0", "12") + "], "), "arm.deviations.gears[0].harmonic: given 0");
  ExpectCell(cell("gears: [" + wave("1", "1", "^0") + "], "),
             "arm.deviations.gears[0].amplitude_arcsec: given 0");
  ExpectCell(cell("gears: [" + wave("1", "1", "9") + ", ^" + wave("1", "1", "8") + "], "),
             "arm.deviations.gears[1]: given harmonic 1 of joint 1 twice");
  ExpectCell(cell("gears: ^[" + wave("1", "500", "60") + "], "),
             "arm.deviations.gears: a joint that turns by up to 0.145 of");
  ExpectCell(cell("couplings: [{joint: 3, follows: ^3, factor: 0.01}], "),
             "arm.deviations.couplings[0].follows: given 3, the joint itself");
  ExpectCell(cell("couplings: [{joint: 3, follows: 2, factor: ^0}], "),
             "arm.deviations.couplings[0].factor: given 0");
  ExpectCell(
      cell("couplings: [{joint: 3, follows: 2, factor: 0.01}, ^{joint: 3, follows: 2, factor: 0.02}], "),
      "arm.deviations.couplings[1]: given joint 3 with joint 2 twice");
  ExpectCell(
      cell("gears: [" + wave("1", "1", "9") + "], ", "  ^gear_couplings: [{gear: 3, axis: 2, factor: 1}]\n"),
      "arm.gear_couplings: given together with deviations.gears");
}

TEST(SectionSlips, OfGears) {
  const auto cell = [](const std::string& arm, const std::string& axes = kRail,
                       const std::string& more = "") {
    return Filled(CellWith(axes, more), {{"home_deg:", arm + "home_deg:"}});
  };
  constexpr const char* kWidths = "  lost_motion_arcmin: [0.3, 0, 0.6, 1, 0.3, 0.3]\n";
  constexpr const char* kSource = "  lost_motion_source: measured\n";
  const CellSettings read = ParseCell(
      cell(std::string(kWidths) + kSource + "  gear_couplings: [{gear: 3, axis: 2, factor: 1}]\n"), "f.yaml");
  EXPECT_NEAR((*read.arm.lost_motion)[2], DegToRad(0.01), 1e-15);
  EXPECT_EQ(GearMatrix(read.arm)(2, 1), 1);
  EXPECT_EQ(WriteCell(ParseCell(WriteCell(read), "f.yaml")), WriteCell(read));
  ExpectCell(cell("  ^lost_motion_arcmin: [0.3, 0, 0.6, 1, 0.3, 0.3]\n"),
             "arm.lost_motion_source: missing; required with lost_motion_arcmin");
  ExpectCell(cell("  ^lost_motion_source: guessed\n"), "arm.lost_motion_source: has no effect here");
  ExpectCell(cell("  lost_motion_arcmin: [0.3, 0, 0.6, 1, 0.3, ^61]\n" + std::string(kSource)),
             "arm.lost_motion_arcmin[5]: given 61");
  ExpectCell(cell("  ^gear_friction_Nm: [1, 1, 1, 1, 1, 1]\n"),
             "arm.gear_friction_Nm: has no effect here: the cell says no weights");
  ExpectCell(cell("  gear_couplings: [{gear: 3, axis: ^3, factor: 1}]\n"),
             "arm.gear_couplings[0].axis: given 3, the gear's own");
  ExpectCell(cell("  gear_couplings: [{gear: 3, axis: 2, factor: ^0}]\n"),
             "arm.gear_couplings[0].factor: given 0");
  ExpectCell(cell("  gear_couplings: [{gear: 3, axis: 2, factor: 1}, ^{gear: 3, axis: 2, factor: -1}]\n"),
             "arm.gear_couplings[1]: given gear 3 with axis 2 twice");
  ExpectCell(cell("  gear_couplings: ^[{gear: 3, axis: 2, factor: 1}, {gear: 2, axis: 3, factor: 1}]\n"),
             "arm.gear_couplings: given couplings that leave axes without a gear of their own");
  std::string rail = kRail;
  rail.replace(rail.find('}'), 1, ", ^lost_motion_um: 20}");
  ExpectCell(cell("", rail), "external_axes[0].lost_motion_source: missing");
  rail.replace(rail.find("^lost_motion_um: 20"), 19, "^lost_motion_arcmin: 2, lost_motion_source: x");
  ExpectCell(
      cell("", rail),
      "external_axes[0].lost_motion_arcmin: has no effect here: kind is linear; allowed: lost_motion_um");
}

TEST(SectionCheck, AnEmptyFunctionIsNone) {
  const std::function<void(const yaml::Value&, const yaml::Context&, PoseSettings&)> none;
  const auto section = yaml::Section<PoseSettings>(
      {yaml::Key<PoseSettings>("xyz_mm", MILLPOSE_AT(position), yaml::Coordinates(), "Origin.")}, none);
  const std::string file = "pose.yaml";
  std::vector<Problem> problems;
  PoseSettings pose;
  section.read(yaml::ReadYaml("xyz_mm: [1, 2, 3]", file), {file, problems, ""}, pose);
  EXPECT_TRUE(problems.empty());
  EXPECT_NE(pose.position, PoseSettings().position);
}

}  // namespace
}  // namespace millpose
