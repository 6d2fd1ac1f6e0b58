// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "job/config/config.hpp"
#include "program/krl/krl.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "program/sinumerik/sinumerik.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/program/own_options.hpp"

namespace millpose {
namespace {

std::vector<std::filesystem::path> Yamls(const std::string& folder, const std::string& first_key) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(SourceDir()) / folder))
    if (entry.path().extension() == ".yaml" &&
        ReadFile(entry.path()).find(first_key + ": 1") != std::string::npos)
      files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

constexpr const char* kCellWithEverything = R"(
millpose_cell: 1
name: "12 #: odd, name"
arm:
  name: arm
  lengths_mm: {d1: 1, a1: 0.1, a2: 1e-3, d4: 7, dz: -5.5, d6: 3}
  axis_signs: [-1, 1, 1, -1, 1, -1]
  zero_offsets_deg: [1, 2, 3, 4, 5, 0.7]
  limits_deg: [[-185, 185], [-130, 20], [-100, 144], [-350, 350], [-120, 120], [-350, 350.1]]
  speeds_deg_s: [80, 75, 70, 70.5, 70.5, 109.7]
  accelerations_deg_s2: [200, 200, 200, 300, 300, 500]
  accelerations_assumed: false
  joint_stiffness_Nm_per_rad: [8.9e6, 6.78e6, 1.13e7, 2.01e6, 1.65e6, 1.35e6]
home_deg: [0, -90, 90, 0, 0, 0]
tool:
  name: tool
  tip_in_flange_mm: [-250, 0, 250]
  axis_in_flange: [1, 2, 3]
  x_in_flange: [0.1, 0, 1]
  cutter: {shape: bull, diameter_mm: 20, cutting_length_mm: 40, corner_radius_mm: 2}
  stack: [{name: cutter, class: cutter, length_mm: 60, diameter_mm: 20, top_diameter_mm: 30}]
  load: {mass_kg: 182.5, centre_in_flange_mm: [0, 5, 140], inertia_kg_m2: [9, 11, 4.5]}
bodies:
  - {name: a, class: link, mount: link3, shape: {capsule: {diameter_mm: 9, length_mm: 600}}}
  - {name: b, class: fixture, mount: workpiece, shape: {sphere: {diameter_mm: 9}}, pose: {abc_deg: [1, 2, 3]}}
  - {name: c, class: fixture, mount: tool, shape: {cone: {diameter_mm: 9, top_diameter_mm: 1, length_mm: 6}}}
  - {name: d, class: fixture, mount: base, shape: {mesh: {file: "a: b.stl", unit: in}}}
  - {name: e, class: fixture, mount: world, shape: {convex: {points_mm: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.1]]}}}
external_axes: [{name: table, kind: rotary, carries: workpiece, axis: [0, 0, 1], origin_mm: [1, 2, 3], limits_deg: [-30, 30], speed_deg_s: 10, acceleration_deg_s2: 20}]
reproduction_only: true
controllers:
  krl:
    tool_axis: x
    texts: {spindle_on: "$OUT[1]=TRUE\nWAIT SEC 2\n", footer: "true"}
    calls: [{name: WASH, moves: false}, {name: PARK, moves: true, from_deg: [1, 2, 3, 4, 5, 6], to_deg: [0, 0, 0, 0, 0, 0.1]}]
    path_acceleration_m_s2: 1.5
    robroot: {xyz_mm: [50, 0, 120], abc_deg: [90, 0, 0]}
    external_axes: [{name: E1, constant_deg: 10}, {name: E3, constant_mm: 1500, coupled: true}, {name: E2, axis: table, coupled: true}]
    ersysroot: {pose: {xyz_mm: [0, -200, 300]}, direction: -y}
    external_base: {machine_def: 2, root: {xyz_mm: [1, 2, 3]}, flange: {xyz_mm: [0, 0, 40]}}
    write_load: true
    tool_direction: z
    block_time_ms: 8
    program_memory_kbytes: 8000
    outputs: [{number: 3, at: cut_begin, set: true, delay_ms: -20}, {number: 3, at: cut_end, set: false}]
  sinumerik: {settable_frame: 507, orientation_words: {names: [RX, RY, RZ], group: orirpy2}, stat_a5_positive: true}
  linuxcnc: {coordinates: cartesian, rotation: euler, outputs: [{number: 0, at: cut_end, set: true}]}
)";

}  // namespace

