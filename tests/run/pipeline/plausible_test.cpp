// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that are each allowed and together cannot be meant: told with the place of the key, by check, plan
// and init alike.
#include "job/plausible.hpp"

#include "base/file.hpp"
#include "job/assemble.hpp"
#include "run/pipeline/commands/check.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

testing::AssertionResult Tells(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "nothing of \"" << part << "\" in:\n" << text;
}

class Plausible : public testing::Test {
 protected:
  void SetUp() override { CopySmallJob(folder_); }

  /// What check says of the job, or why it refuses it; paths without the folder.
  std::string JobDoubts(const std::vector<Override>& overrides = {}) const {
    return Short([&] {
      const JobCheck check =
          CheckJob(LoadJobInputs(folder_.path() / "job.yaml", overrides), {.threads = 1}, Silent(), {});
      return check.mesh.warnings;
    });
  }
  std::string CellDoubts() const {
    return Short([&] { return CheckCell({folder_.path() / "cell.yaml"}).warnings; });
  }

  const TestFolder folder_{"plausible"};

 private:
  template <class Warnings>
  std::string Short(Warnings warnings) const {
    std::string text;
    const std::string refusal = RefusalOf([&] {
      for (const std::string& warning : warnings()) text += warning + '\n';
    });
    if (refusal != "accepted") text += refusal;
    for (size_t at; (at = text.find(folder_.path().string() + "/")) != std::string::npos;)
      text.erase(at, folder_.path().string().size() + 1);
    return text;
  }
};

TEST_F(Plausible, TheSampleHasNoDoubts) {
  EXPECT_EQ(JobDoubts(), "");
  EXPECT_EQ(CellDoubts(), "");
}

TEST_F(Plausible, FeedPerToothOutsideTheForceModel) {
  // 7000 rev/min, 4 teeth: 28 m/min are 1 mm a tooth.
  EXPECT_TRUE(
      Tells(JobDoubts({{"process.feed_mm_min", "200000"}}), "are 7.14 mm a tooth; usual: 0.002 to 1 mm"));
  EXPECT_TRUE(Tells(JobDoubts({{"process.feed_mm_min", "50"}}), "are 0.00179 mm a tooth"));
  folder_.Change("job.yaml", "spindle_rpm: 7000", "spindle_rpm: 3");
  EXPECT_TRUE(Tells(JobDoubts(),
                    "job.yaml:24:16: process.feed_mm_min: 80 mm/min at 3 rev/min and 4 teeth are 6.67 mm"));
}

TEST_F(Plausible, AForceThatIsNoNumberIsRefused) {
  const std::string told = JobDoubts({{"process.spindle_rpm", "1e-300"}});
  EXPECT_TRUE(Tells(told, "process.cutting: the cutting force is no finite number"));
}

TEST_F(Plausible, AForceThatBendsTheArmByMillimetres) {
  EXPECT_TRUE(Tells(JobDoubts({{"process.cutting", "{kc11_N_mm2: 99000, teeth: 4, depth_mm: 30}"}}),
                    "process.cutting: the heaviest cut's "));
}

TEST_F(Plausible, AStepOverLargerThanThePart) {
  EXPECT_TRUE(
      Tells(JobDoubts({{"toolpath.stepover_mm", "500"}}), "toolpath.stepover_mm: given 500; the part is "));
}

TEST_F(Plausible, ALinksBodyFarFromTheArmIsRefusedUnlessItIsMeant) {
  folder_.Change("cell.yaml", "pose: {xyz_mm: [-46, -331, 10]}", "pose: {xyz_mm: [-46000, -331000, 10000]}");
  EXPECT_TRUE(Tells(CellDoubts(), "bodies[5].pose.xyz_mm: link2_lower lies "));
  EXPECT_TRUE(Tells(CellDoubts(), "cell.yaml:38:"));
  EXPECT_TRUE(Tells(JobDoubts(), "bodies[5].pose.xyz_mm: link2_lower lies "));
  folder_.Change("cell.yaml", "excluded_pairs: []",
                 "excluded_pairs: []\ninterference: {far_bodies: [link2_lower]}");
  EXPECT_EQ(CellDoubts(), "");
}

TEST_F(Plausible, WhatIsSaidToBeFarMustBe) {
  folder_.Change("cell.yaml", "excluded_pairs: []",
                 "excluded_pairs: []\ninterference: {far_bodies: [link2_lower]}");
  EXPECT_TRUE(Tells(CellDoubts(), "interference.far_bodies: given link2_lower; no body of that name"));
}

TEST_F(Plausible, BodiesThatDoNotFitTheArm) {
  folder_.Change("cell.yaml", "{box: {size_mm: [502, 574, 686]}}",
                 "{mesh: {file: support_pad.stl, unit: m}}");
  EXPECT_TRUE(Tells(CellDoubts(), "bodies[5].shape.mesh.unit: link2_lower (support_pad.stl) is "));
  EXPECT_TRUE(Tells(CellDoubts(), "it would be with unit: mm or cm"));
}

TEST_F(Plausible, AToolLongerThanTheArm) {
  folder_.Change("cell.yaml", "length_mm: 320, diameter_mm: 160", "length_mm: 3200, diameter_mm: 160");
  EXPECT_TRUE(Tells(CellDoubts(), "tool.stack: spindle_d20 is 3320 mm long; the arm is "));
}

TEST_F(Plausible, APlanHasTheDoubtsAmongItsFindings) {
  const JobInputs inputs = LoadJobInputs(folder_.path() / "job.yaml", {{"process.feed_mm_min", "50"}});
  const PreparedJob prepared = PrepareJob(inputs, NoCheckpoints{}, {.threads = 1});
  ASSERT_EQ(prepared.made.findings.size(), 1u);
  EXPECT_TRUE(Tells(prepared.made.findings[0], "process.feed_mm_min"));
}

TEST(PlausibleCells, NoShippedCellHasDoubts) {
  for (const auto& entry : std::filesystem::directory_iterator(SamplePath("cells"))) {
    if (entry.path().extension() != ".yaml") continue;
    std::map<std::string, std::string> bytes;
    const CellSettings cell = LoadCell(entry.path(), &bytes);
    const Cell made = MakeCell(cell, bytes);
    EXPECT_EQ(DoubtsOf({cell, made}).size(), 0u) << entry.path();
  }
}

TEST_F(Plausible, CandidatesAreBoundedInMemory) {
  const JobInputs inputs = LoadJobInputs(folder_.path() / "job.yaml");
  const std::string told =
      RefusalOf([&] { PlanJob(inputs, NoCheckpoints{}, {.threads = 2, .memory = 1e5}); });
  EXPECT_TRUE(Tells(
      told, "path.rotation_step_deg: given 1; the candidates of a pass of 3 points would take more than"));
}

}  // namespace
}  // namespace millpose::test
