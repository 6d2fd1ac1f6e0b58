// SPDX-License-Identifier: GPL-3.0-or-later
// Every kind of slip in a job or cell file, with the exact place and the key that the message must name.
#include <ctime>

#include "base/shown.hpp"
#include "base/yaml/value.hpp"
#include "job/config/config.hpp"
#include "tests/job/config/cell_head.hpp"
#include "tests/job/config/slip.hpp"

namespace millpose {
namespace {

// Line numbers of the expectations below count in this text; line 1 is the first key.
constexpr const char* kJob =
    R"(millpose_job: 1
name: part
cell: cell.yaml
workpiece:
  mesh: part.stl
  unit: mm
  pose: {xyz_mm: [1, 2, 3], abc_deg: [0, -90, 0]}
toolpath:
  strategy: parallel_planes
  region: {facing: {direction: [0, 0, 1], within_deg: 1}}
  planes: {normal: [0, 1, 0]}
  stepover_mm: 8
process:
  feed_mm_min: 80
  spindle_rpm: 7000
path:
  max_joint_step_deg: [5, 5, 5, 5, 5, 5]
programs: [krl]
)";

const std::string kCell = std::string(kCellHead) + R"(  stack:
    - {name: cutter, class: cutter, length_mm: 60, diameter_mm: 20}
bodies:
  - {name: base, class: link, mount: base, shape: {sphere: {diameter_mm: 900}}}
)";