TEST(RoundTrip, EveryJobOfTheProjectReadsBackToTheSame) {
  const auto files = Yamls("toolpaths", "millpose_job");
  ASSERT_FALSE(files.empty());
  std::vector<std::pair<std::filesystem::path, std::optional<size_t>>> jobs;  // each operation by itself
  for (const auto& file : files) {
    const size_t operations = OutlineOf(ReadFile(file), file.string()).operations.size();
    if (operations == 0) jobs.emplace_back(file, std::nullopt);
    for (size_t i = 0; i < operations; ++i) jobs.emplace_back(file, i);
  }
  for (const auto& [file, operation] : jobs) {
    const JobSettings job = ParseJob(ReadFile(file), file.string(), {}, operation);
    const std::string written = WriteJob(job);
    const JobSettings again = ParseJob(written, "written");
    EXPECT_EQ(WriteJob(again), written) << file;
    EXPECT_EQ(again.feed, job.feed);
    EXPECT_EQ(again.workpiece.pose.abc, job.workpiece.pose.abc);
    EXPECT_EQ(again.limit_margin, job.limit_margin);
    EXPECT_EQ(again.toolpath.region.facing, job.toolpath.region.facing);
    EXPECT_EQ(again.objective_parameters, job.objective_parameters);
    EXPECT_EQ(again.path.steps.most, job.path.steps.most);
    EXPECT_EQ(again.path.steps.per_mm, job.path.steps.per_mm);
    EXPECT_EQ(again.path.steps.speed_share, job.path.steps.speed_share);
  }
}

TEST(RoundTrip, EveryCellOfTheProjectReadsBackToTheSame) {
  const auto files = Yamls("cells", "millpose_cell");
  ASSERT_FALSE(files.empty());
  for (const auto& file : files) {
    const CellSettings cell = ParseCell(ReadFile(file), file.string());
    const std::string written = WriteCell(cell);
    const CellSettings again = ParseCell(written, "written");
    EXPECT_EQ(WriteCell(again), written) << file;
    EXPECT_EQ(again.arm.lower, cell.arm.lower);
    EXPECT_EQ(again.arm.speed, cell.arm.speed);
    EXPECT_EQ(again.arm.stiffness, cell.arm.stiffness);
    EXPECT_EQ(again.tool.axis, cell.tool.axis);
    EXPECT_EQ(again.controllers.size(), cell.controllers.size());
  }
}

