// SPDX-License-Identifier: GPL-3.0-or-later
// Stages whose results are kept are handed no more than they read: what they do not depend on does not make
// them run again, and what they depend on does.
#include "job/narrow_inputs.hpp"

#include "run/pipeline/programs/make_programs.hpp"
#include "run/pipeline/programs/start_programs.hpp"
#include "run/pipeline/stages/lay_path.hpp"
#include "store/cached_pass.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

std::string PathKey(const std::vector<Override>& more) { return InputsOfToolpath(SmallInputs(more)).hash; }
std::string ProgramKey(const std::vector<Override>& more) {
  return InputsOfProgram(SmallInputs(more), "linuxcnc").hash;
}

TEST(InputsOfToolpath, WhatThePathDependsOnCounts) {
  const std::string key = PathKey({});
  for (const Override& change :
       {Override{"toolpath.spacing_mm", "20"}, Override{"toolpath.direction", "one_way"},
        Override{"toolpath.lead_deg", "1"}, Override{"workpiece.pose.xyz_mm", "[2077, 0, 1006]"},
        Override{"process.feed_mm_min", "81"}, Override{"process.spindle_rpm", "7001"},
        Override{"process.cutting.teeth", "3"}, Override{"toolpath.gouges", "{action: report}"}})
    EXPECT_NE(PathKey({change}), key) << change.path;
}

TEST(InputsOfToolpath, WhatComesAfterThePathDoesNot) {
  const std::string key = PathKey({});
  for (const Override& change :
       {Override{"name", "other"}, Override{"seed", "2"}, Override{"programs", "[krl]"},
        Override{"pose.objective", "{name: chen2021}"}, Override{"limits.margin_deg", "2"},
        Override{"path.rotation_step_deg", "2"}, Override{"gaps.retract_mm", "40"},
        Override{"interference.swept_resolution_mm", "0.4"},
        Override{"process.force_uncertainty_percent", "5"},
        Override{"program_options.path_tolerance_mm", "0.03"}})
    EXPECT_EQ(PathKey({change}), key) << change.path;
}

TEST(InputsOfProgram, WhatAProgramIsWrittenByCounts) {
  const std::string key = ProgramKey({});
  for (const Override& change :
       {Override{"program_options.path_tolerance_mm", "0.03"}, Override{"program_options.date", "2026-01-01"},
        Override{"program_options.dry_run_offset_mm", "5"}, Override{"gaps.speed_share", "0.4"},
        Override{"process.retract_feed_mm_min", "2000"}, Override{"name", "other"}})
    EXPECT_NE(ProgramKey({change}), key) << change.path;
}

TEST(InputsOfProgram, OtherControllersAndWhatReportsSayDoNot) {
  const std::string key = ProgramKey({});
  for (const Override& change :
       {Override{"programs", "[linuxcnc, krl]"}, Override{"process.min_feed_share", "0.4"},
        Override{"pose.exhaustive_step_deg", "0.1"}})
    EXPECT_EQ(ProgramKey({change}), key) << change.path;
  JobInputs inputs = SmallInputs();
  inputs.cell.tool.tip_uncertainty = 0.01;
  EXPECT_EQ(InputsOfProgram(inputs, "linuxcnc").hash, key);
  inputs.cell.controllers.erase("krl");
  EXPECT_EQ(InputsOfProgram(inputs, "linuxcnc").hash, key);
}

TEST(WithoutPlaces, ForgetsWhereObstaclesStandAndNothingElse) {
  JobInputs inputs = SmallInputs();
  BodySettings& post = inputs.cell.bodies.emplace_back();
  post.name = "post";
  post.body_class = BodyClass::kFixture;
  const auto key = [&] { return WithoutPlaces(inputs).hash; };
  const std::string before = key();
  EXPECT_EQ(before, HashOf(WithoutPlaces(inputs)));
  inputs.cell.bodies.back().pose.position.x() = 100;
  inputs.cell.bodies.back().shape.size.setConstant(50);
  EXPECT_EQ(key(), before);
  for (const auto& change : std::vector<std::function<void(BodySettings&)>>{
           [](BodySettings& body) { body.name = "other"; },
           [](BodySettings& body) { body.mount.mount = Mount::kWorkpiece; },
           [](BodySettings& body) { body.body_class = BodyClass::kLink; },
           [](BodySettings& body) {
             body.mount = {Mount::kLink, 3};
           }}) {
    JobInputs changed = inputs;
    change(changed.cell.bodies.back());
    EXPECT_NE(WithoutPlaces(changed).hash, before);
    changed.hash = WithoutPlaces(changed).hash;
    changed.cell.bodies.back().pose.position.y() = 1;
    const bool still =
        IsObstacle(changed.cell.bodies.back().body_class, changed.cell.bodies.back().mount.mount);
    EXPECT_EQ(WithoutPlaces(changed).hash == changed.hash, still) << "what moves with the arm counts";
  }
}

TEST(NameInputs, ChangesTheLineOfTheHeadAlone) {
  ProgramFiles files{{"a.src", "; inputs: aaaa\nPTP aaaa\n"}, {"c.dat", "aaaa"}};
  NameInputs("aaaa", "bbbb", files);
  EXPECT_EQ(files["a.src"], "; inputs: bbbb\nPTP aaaa\n");
  EXPECT_EQ(files["c.dat"], "aaaa");
}

// The narrowed inputs are enough: stages make of them what they make of all.
TEST(InputsOfToolpath, LayTheSamePath) {
  const JobInputs inputs = SmallInputs();
  const Mesh& mesh = FreshPlan().prepared.surface.mesh;
  const LayingInputs narrow = MakeLayingInputs(inputs, mesh);
  const LayingInputs all{inputs, mesh, "all"};
  const Toolpath a = LayPath(narrow, NoCheckpoints(), {.threads = 1}).made.toolpath,
                 b = LayPath(all, NoCheckpoints(), {.threads = 1}).made.toolpath;
  ASSERT_EQ(a.passes.size(), b.passes.size());
  for (size_t p = 0; p < a.passes.size(); ++p) {
    ASSERT_EQ(a.passes[p].points.size(), b.passes[p].points.size());
    for (size_t i = 0; i < a.passes[p].points.size(); ++i) {
      EXPECT_EQ(a.passes[p].points[i].position, b.passes[p].points[i].position);
      EXPECT_EQ(a.passes[p].points[i].feed_rate, b.passes[p].points[i].feed_rate);
      EXPECT_EQ(a.passes[p].points[i].engagement.force, b.passes[p].points[i].engagement.force);
    }
  }
}

TEST(InputsOfProgram, MakeTheSameProgramButForTheirName) {
  const PlannedJob& job = FreshPlan();
  const JobInputs all = SmallInputs(), narrow = InputsOfProgram(all, "linuxcnc");
  const auto text = [&](JobInputs inputs) {
    inputs.hash = "named";
    const Programming with(inputs, "linuxcnc", job.prepared.world, {.threads = 2});
    const CheckedProgram program = MakeProgram(job.plan, {}, job.programs.base_window, with);
    EXPECT_TRUE(program.Confirmed()) << program.WhyWithheld();
    std::string whole;
    for (const auto& [name, bytes] : program.files) whole += name + bytes;
    for (const StartProgram& start : MakeStartPrograms(job.plan, job.starts.ways, {}, with))
      for (const auto& [name, bytes] : start.files) whole += name + bytes;
    return whole;
  };
  EXPECT_EQ(text(narrow), text(all));
}

}  // namespace
}  // namespace millpose::test