const Slip kJobSlips[] = {
    {"programs:", "pose:\n  formulation: paper\n  objective: {name: isotropy}\nprograms:", 19, 3,
     "pose.formulation: given paper; allowed only with objective chen2021 without references, given "
     "isotropy"},
    {"programs:",
     "pose:\n  formulation: paper\n  objective: {name: chen2021, reference_t2: 1.0e-4}\nprograms:", 19, 3,
     "pose.formulation: given paper; allowed only with objective chen2021 without references"},
    {"[5, 5, 5, 5, 5, 5]", "[5, 5, 5, 5, 5, 5]\n  motion_weight: 1.0e-5", 18, 3,
     "path.motion_weight: is no longer a key: give path.motion_share, "},
    {"  strategy: parallel_planes\n",
     "  strategy: curve\n  curve: {points_mm: [[0, 0, 0], [1, 0, 0]], project_along: [0, 0, -1], direction: "
     "[0, 0, 1]}\n",
     10, 73,
     "toolpath.curve.direction: is no longer a key: give project_along, the direction of looking, which is "
     "the opposite one"},
    {"[5, 5, 5, 5, 5, 5]", "[5, 5, 5, 5, 5, 5]\n  max_lifts: 2", 18, 3,
     "path.max_lifts: has no effect here: lift_gain_percent is 0"},
    {"[5, 5, 5, 5, 5, 5]", "[5, 5, 5, 5, 5, 5]\n  over_missing: cut", 18, 3,
     "path.over_missing: has no effect here: needs process.cutting, without a side"},
    {"feed_mm_min: 80", "force_uncertainty_percent: 10\n  feed_mm_min: 80", 14, 3,
     "process.force_uncertainty_percent: has no effect here: objective chen2021 does not ask for it"},
    {"programs:", "pose: {objective: {name: surface_error, force_direction_deg: 3}}\nprograms:", 18, 41,
     "pose.objective.force_direction_deg: unknown key; it is one of `process`"},
    {"programs:", "pose: {formulation: papr}\nprograms:", 18, 21, "pose.formulation: given papr; allowed: "},
    {"programs:", "pose: {paper: {population: 10, elite: 10}}\nprograms:", 18, 15,
     "pose.paper.elite: given 10; allowed: less than population, 10"},
    {"stepover_mm: 8", "stepver_mm: 8\n  stepover_mm: 8", 12, 3,
     "toolpath.stepver_mm: unknown key; nearest known key: stepover_mm"},
    {"stepover_mm: 8", "stepover: 5\n  stepover_mm: 8", 12, 3,
     "toolpath.stepover: the key lacks its unit; nearest known key: stepover_mm"},
    {"stepover_mm: 8", "stepover_mm: 8\n  stepover_mm: 9", 13, 3,
     "stepover_mm: given twice; the first is in line 12"},
    {"stepover_mm: 8", "stepover_mm: 0", 12, 16,
     "toolpath.stepover_mm: given 0; allowed: number 0.001…10000, mm"},
    {"stepover_mm: 8", "stepover_mm: 1e-8", 12, 16,
     "toolpath.stepover_mm: given 1e-8; allowed: number 0.001…10000, mm"},
    {"spindle_rpm: 7000", "spindle_rpm: 1e300", 15, 16,
     "process.spindle_rpm: given 1e300; allowed: number 0…500000, rev/min"},
    {"stepover_mm: 8", "stepover_mm: -1e-3", 12, 16,
     "toolpath.stepover_mm: given -1e-3; allowed: number 0.001…10000, mm"},
    {"stepover_mm: 8", "stepover_mm: 8 mm", 12, 16,
     "toolpath.stepover_mm: given 8 mm; allowed: number 0.001…10000, mm"},
    {"stepover_mm: 8", "stepover_mm: \"8\"", 12, 16,
     "toolpath.stepover_mm: given the text \"8\"; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: .nan", 12, 16, "toolpath.stepover_mm: given .nan; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: .inf", 12, 16, "toolpath.stepover_mm: given .inf; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: 1e999", 12, 16, "toolpath.stepover_mm: given 1e999; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: 010", 12, 16, "toolpath.stepover_mm: given 010; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: 0x10", 12, 16, "toolpath.stepover_mm: given 0x10; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: 1_000", 12, 16, "toolpath.stepover_mm: given 1_000; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: 8,5", 12, 16, "toolpath.stepover_mm: given 8,5; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: [8]", 12, 16,
     "toolpath.stepover_mm: given a list of 1; allowed: number"},
    {"stepover_mm: 8", "stepover_mm: {mm: 8}", 12, 16, "toolpath.stepover_mm: given a map; allowed: number"},
    {"stepover_mm: 8", "stepover_mm:", 12, 3, "toolpath.stepover_mm: given nothing; allowed: number"},
    {"  stepover_mm: 8\n", "", 9, 3, "toolpath.stepover_mm: missing; required: number 0.001…10000, mm"},
    {"process:\n  feed_mm_min: 80\n  spindle_rpm: 7000\n", "", 1, 1,
     "process: missing; required without operations: map"},
    {"  strategy: parallel_planes", "  strategy: paralel_planes", 9, 13,
     "toolpath.strategy: given paralel_planes; allowed: one of parallel_planes, "},
    {"unit: mm", "unit: millimetre", 6, 9, "workpiece.unit: given millimetre; allowed: one of mm, cm, in, m"},
    {"[5, 5, 5, 5, 5, 5]", "[5, 5, 5, 5, 5]", 17, 23,
     "path.max_joint_step_deg: given a list of 5; allowed: list of 6 numbers > 0, ≤ 360, deg"},
    {"[5, 5, 5, 5, 5, 5]", "[5, 5, 5, 5, 0, 5]", 17, 36,
     "path.max_joint_step_deg[4]: given 0; allowed: number > 0, ≤ 360, deg"},
    {"normal: [0, 1, 0]", "normal: [0, 0, 0]", 11, 20,
     "toolpath.planes.normal: given a list of 3; allowed: direction of 3 numbers, not all 0"},
    {"within_deg: 1}", "within_deg: 181}", 10, 55,
     "toolpath.region.facing.within_deg: given 181; allowed: number 0…180, deg"},
    {"direction: [0, 0, 1], ", "", 10, 20,
     "toolpath.region.facing.direction: missing; required: direction of 3 numbers"},
    {"name: part", "name: 12", 2, 7, "name: given 12; allowed: name that a file can have"},
    {"name: part", "name: true", 2, 7, "name: given true; allowed: name that a file can have"},
    {"name: part", "name: \"\"", 2, 7, "name: given the text \"\"; allowed: name that a file can have"},
    {"name: part", "name: ../part", 2, 7, "name: given ../part; allowed: a name that a file can have"},
    {"name: part", "name: *part", 2, 7, "not YAML: the referenced anchor is not defined"},
    {"mesh: part.stl\n  unit: mm", "mesh: part.stl\n  unit: mm\n  frame: 1", 7, 10,
     "workpiece.frame: given 1; allowed: one of world"},
    {"strategy: parallel_planes", "strategy: rings\n  rings: {point_mm: [0, 0, 0], axis: [0, 0, 1]}", 12, 3,
     "toolpath.planes: belongs to strategy parallel_planes, given rings"},
    {"  planes: {normal: [0, 1, 0]}\n", "", 9, 3,
     "toolpath.planes: missing; required by strategy parallel_planes"},
    {"name: part", "name: &part part", 2, 7, "anchors (&name) are not allowed"},
    {"name: part", "name: !!str part", 2, 7, "given the tag tag:yaml.org,2002:str; allowed"},
    {"name: part", "<<: {name: part}", 2, 1, "merge keys (<<) are not allowed"},
    {"name: part", "name: part\nGr\u00f6\u00dfe: 1", 3, 1, "Größe: unknown key; allowed: millpose_job, name"},
    {"name: part", "name: part\nseed: 1.5", 3, 7, "seed: given 1.5; allowed: integer 0…"},
    {"name: part", "name: part\nseed: -1", 3, 7, "seed: given -1; allowed: integer 0…"},
    {"name: part", "name: part\nlimits: {margin_deg: 50}", 3, 22,
     "limits.margin_deg: given 50; allowed: number 0…45, deg"},
    {"name: part", "name: part\npose: {genetic: {elite: 50}}", 3, 17,
     "pose.genetic.elite: given 50; allowed: less than population, 16"},
    {"name: part", "name: part\npose: {objective: {name: chen2021, w1: half}}", 3, 40,
     "pose.objective.w1: given half; allowed: number"},
    {"name: part", "name: part\npose: {objective: {expression: 2*lamda_n_mm_N}}", 3, 32,
     "pose.objective.expression: at character 3: no index or function \"lamda_n_mm_N\"; known: "
     "lambda_t1_mm_N"},
    {"name: part", "name: part\npose: {objective: {expression: mu, w1: 1}}", 3, 36,
     "pose.objective.w1: has no effect beside expression"},
    {"name: part", "name: part\npose: {objective: {expression: chen2021}}", 3, 32,
     "pose.objective.expression: no index or function \"chen2021\""},
    {"name: part", "name: part\npose: {objective: {expression: [mu]}}", 3, 32,
     "pose.objective.expression: given a list of 1; allowed: text: an expression of indices"},
    {"name: part", "name: part\npose: {objective: {name: chen2012, w3: 1}}", 3, 26,
     "pose.objective.name: given chen2012; allowed: one of chen2021, drilling"},
    {"name: part", "name: part\npose: {objective: {name: chen2021, w3: 1}}", 3, 36,
     "pose.objective.w3: no parameter \"w3\"; known: w1, w2, reference_t2, reference_n; did you mean"},
    {"name: part", "name: part\npose: {objective: {name: chen2021, w1: -1}}", 3, 40,
     "pose.objective.w1: given -1; allowed: at least 0"},
    {"name: part", "name: part\npose: {objective: {name: surface_error, direction: sideways}}", 3, 52,
     "pose.objective.direction: given sideways; allowed: one of normal, wall, any"},
    {"name: part", "name: part\npose: {objective: {name: face_error, direction: 1}}", 3, 38,
     "pose.objective.direction: no parameter \"direction\""},
    {"millpose_job: 1", "millpose_job: 2", 1, 15, "millpose_job: given 2; allowed: integer 1"},
    {"millpose_job: 1", "\xef\xbb\xbfmillpose_job: 2", 1, 15, "millpose_job: given 2; allowed: integer 1"},
    {"programs: [krl]", "programs: [krl, fanoc]", 18, 17, "programs[1]: given fanoc; allowed: one of krl"},
    {"programs: [krl]", "programs: krl", 18, 11, "programs: given krl; allowed: a list"},
    {"programs: [krl]", "programs: [krl", 18, 11,
     "not YAML: [ is opened here and not closed; ] or a comma is missing before line 19, column 1"},
    {"normal: [0, 1, 0]}", "normal: [0, 1, 0]", 11, 11,
     "not YAML: { is opened here and not closed; } or a comma is missing before line 12, column "},
    {"normal: [0, 1, 0]}", "normal: [0, 1, 0}", 11, 28,
     "not YAML: this bracket is not the end of the one that is open here"},
    {"workpiece:\n", "workpiece\n", 5, 7,
     "not YAML: no key may stand before this colon; is one missing at the end of the line above"},
    {"name: part", "name: part: two", 2, 11, "not YAML: no key may stand before this colon"},
    {"name: part", "name: \"part", 2, 7,
     "\" is opened here and not closed in this line; allowed: text with \""},
    {"name: part", "name: 'it''s a part", 2, 7, "' is opened here and not closed in this line"},
    {"mesh: part.stl", "mesh: \"part.stl\\\"", 5, 9, "\" is opened here and not closed in this line"},
    {"programs: [krl]", "programs: [\"krl\", \"rapid]", 18, 19,
     "\" is opened here and not closed in this line"},
    // Closed many lines below, by the first quote of another text, by the end of one and in a comment.
    {"name: part\ncell: cell.yaml", "name: \"part\ncell: \"cell.yaml\"", 2, 7, "\" is opened here and not"},
    {"name: part\ncell: cell.yaml", "name: \"part\ncell: cell.yaml\"", 2, 7, "\" is opened here and not"},
    {"name: part\ncell: cell.yaml", "name: \"part\ncell: cell.yaml  # 5\"", 2, 7,
     "\" is opened here and not"},
    // Quotes that open nothing do not stand in for the slip.
    {"programs: [krl]", "seed: 1  # 'no\nwide: it's 5\" wide\ntext: |\n  - \"a\nprograms: [krl", 22, 11,
     "not YAML: [ is opened here and not closed"},
    {"programs: [krl]", "programs: [krl]\n---\nname: b", 19, 1, "a second document starts here"},
    {"programs: [krl]",
     "programs: [krl]\nprogram_options: {path_tolerance_mm: 0.01, point_economy: {chord_mm: 0.009}}", 19, 70,
     "program_options.point_economy.chord_mm: given 0.009 mm; allowed: at most 0.8 of the path's tolerance, "
     "0.008"},
    {"  spindle_rpm", "\tspindle_rpm", 15, 1, "given a tab in the indentation"},
    {"name: part", "name: pa\x04rt", 2, 9, "given the control character 0x04"},
};