TEST(RoundTrip, EveryConditionOfARegionSurvives) {
  const std::filesystem::path file = std::filesystem::path(SourceDir()) / "toolpaths/support_pad/job.yaml";
  std::string text = ReadFile(file);
  const std::string given = "region: {facing: {direction: [0, 0, 1], within_deg: 1}}";
  ASSERT_NE(text.find(given), std::string::npos);
  text.replace(text.find(given), given.size(), R"(region:
    half_space: {point_mm: [1, 2, 3], normal: [0, 0.6, 0.8]}
    connected: {seed_mm: [4, 5, 6], crease_deg: 15}
    all: [{facing: {direction: [1, 0, 0], within_deg: 7}}]
    any:
      - {box: {lower_mm: [0, 0, 0], upper_mm: [1, 1, 1]}}
      - {polygon: {points_mm: [[0, 0, 0], [1, 0, 0], [0, 1.5, 0]], direction: [0, 0, 1]}}
    none: [{connected: {seed_mm: [7, 8, 9]}}]
    rim_distance_mm: 2.5)");
  const std::string written = WriteJob(ParseJob(text, "job"));
  const RegionOptions region = ParseJob(written, "written").toolpath.region;
  EXPECT_EQ(WriteJob(ParseJob(written, "written")), written);
  EXPECT_EQ(region.half_space->normal, Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_EQ(region.connected->crease, DegToRad(15));
  EXPECT_EQ(region.all.at(0).facing_within, DegToRad(7));
  ASSERT_EQ(region.any.size(), 2u);
  EXPECT_EQ(region.any[0].box->upper, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(region.any[1].polygon->points.at(2).y(), 1.5);
  EXPECT_EQ(region.none.at(0).connected->seed, Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(region.rim_distance, 2.5);
}

// What `millpose register` writes: every bit, and what is no covariance or of another pose is refused.
TEST(RoundTrip, ARegisteredPlaceSurvives) {
  const std::filesystem::path file = std::filesystem::path(SourceDir()) / "toolpaths/support_pad/job.yaml";
  const std::string text = ReadFile(file),
                    pose = "{xyz_mm: [2076.1234, 0.3, 1006], abc_deg: [0.1234567, -90, 0]}";
  const auto with = [&](const std::string& of, const std::string& numbers) {
    std::string job = text;
    const std::string given = "pose: {xyz_mm: [2076, 0, 1006], abc_deg: [0, -90, 0]}";
    job.replace(
        job.find(given), given.size(),
        fmt::format(
            "pose: {}\n  registration: {{tolerance_mm: 0.15}}\n  registered: {{pose: {}, centre_mm: [1.5, "
            "-2, 3], covariance_mm_mrad: [{}]}}",
            pose, of, numbers));
    return job;
  };
  const std::string numbers =
      "0.01, 0.0012, 0.0225, 0, 0, 0.04, 1e-3, 0, 0, 0.0123457, 0, 2e-3, 0, 0, 0.3, 0, 0, -0.1, 0, 0, 0.7";
  const std::string written = WriteJob(ParseJob(with(pose, numbers), "job"));
  const JobSettings again = ParseJob(written, "written");
  EXPECT_EQ(WriteJob(again), written);
  ASSERT_TRUE(again.workpiece.registered);
  EXPECT_EQ(again.workpiece.registration_tolerance, 0.15);
  const Eigen::Matrix<double, 6, 6>& covariance = again.workpiece.registered->covariance;
  EXPECT_EQ(covariance(1, 0), 0.0012);
  EXPECT_DOUBLE_EQ(covariance(0, 3), 1e-6);
  EXPECT_DOUBLE_EQ(covariance(5, 5), 0.7e-6);
  EXPECT_EQ(again.workpiece.registered->centre, Eigen::Vector3d(1.5, -2, 3));
  const auto refusal = [&](const std::string& of, const std::string& given) -> std::string {
    try {
      ParseJob(with(of, given), "job");
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_NE(refusal("{xyz_mm: [2076, 0, 1006], abc_deg: [0, -90, 0]}", numbers)
                .find("job:13:3: workpiece.registered: is of another pose than workpiece.pose"),
            std::string::npos);
  std::string wrong = numbers;
  wrong.replace(wrong.find("0.0012"), 6, "0.02");
  EXPECT_NE(refusal(pose, wrong).find("is no covariance: row 2, column 1"), std::string::npos);
  EXPECT_NE(refusal(pose, "1, 2, 3").find("allowed: a list of 21 numbers"), std::string::npos);
}

// Of a bent part: modes by name in their order, the covariance's further rows with turns in mrad.
TEST(RoundTrip, ABentPartSurvives) {
  const std::filesystem::path file = std::filesystem::path(SourceDir()) / "toolpaths/support_pad/job.yaml";
  const std::string pose = "{xyz_mm: [2076, 0, 1006], abc_deg: [0, -90, 0]}";
  std::string rows;
  for (int i = 6; i < 9; ++i)
    for (int j = 0; j <= i; ++j)
      rows += fmt::format("{}{}", rows.empty() ? "" : ", ", i == j ? 0.01 * i : j == 4 ? 0.002 : 0);
  const auto job = [&](const std::string& modes, const std::string& numbers) {
    std::string text = ReadFile(file);
    text.replace(
        text.find("pose: " + pose), 6 + pose.size(),
        fmt::format(
            "pose: {0}\n  registration: {{max_bending_mm: 1}}\n  registered: {{pose: {0}, centre_mm: [0, "
            "0, 0], covariance_mm_mrad: [1, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1], "
            "bending: {{origin_mm: [1, 2, 3], u_mm: [40, 0, 0], v_mm: [0, 30, 0], modes_mm: {{{1}}}, "
            "covariance_mm_mrad: [{2}]}}}}",
            pose, modes, numbers));
    return text;
  };
  const std::string written = WriteJob(ParseJob(job("v2: 0.3, u2: -0.1, uv: 0.2", rows), "job"));
  const JobSettings again = ParseJob(written, "written");
  EXPECT_EQ(WriteJob(again), written);
  EXPECT_EQ(again.workpiece.max_bending, 1);
  ASSERT_TRUE(again.workpiece.registered && again.workpiece.registered->bending);
  const RegisteredSettings& registered = *again.workpiece.registered;
  EXPECT_EQ(registered.bending->shape.modes, (std::vector<double>{-0.1, 0.2, 0.3}));
  EXPECT_EQ(registered.bending->shape.v, Eigen::Vector3d(0, 30, 0));
  const ProbeMatrix whole = registered.WholeCovariance();
  ASSERT_EQ(whole.rows(), 9);
  EXPECT_DOUBLE_EQ(whole(3, 3), 1e-6);
  EXPECT_DOUBLE_EQ(whole(7, 4), 2e-6);
  EXPECT_DOUBLE_EQ(whole(4, 8), 2e-6);
  EXPECT_DOUBLE_EQ(whole(8, 8), 0.08);
  const auto refusal = [&](const std::string& modes, const std::string& numbers) -> std::string {
    try {
      ParseJob(job(modes, numbers), "job");
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_NE(refusal("u2: 1, uv: 1, v2: 1, u2v: 1", rows).find("needs the first three or more of u2, uv, v2"),
            std::string::npos);
  EXPECT_NE(refusal("u2: 1, uv: 1, v2: 1, u3: 1", rows).find("needs 34 numbers for 4 modes, given 24"),
            std::string::npos);
  EXPECT_NE(refusal("u2: 1, uv: 1, v2: 1, v3: 1", rows).find("v3"), std::string::npos);
  std::string wrong = rows;
  wrong.replace(wrong.find("0.002"), 5, "0.9");
  EXPECT_NE(refusal("u2: 1, uv: 1, v2: 1", wrong).find("bending: is no covariance: row 7, column 5"),
            std::string::npos);
}

TEST(RoundTrip, EveryKindOfKeySurvives) {
  const CellSettings cell = ParseCell(kCellWithEverything, "cell");
  const std::string written = WriteCell(cell);
  const CellSettings again = ParseCell(written, "written");
  EXPECT_EQ(WriteCell(again), written);
  EXPECT_EQ(again.name, "12 #: odd, name");
  EXPECT_EQ(again.arm.offset, cell.arm.offset);
  EXPECT_EQ(again.tool.axis, cell.tool.axis);
  EXPECT_EQ(again.tool.x, cell.tool.x);
  EXPECT_EQ(again.tool.stack.at(0).top_diameter, 30);
  ASSERT_EQ(again.bodies.size(), 5u);
  EXPECT_EQ(again.bodies[0].shape.kind, ShapeKind::kCapsule);
  EXPECT_EQ(again.bodies[1].pose.abc, cell.bodies[1].pose.abc);
  EXPECT_EQ(again.bodies[3].shape.unit, 25.4);
  EXPECT_EQ(again.bodies[3].shape.mesh_file, "a: b.stl");
  EXPECT_EQ(again.bodies[4].shape.points, cell.bodies[4].shape.points);
  EXPECT_FALSE(again.programs_allowed);
  EXPECT_FALSE(again.arm.acceleration_assumed);
  EXPECT_EQ(again.controllers.at("krl").shared.texts, cell.controllers.at("krl").shared.texts);
  EXPECT_EQ(again.controllers.at("krl").shared.texts.at("spindle_on"), "$OUT[1]=TRUE\nWAIT SEC 2\n");
}

TEST(RoundTrip, WhatProgramsAreMadeOfSurvives) {
  const std::string written = WriteCell(ParseCell(kCellWithEverything, "cell"));
  const CellSettings cell = ParseCell(written, "written");
  const PostOptions& shared = cell.controllers.at("krl").shared;
  const KrlOptions krl = OwnOptions<KrlPost>(cell.controllers.at("krl"));
  EXPECT_EQ(shared.path_acceleration, 1500);
  EXPECT_EQ(krl.robroot->position, Eigen::Vector3d(50, 0, 120));
  EXPECT_EQ(krl.ersysroot->pose.position, Eigen::Vector3d(0, -200, 300));
  EXPECT_EQ(krl.ersysroot->direction, FrameAxis::kMinusY);
  ASSERT_EQ(shared.controller_axes.size(), 3u);
  EXPECT_EQ(shared.controller_axes[0].kind, AxisKind::kRotary);
  EXPECT_EQ(shared.controller_axes[0].constant, 10);
  EXPECT_TRUE(shared.controller_axes[1].coupled);
  EXPECT_EQ(shared.controller_axes[2].axis, "table");
  EXPECT_EQ(krl.external_base->machine_def, 2);
  EXPECT_EQ(krl.external_base->flange.position, Eigen::Vector3d(0, 0, 40));
  EXPECT_EQ(krl.tool_direction, FrameAxis::kZ);
  EXPECT_EQ(shared.block_time, 0.008);
  EXPECT_EQ(krl.memory_kbytes, 8000);
  EXPECT_EQ(krl.write_load, true);
  EXPECT_EQ(cell.tool.load->mass, 182.5);
  EXPECT_EQ(cell.tool.load->inertia, Eigen::Vector3d(9, 11, 4.5));
  ASSERT_EQ(shared.outputs.size(), 2u);
  EXPECT_EQ(shared.outputs[0].delay, -0.02);
  EXPECT_FALSE(shared.outputs[1].on);
  ASSERT_EQ(shared.calls.size(), 2u);
  EXPECT_FALSE(shared.calls[0].moves);
  EXPECT_DOUBLE_EQ(shared.calls[1].to[5], DegToRad(0.1));
  EXPECT_TRUE(OwnOptions<LinuxCncPost>(cell.controllers.at("linuxcnc")).cartesian);
  EXPECT_EQ(cell.controllers.at("linuxcnc").shared.rotation, AngleOrder::kEuler);
  const SinumerikOptions sinumerik = OwnOptions<SinumerikPost>(cell.controllers.at("sinumerik"));
  EXPECT_EQ(sinumerik.Words(), (std::array<std::string, 3>{"RX", "RY", "RZ"}));
  EXPECT_EQ(sinumerik.stat_a5_positive, true);
  EXPECT_EQ(cell.controllers.at("sinumerik").shared.rotation, AngleOrder::kRpy2);
  std::string text = ReadFile(std::filesystem::path(SourceDir()) / "toolpaths/support_pad/job.yaml");
  text +=
      "program_options: {path_tolerance_mm: 0.05, point_economy: {chord_mm: 0}, dry_run_offset_mm: 20, date: "
      "today}\n";
  const JobSettings job = ParseJob(WriteJob(ParseJob(text, "job")), "written");
  EXPECT_EQ(job.program_options.path_tolerance, 0.05);
  EXPECT_EQ(job.program_options.chord_tolerance, 0);
  EXPECT_FALSE(job.program_options.angle_tolerance);
  EXPECT_EQ(job.program_options.dry_run_offset, 20);
  EXPECT_EQ(job.program_options.date, "today");
}

TEST(RoundTrip, AKnownForceDecidesUnlessTheJobSays) {
  std::string text = ReadFile(std::filesystem::path(SourceDir()) / "toolpaths/support_pad/job.yaml");
  const auto objective = [&](const std::vector<Override>& overrides) {
    return ParseJob(WriteJob(ParseJob(text, "job", overrides)), "written").objective;
  };
  const size_t at = text.find("  objective: ");
  text.erase(at, text.find('\n', at) + 1 - at);
  EXPECT_EQ(objective({}), "surface_error");
  EXPECT_EQ(objective({{"pose.formulation", "paper"}}), "chen2021");
  EXPECT_EQ(objective({{"pose.objective", "{name: process_force}"}}), "process_force");
  EXPECT_EQ(objective({{"pose.objective", "{expression: 'max(mu, 2*mu)'}"}}), "max(mu, 2*mu)");
  const JobSettings bounded =
      ParseJob(WriteJob(ParseJob(text, "job", {{"process.force_direction_deg", "5"}})), "written");
  EXPECT_EQ(bounded.force_direction_deg, 5);
  EXPECT_EQ(bounded.force_uncertainty_percent, 30);
  const size_t cutting = text.find("  cutting: ");
  text.erase(cutting, text.find('\n', cutting) + 1 - cutting);
  EXPECT_EQ(objective({}), "chen2021");
}

TEST(RoundTrip, NumbersStayShort) {
  const JobSettings job =
      ParseJob(ReadFile(std::filesystem::path(SourceDir()) / "toolpaths/support_pad/job.yaml"), "job");
  const std::string written = WriteJob(job);
  EXPECT_NE(written.find("margin_deg: 3\n"), std::string::npos) << written;
  EXPECT_NE(written.find("max_joint_deg_per_mm: 2\n"), std::string::npos) << written;
  EXPECT_NE(written.find("  feed_mm_min: 80\n  spindle_rpm: 7000\n"), std::string::npos) << written;
}

}  // namespace millpose
