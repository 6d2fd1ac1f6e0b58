// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/plan_faces.hpp"

#include <gtest/gtest.h>

#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose {
namespace {

const std::vector<Override> kForFace{{"pose.objective", "{name: face_error}"}};

TEST(PlanFaces, ForceAndLostMotionDecideWhereTheJobNamesNoObjective) {
  const test::TestFolder folder("faces");
  test::CopySmallJob(folder);
  const auto objective = [&](const std::vector<Override>& overrides = {}) {
    return LoadJobInputs(folder.path() / "job.yaml", overrides).job.objective;
  };
  EXPECT_EQ(objective(), "surface_error");  // named
  std::string job = folder.Read("job.yaml");
  const size_t at = job.find("  objective: ");
  folder.Write("job.yaml", job.erase(at, job.find('\n', at) + 1 - at));
  EXPECT_EQ(objective(), "face_error");
  EXPECT_EQ(objective({{"pose.objective", "{name: process_force}"}}), "process_force");
  std::string cell = folder.Read("cell.yaml");
  for (const char* key : {"  lost_motion_arcmin: ", "  lost_motion_source: "}) {
    const size_t line = cell.find(key);
    ASSERT_NE(line, std::string::npos);
    cell.erase(line, cell.find('\n', line) + 1 - line);
  }
  folder.Write("cell.yaml", cell);
  EXPECT_EQ(objective(), "surface_error");
  const JobInputs inputs = LoadJobInputs(folder.path() / "job.yaml", kForFace);
  EXPECT_NE(RefusalOf([&] {
              PlanJob(inputs, NoCheckpoints(), {.threads = 1});
            }).find("states no lost motion (arm.lost_motion_arcmin); without it surface_error is the same"),
            std::string::npos);
}

TEST(PlanFaces, NoPieceBecomesWorseAndThePlanIsTheSameAgain) {
  const test::MemoryCheckpoints kept;
  const PlannedJob first = PlanJob(test::SmallInputs(kForFace), kept, {.threads = 2});
  ASSERT_EQ(first.faces.size(), 2u);
  double before = 0, after = 0;
  for (const FaceChoice& choice : first.faces) {
    before = std::max(before, choice.before.worst);
    after = std::max(after, choice.after.worst);
  }
  EXPECT_GT(before, 0);
  EXPECT_LE(after, before);
  EXPECT_EQ(test::BytesOf(PlanJob(test::SmallInputs(kForFace), kept, {.threads = 1})), test::BytesOf(first));
  EXPECT_EQ(test::BytesOf(PlanJob(test::SmallInputs(kForFace), NoCheckpoints(), {.threads = 1})),
            test::BytesOf(first));
}

TEST(PlanFaces, OtherObjectivesArePlannedAsEver) {
  const PlannedJob& plain = test::FreshPlan();
  EXPECT_TRUE(plain.faces.empty());
  JobInputs inputs = test::SmallInputs();
  inputs.cell.arm.lost_motion.reset();
  EXPECT_EQ(Serialise(PlanJob(inputs, NoCheckpoints(), {.threads = 2}).plan), Serialise(plain.plan));
}

}  // namespace
}  // namespace millpose