const Slip kCellSlips[] = {
    {"[-130, 20]", "[20, -130]", 7, 29, "arm.limits_deg[1]: given [20, -130]; allowed: [lower, upper]"},
    {"[-130, 20]", "[-130]", 7, 29, "arm.limits_deg[1]: given a list of 1; allowed: [lower, upper]"},
    {"[-1, 1, 1, -1, 1, -1]", "[-1, 1, 1, 0, 1, -1]", 6, 26, "arm.axis_signs[3]: given 0; allowed: 1 or -1"},
    {"x_in_flange: [0, 0, 1]", "x_in_flange: [2, 0, 0]", 13, 3,
     "tool.x_in_flange: is parallel to axis_in_flange"},
    {"sphere: {diameter_mm: 900}", "ball: {diameter_mm: 900}", 21, 52, "bodies[0].shape.ball: unknown key"},
    {"{sphere: {diameter_mm: 900}}", "{sphere: {diameter_mm: 900}, box: {size_mm: [1, 1, 1]}}", 21, 51,
     "bodies[0].shape: given 2 keys; allowed: one of box"},
    {"{diameter_mm: 900}", "{length_mm: 900, diameter_mm: 900}", 21, 61,
     "bodies[0].shape.sphere.length_mm: unknown key"},
    {"mount: base", "mount: link7", 21, 38, "bodies[0].mount: given link7; allowed: one of world"},
    {"d6: 290}", "}", 5, 15, "arm.lengths_mm.d6: missing; required: number"},
    {"cutter: {diameter_mm: 20,", "cutter: {diameter_mm: 20, corner_radius_mm: 11,", 17, 11,
     "tool.cutter.corner_radius_mm: given 11 mm; allowed: at most half of diameter_mm, 10 mm"},
};

}  // namespace

