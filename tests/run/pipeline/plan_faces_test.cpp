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

double LargestOf(const PlannedJob& job) {
  double largest = 0;
  for (const FaceChoice& choice : job.faces)
    largest = std::max({largest, choice.after.worst, choice.after.step});
  return largest;
}

// A4 may hardly turn: passes to and fro leave levels to either side, farther apart than any is from 0.
TEST(PlanFaces, WhereDirectionsAreFreeNoneOfThemAllWouldBeBetter) {
  const auto planned = [](const std::string& direction) {
    return PlanJob(test::SmallInputs(
                       {{"pose.objective", "{name: face_error}"},
                        {"toolpath.stepover_mm", "8"},
                        {"toolpath.spacing_mm", "4"},
                        {"toolpath.direction", direction},
                        {"limits.joints_deg",
                         "[[-180, 180], [-180, 180], [-180, 180], [-170, -162], [-180, 180], [-340, 340]]"},
                        {"programs", "[]"}}),
                   NoCheckpoints(), {.threads = 2});
  };
  const PlannedJob free = planned("zigzag");
  EXPECT_GT(std::ranges::count(free.prepared.turned, 1), 0);
  for (const char* direction : {"one_way", "climb", "conventional"})
    EXPECT_LE(LargestOf(free), LargestOf(planned(direction)) / 0.85) << direction;  // kWorthLowering
  EXPECT_EQ(test::BytesOf(planned("zigzag")), test::BytesOf(free));
}

// The tool as it was laid is among the candidates, and directions are sought with the leans.
TEST(PlanFaces, LeansNeverRaiseWhatIsLeft) {
  const test::TestFolder folder("leans");
  test::CopySmallJob(folder);
  folder.Change("cell.yaml", "shape: flat", "shape: ball");
  const auto planned = [&](const std::vector<Override>& leans) {
    std::vector<Override> overrides{{"pose.objective", "{name: face_error}"},
                                    {"toolpath.stepover_mm", "16"},
                                    {"toolpath.spacing_mm", "16"},
                                    {"programs", "[]"}};
    overrides.insert(overrides.end(), leans.begin(), leans.end());
    return PlanJob(LoadJobInputs(folder.path() / "job.yaml", overrides), NoCheckpoints(), {.threads = 2});
  };
  const auto worst_and_marks = [](const PlannedJob& job) {
    std::pair<double, double> both{0, 0};
    for (const FaceChoice& choice : job.faces) {
      both.first = std::max(both.first, choice.after.worst);
      both.second += choice.after.marks;
    }
    return both;
  };
  const auto [worst, marks] = worst_and_marks(planned({}));
  const auto [leaning_worst, leaning_marks] =
      worst_and_marks(planned({{"toolpath.lead_deg", "{from: -10, to: 10, step: 10}"},
                               {"toolpath.tilt_deg", "{from: -10, to: 10, step: 10}"}}));
  EXPECT_LE(leaning_worst, worst * (1 + 1e-9));
  if (leaning_worst > worst * (1 - 1e-9)) {
    EXPECT_LE(leaning_marks, marks + 1e-9);  // a smaller displacement may cost marks
  }
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
