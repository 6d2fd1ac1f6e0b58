// SPDX-License-Identifier: GPL-3.0-or-later
// Jobs whose part stands in several ways, one after the other.
#include "base/error.hpp"
#include "job/config/setup_names.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/replaced.hpp"

namespace millpose {
namespace {

const std::string kTurnedJob = R"(millpose_job: 1
name: block
cell: cell.yaml
tool: mill
workpiece: {mesh: part.stl, unit: mm, frame: world, max_residual_mm: 3}
process: {spindle_rpm: 7000, feed_mm_min: 100}
setups:
  - {name: face, pose: {xyz_mm: [1, 2, 3]}}
  - name: back
    frame: robot_base
    pose: {xyz_mm: [4, 5, 6], abc_deg: [180, 0, 0]}
operations:
  - name: rough
    setup: face
    toolpath: {strategy: parallel_planes, planes: {normal: [0, 1, 0]}, stepover_mm: 8}
  - name: finish
    setup: face
    toolpath: {strategy: parallel_planes, planes: {normal: [1, 0, 0]}, stepover_mm: 2}
  - name: behind
    setup: back
    toolpath: {strategy: parallel_planes, planes: {normal: [1, 0, 0]}, stepover_mm: 2}
programs: [krl]
)";

std::string SetupRefusal(const std::string& from, const std::string& to) {
  return RefusalOf([&] { ParseJob(Replaced(kTurnedJob, from, to), "job.yaml", {}, 0); });
}

TEST(Setups, SayWhereThePartStandsForTheirOperations) {
  for (size_t i = 0; i < 3; ++i) {
    const WorkpieceSettings workpiece = ParseJob(kTurnedJob, "job.yaml", {}, i).workpiece;
    const bool back = i == 2;
    EXPECT_EQ(workpiece.pose.position, back ? Eigen::Vector3d(4, 5, 6) : Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(workpiece.frame, back ? GivenFrame::kRobotBase : GivenFrame::kWorld);
    EXPECT_EQ(workpiece.mesh_file, "part.stl");
    EXPECT_EQ(workpiece.max_residual, 3);
  }
  EXPECT_EQ(SetupNames(kTurnedJob, "job.yaml"), (std::vector<std::string>{"face", "face", "back"}));
  const Override moved = ParseOverride("setups.back.pose.xyz_mm=[7, 8, 9]");
  EXPECT_EQ(ParseJob(kTurnedJob, "job.yaml", {moved}, 2).workpiece.pose.position, Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(ParseJob(kTurnedJob, "job.yaml", {moved}, 0).workpiece.pose.position, Eigen::Vector3d(1, 2, 3));
}

// The tool of the operation before is held on within a setup alone.
TEST(Setups, BeginWithTheirTool) {
  EXPECT_FALSE(ParseJob(kTurnedJob, "job.yaml", {}, 0).tool_held);
  EXPECT_TRUE(ParseJob(kTurnedJob, "job.yaml", {}, 1).tool_held);
  EXPECT_FALSE(ParseJob(kTurnedJob, "job.yaml", {}, 2).tool_held);
}

// A setup's fixtures stand in place of the workpiece's; none given: those; an empty list: none.
TEST(Setups, HaveTheirOwnFixtures) {
  const std::string clamp = "{name: clamp, shape: {sphere: {diameter_mm: 5}}, pose: {xyz_mm: [1, 2, 3]}}";
  const std::string vice =
      "{name: vice, mount: world, shape: {sphere: {diameter_mm: 5}}, pose: {xyz_mm: [7, 8, 9]}}";
  const std::string both = Replaced(kTurnedJob, "unit: mm,", "unit: mm, fixtures: [" + clamp + "],");
  const auto names = [](const std::string& text, size_t operation) {
    std::string all;
    for (const FixtureSettings& one : ParseJob(text, "job.yaml", {}, operation).workpiece.fixtures)
      all += one.name + (one.mount == Mount::kWorld ? " in the world " : " on the part ");
    return all;
  };
  EXPECT_EQ(names(both, 0), "clamp on the part ");
  EXPECT_EQ(names(both, 2), "clamp on the part ");
  const std::string own =
      Replaced(both, "    frame: robot_base\n", "    frame: robot_base\n    fixtures: [" + vice + "]\n");
  EXPECT_EQ(names(own, 0), "clamp on the part ");
  EXPECT_EQ(names(own, 2), "vice in the world ");
  EXPECT_EQ(names(Replaced(own, "[" + vice + "]", "[]"), 2), "");
  const std::string written = WriteJob(ParseJob(own, "job.yaml", {}, 2));
  EXPECT_EQ(WriteJob(ParseJob(written, "job.yaml")), written);
  EXPECT_NE(written.find("vice"), std::string::npos);
  const std::string refusal =
      RefusalOf([&] { ParseJob(Replaced(own, "mount: world", "mount: link1"), "job.yaml", {}, 2); });
  EXPECT_NE(refusal.find("job.yaml:11:"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("workpiece, world"), std::string::npos) << refusal;
}

TEST(Setups, TheResolvedFileOfAnOperationReadsBackToItself) {
  for (const size_t i : {0u, 2u}) {
    const std::string written = WriteJob(ParseJob(kTurnedJob, "job.yaml", {}, i));
    EXPECT_EQ(WriteJob(ParseJob(written, "job.yaml")), written);
    EXPECT_EQ(written.find("setup"), std::string::npos);
  }
}

TEST(Setups, AreNamedByTheirOperations) {
  EXPECT_EQ(SetupRefusal("setup: back", "setup: bakc"),
            "job.yaml:20:12: operations[2].setup: given bakc; allowed, the job's setups: face, back; did you "
            "mean back?");
  EXPECT_EQ(SetupRefusal("    setup: back\n", ""),
            "job.yaml:19:5: operations[2].setup: missing; allowed, the job's setups: face, back");
  EXPECT_EQ(SetupRefusal("setup: back", "setup: face"),
            "job.yaml:9:11: setups[1].name: no operation is of setup back");
  EXPECT_NE(SetupRefusal("  - name: finish\n    setup: face\n", "  - name: finish\n    setup: back\n")
                .find("accepted"),
            std::string::npos)
      << "two operations in the second setup";
}

TEST(Setups, FollowEachOther) {
  const std::string refusal = RefusalOf([&] {
    std::string text =
        Replaced(kTurnedJob, "  - name: finish\n    setup: face\n", "  - name: finish\n    setup: back\n");
    text = Replaced(text, "  - name: behind\n    setup: back\n", "  - name: behind\n    setup: face\n");
    ParseJob(text, "job.yaml", {}, 0);
  });
  EXPECT_TRUE(
      refusal.starts_with("job.yaml:20:12: operations[2].setup: given face after back; allowed: "
                          "operations in the order of the setups, face, back"))
      << refusal;
}

TEST(Setups, AreCheckedThemselves) {
  const auto starts = [](const std::string& from, const std::string& to, const std::string& with) {
    const std::string refusal = SetupRefusal(from, to);
    EXPECT_TRUE(refusal.starts_with(with)) << refusal;
  };
  starts("{name: face, pose: {xyz_mm: [1, 2, 3]}}", "{name: face}",
         "job.yaml:8:5: setups[0]: give either pose or targets");
  starts("{name: face, pose:", "{name: face, poes:", "job.yaml:8:");
  starts("name: face,", "name: back,", "job.yaml:9:11: setups[1].name: given back twice");
  starts("name: back\n", "name: rough\n",
         "job.yaml:9:11: setups[1].name: given rough; an operation has this name");
  starts("frame: world,", "frame: world, pose: {xyz_mm: [0, 0, 0]},",
         "job.yaml:5:53: workpiece.pose: has no effect here: every setup has its own");
  starts("xyz_mm: [4, 5, 6]", "xyz_mm: [4, 5]", "job.yaml:11:");
}

TEST(Setups, HaveNoEffectWithoutOperations) {
  const std::string no_operations = kTurnedJob.substr(0, kTurnedJob.find("operations:"));
  const std::string refusal = RefusalOf([&] { ParseJob(no_operations, "job.yaml"); });
  EXPECT_NE(refusal.find("setups: has no effect without operations"), std::string::npos) << refusal;
  const size_t begin = kTurnedJob.find("setups:"), end = kTurnedJob.find("operations:");
  const std::string no_setups =
      RefusalOf([&] { ParseJob(kTurnedJob.substr(0, begin) + kTurnedJob.substr(end), "job.yaml", {}, 0); });
  EXPECT_NE(no_setups.find("operations[0].setup: has no effect here: the job has no setups"),
            std::string::npos)
      << no_setups;
}

}  // namespace
}  // namespace millpose