TEST(BrokenYaml, JobSlipsAreNamedWithTheirPlace) {
  ASSERT_NO_THROW(ParseJob(kJob, "f.yaml"));
  const auto parse = [](const std::string& text, const std::string& name) { ParseJob(text, name); };
  for (const Slip& slip : kJobSlips) ExpectProblem(slip, Slipped(kJob, slip), parse);
}

TEST(BrokenYaml, CellSlipsAreNamedWithTheirPlace) {
  ASSERT_NO_THROW(ParseCell(kCell, "f.yaml"));
  for (const Slip& slip : kCellSlips) ExpectProblem(slip, Slipped(kCell, slip), ParseCell);
}

TEST(BrokenYaml, MaterialsMayLookLikeNumbersAndAreKnownByNameOrAlias) {
  const auto with = [](const std::string& cutting) {
    return Slipped(kJob, {"  spindle_rpm: 7000", ("  spindle_rpm: 7000\n  cutting: " + cutting).c_str()});
  };
  const auto problem = [&](const std::string& cutting) -> std::string {
    try {
      ParseJob(with(cutting), "f.yaml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  for (const char* material : {"6061", "1.4404", "\"2024\"", "316L", "ti6al4v", "EN AW-7075"})
    EXPECT_EQ(problem(fmt::format("{{teeth: 2, material: {}}}", material)), "") << material;
  EXPECT_EQ(ParseJob(with("{teeth: 2, material: 1.4404}"), "f.yaml").cutting->material, "1.4404");
  const std::string wrong = problem("{teeth: 2, material: 6O61}");
  EXPECT_TRUE(wrong.starts_with("f.yaml:16:33: process.cutting.material: given 6O61; allowed: 5A06, AlMg, "))
      << wrong;
  EXPECT_TRUE(wrong.ends_with("; nearest: 6061")) << wrong;
  EXPECT_NE(problem("{teeth: 2, material: GFRP}").find("f.yaml:16:33: process.cutting.material: given GFRP"),
            std::string::npos);
  EXPECT_EQ(problem("{teeth: 2, material: GFRP, kc11_N_mm2: 300}"), "");
  EXPECT_NE(problem("{teeth: 2, material: true}"), "");
}

TEST(BrokenYaml, AllProblemsAreToldInTheOrderOfTheText) {
  std::string text = kJob;
  for (const Slip& slip : {Slip{"stepover_mm: 8", "stepver_mm: 8"},
                           {"unit: mm", "unit: yard"},
                           {"feed_mm_min: 80", "feed_mm_min: x"},
                           {"5, 5]", "0, 5]"}})
    text = Slipped(text, slip);
  try {
    ParseJob(text, "f.yaml");
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 5u) << error.what();
    for (size_t i = 1; i < error.problems().size(); ++i)
      EXPECT_LE(error.problems()[i - 1].place.line, error.problems()[i].place.line);
  }
}

TEST(BrokenYaml, ColumnsCountCharacters) {
  try {
    ParseJob("{millpose_job: 1, name: \"\u00e4\u00f6\u00fc\", seed: x}", "f.yaml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("f.yaml:1:38: seed: given x"), std::string::npos)
        << error.what();
  }
}

TEST(BrokenYaml, WhatAControllerCannotFollowIsNamedWithItsLine) {
  const std::string cell = kCell;
  const int line = 1 + static_cast<int>(std::ranges::count(cell, '\n'));
  const std::array<std::pair<const char*, const char*>, 22> slips = {{
      {"  sinumerik: {orientation_words: {names: [A2, B2, C2], group: orirpy}, stat_a5_positive: false}\n",
       "controllers.sinumerik: settable_frame is missing"},
      {"  sinumerik: {settable_frame: 505, stat_a5_positive: false}\n",
       "controllers.sinumerik: orientation_words is missing: {names: "},
      {"  sinumerik: {settable_frame: 505, orientation_words: {names: [A2, B2, C2], group: orirpy}}\n",
       "controllers.sinumerik: stat_a5_positive is missing: true where"},
      {"  sinumerik: {FULL, rotation: rpy}\n",
       "controllers.sinumerik.rotation: is no longer a key: give orientation_words: {names: [A2, B2, C2]"},
      {"  sinumerik: {settable_frame: 505, orientation_words: {names: [A2, X, C2], group: orirpy}}\n",
       "controllers.sinumerik.orientation_words.names: given 'X'; allowed: a word that means nothing else"},
      {"  krl: {ori_ipo_with_g_code: true}\n",
       "controllers.krl.ori_ipo_with_g_code: krl programs do not know this"},
      {"  sinumerik: {FULL, base_number: 2}\n",
       "controllers.sinumerik.base_number: sinumerik programs do not know this"},
      {"  krl: {motion: spline}\n", "controllers.krl.motion: is no longer a key: KRL cuts are LIN"},
      {"  krl: {external_axes: [1500]}\n",
       "controllers.krl.external_axes: given 1500: is no longer a list of numbers; give {name: E1, "
       "constant_mm: 1500}"},
      {"  krl: {external_axes: [{name: E1, constant_mm: 1, coupled: true}], ersysroot: {pose: {}, axis: "
       "1}}\n",
       "controllers.krl.ersysroot.axis: is no longer a key: give coupled: true in external_axes"},
      {"  krl: {external_axes: [{name: E1, constant_mm: 1}], ersysroot: {pose: {}}}\n",
       "controllers.krl.ersysroot: none of external_axes is coupled"},
      {"  krl: {external_axes: [{name: E1, axis: rail}]}\n",
       "controllers.krl.external_axes[0].coupled: missing; required with axis"},
      {"  krl: {external_axes: [{name: E1, axis: rail, coupled: true, constant_mm: 4}]}\n",
       "controllers.krl.external_axes[0]: given 2 of axis, constant_mm and constant_deg; allowed: one"},
      {"  krl: {external_axes: [{name: E1, constant_mm: 1}, {name: E1, constant_mm: 2}]}\n",
       "controllers.krl.external_axes[1].name: given 'E1' twice; allowed: once"},
      {"  sinumerik: {FULL, external_axes: [{name: 7th, axis: rail, coupled: false}]}\n",
       "controllers.sinumerik.external_axes[0].name: given '7th'; allowed: letters"},
      {"  sinumerik: {FULL, robroot: {}}\n",
       "controllers.sinumerik.robroot: sinumerik programs do not know this"},
      {"  linuxcnc: {external_axes: [{name: U, axis: rail, coupled: false, constant_mm: 4}]}\n",
       "controllers.linuxcnc.external_axes[0].constant_mm: linuxcnc programs do not know this; allowed for: "
       "krl"},
      {"  krl: {rotation: euler}\n",
       "controllers.krl.rotation: krl programs do not know this; allowed for: linuxcnc"},
      {"  krl: {coordinates: cartesian}\n", "controllers.krl.coordinates: krl programs do not know this"},
      {"  linuxcnc: {outputs: [{number: 1, at: cut_end, set: true, delay_ms: 5}]}\n",
       "controllers.linuxcnc.outputs[0].delay_ms: linuxcnc programs do not know this; allowed for: krl"},
      {"  sinumerik: {FULL, texts: {joints_on: M5}}\n",
       "controllers.sinumerik.texts.joints_on: sinumerik programs"},
      {"  krl: {texts: {header: \"; gr\u00fcn\"}}\n",
       "controllers.krl.texts.header: programs are plain ASCII"},
  }};
  // What a section must have.
  const std::string full =
      "settable_frame: 505, orientation_words: {names: [A2, B2, C2], group: orirpy}, stat_a5_positive: false";
  for (const auto& [slip, message] : slips) {
    std::string text = slip;
    if (const size_t at = text.find("FULL"); at != std::string::npos) text.replace(at, 4, full);
    try {
      ParseCell(cell + "controllers:\n" + text, "f.yaml");
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      ASSERT_EQ(error.problems().size(), 1u) << error.what();
      EXPECT_EQ(error.problems()[0].place.line, line + 1) << error.what();
      EXPECT_TRUE(error.problems()[0].message.starts_with(message)) << error.what();
    }
  }
}

TEST(BrokenYaml, WhatIsNoMapIsRefused) {
  for (const char* text :
       {"", "text", "[1, 2]", "---\n", "# only a comment\n", ": 1", "? [a]\n: 1", "{[a]: 1}"})
    EXPECT_THROW(ParseJob(text, "f.yaml"), InputError) << text;
}

TEST(BrokenYaml, DeepNestingBombsAndCyclesAreRefused) {
  std::string bomb = "a: &a [x, x]\n";
  for (int i = 0; i < 30; ++i)
    bomb += fmt::format("{0}: &{0} [*{1}, *{1}]\n", static_cast<char>('b' + i % 20),
                        static_cast<char>('a' + i % 20));
  for (const std::string& text : {bomb, std::string("a: &a [*a]"), std::string(100000, '['),
                                  std::string(100000, '{'), std::string(5 << 20, ' ')})
    EXPECT_THROW(ParseJob(text, "f.yaml"), InputError) << text.substr(0, 20);
}

// A job may name any file of the system as its cell: what the message repeats of it is a few words.
TEST(BrokenYaml, OfAForeignFileOnlyAFewWordsAreRepeated) {
  std::string secret;
  for (int i = 0; i < 100; ++i) secret += fmt::format("secret word {} of a foreign file ", i);
  std::string lines;
  for (int i = 0; i < 300; ++i) lines += fmt::format("key{}: {}\n", i, secret);
  for (const std::string& text : {secret, "name: " + secret, secret + ": 1", "name: !" + secret, lines,
                                  "seed: " + secret, "\"" + secret + "\": {\"" + secret + "\": 1}"}) {
    try {
      ParseCell(text, "f.yaml");
      ADD_FAILURE() << text.substr(0, 20);
    } catch (const InputError& error) {
      EXPECT_LE(error.problems().size(), kMostProblems + 1);
      for (const Problem& problem : error.problems()) {
        EXPECT_EQ(problem.message.find("word 9"), std::string::npos) << problem.message;
      }
    }
  }
}

// Quadratic in their number once: minutes.
TEST(BrokenYaml, ManyUnknownKeysAreToldQuickly) {
  std::string text = kJob;
  for (int i = 0; i < 240000; ++i) text += fmt::format("k{}: 1\n", i);
  const std::clock_t start = std::clock();
  EXPECT_THROW(ParseJob(text, "f.yaml"), InputError);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5.0);
}

// Columns were counted from the line's begin for every value: 200,000 in one line took 36 s.
TEST(BrokenYaml, ALongListCostsInProportion) {
  constexpr size_t kCount = 200000;
  std::string list = "[";
  for (size_t i = 0; i < kCount; ++i) list += "1,";
  list.back() = ']';
  const std::clock_t start = std::clock();
  EXPECT_EQ(yaml::ReadYaml(list, "x.yaml").items.size(), kCount);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5.0);
}

TEST(BrokenYaml, ColumnsAfterALongLineAreThoseOfCharacters) {
  std::string list = "[";
  for (int i = 0; i < 3000; ++i) list += "ü, ";
  const auto place = [&](const std::string& text) {
    try {
      yaml::ReadYaml(text, "x.yaml");
    } catch (const InputError& error) {
      return error.problems().at(0).place;
    }
    return SourceLocation{};
  };
  EXPECT_EQ(place(list + "*a]").column, 1 + 3 * 3000 + 1);
  EXPECT_EQ(place(list + "x,\n ü, *a]").line, 2);
  EXPECT_EQ(place(list + "x,\n ü, *a]").column, 5);
}

TEST(BrokenYaml, TooLargeFilesAreRefusedWhereTheyBecomeSo) {
  const auto told = [](const std::string& text) -> std::string {
    try {
      yaml::ReadYaml(text, "x.yaml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  const std::string line(99, '#');
  std::string large;
  while (large.size() <= (size_t{4} << 20)) large += line + '\n';
  EXPECT_EQ(told(large),
            "x.yaml:41944:5: the file has 4194400 bytes; allowed: at most 4194304, which end here");
  std::string many = "[";
  for (int i = 0; i < 250000; ++i) many += "1,2,\n";
  EXPECT_EQ(told(many + "3]"), "x.yaml:250000:3: more than 500000 keys and values; allowed: at most as many");
}

TEST(BrokenYaml, ControlCharactersInTextsAreRefused) {
  const auto told = [](const std::string& text) -> std::string {
    try {
      ParseJob(text, "x.yaml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  std::string job = kJob;
  job.replace(job.find("cell: cell.yaml"), 15, R"(cell: "a\e[31mb")");
  EXPECT_EQ(told(job),
            "x.yaml:3:7: cell: given the text \"a?[31mb\"; allowed: text of one line without control "
            "characters");
}

TEST(BrokenYaml, TheNameOfAJobOfSeveralOperationsIsReadAsGiven) {
  std::string job = kJob;
  job.replace(job.find("name: part"), 10, "name: \"\"");
  job += "operations: [{name: first}, {name: second}]\n";
  const std::string told = [&]() -> std::string {
    try {
      OutlineOf(job, "x.yaml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  }();
  EXPECT_EQ(told.substr(0, 41), "x.yaml:2:7: name: given the text \"\"; allo");
}

TEST(BrokenYaml, WindowsLineEndsAndByteOrderMarksAreRead) {
  std::string text = "\xef\xbb\xbf";
  for (const char c : std::string(kJob)) text += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(ParseJob(text, "f.yaml").name, "part");
}

TEST(BrokenYaml, AFileOfAnotherKindIsToldAsSuch) {
  const auto told = [](const auto& parse) -> std::string {
    try {
      parse();
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_EQ(told([] { ParseJob(kCell, "x.yaml"); }),
            "x.yaml:1:1: this is a cell file; a job file is expected here");
  EXPECT_EQ(told([] { ParseCell(kJob, "x.yaml"); }),
            "x.yaml:1:1: this is a job file; a cell file is expected here");
  EXPECT_EQ(told([] { ParseJob("# all parts\nmillpose_batch: 1\n", "x.yaml"); }),
            "x.yaml:2:1: this is a batch file; a job file is expected here");
  EXPECT_EQ(told([] { ParseJob(std::string("\xff\xfem\0", 4), "x.yaml"); }),
            "x.yaml:1:1: the text is in UTF-16; allowed: UTF-8");
}

}  // namespace millpose
