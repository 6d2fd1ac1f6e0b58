// SPDX-License-Identifier: GPL-3.0-or-later
// What a job names, read into memory: places of what is wrong, and the hash that says when a plan is still
// valid.
#include <set>

#include "job/assemble.hpp"
#include "job/config/config.hpp"
#include "job/workpiece.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/base/refusal.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

class Inputs : public testing::Test {
 protected:
  void SetUp() override { CopySmallJob(folder_); }
  JobInputs Load(const std::vector<Override>& overrides = {}) const {
    return LoadJobInputs(folder_.path() / "job.yaml", overrides);
  }
  std::string Refusal(const std::vector<Override>& overrides = {}) const {
    std::string text = RefusalOf([&] { Load(overrides); });
    for (size_t at; (at = text.find(folder_.path().string() + "/")) != std::string::npos;)
      text.erase(at, folder_.path().string().size() + 1);
    return text;
  }

  const TestFolder folder_{"inputs"};
};

TEST_F(Inputs, TheHashIsThatOfWhatIsReadAndNotOfWhereOrHowItIsWritten) {
  const std::string hash = Load().hash;
  const TestFolder other("inputs_elsewhere");
  CopySmallJob(other);
  EXPECT_EQ(LoadJobInputs(other.path() / "job.yaml").hash, hash);
  folder_.Change("job.yaml", "seed: 1\n", "seed:   1   # as ever\n\n");
  folder_.Change("cell.yaml", "excluded_pairs: []\n", "");  // the default
  EXPECT_EQ(Load().hash, hash);
  EXPECT_EQ(Load({{"seed", "1"}}).hash, hash);
}

TEST_F(Inputs, WhateverIsReadChangesTheHash) {
  std::set<std::string> hashes{Load().hash};
  const auto is_new = [&] { return hashes.insert(Load().hash).second; };
  EXPECT_TRUE(hashes.insert(Load({{"seed", "2"}}).hash).second);
  EXPECT_TRUE(hashes.insert(Load({{"program_options.path_tolerance_mm", "0.03"}}).hash).second);
  folder_.Change("job.yaml", "feed_mm_min: 80", "feed_mm_min: 81");
  EXPECT_TRUE(is_new());
  folder_.Change("cell.yaml", "clearance_mm: {free: 10", "clearance_mm: {free: 11");
  EXPECT_TRUE(is_new());
  std::string mesh = folder_.Read("support_pad.stl");
  mesh[100] ^= 1;
  folder_.Write("support_pad.stl", mesh);
  EXPECT_TRUE(is_new());
  folder_.Change("job.yaml", "  unit: mm\n", "  unit: mm\n  stock: {mesh: support_pad.stl, unit: mm}\n");
  EXPECT_TRUE(is_new());
  folder_.Write("clamp.stl", ReadFile(SamplePath("toolpaths/support_pad/support_pad.stl")));
  folder_.Change(
      "cell.yaml", "excluded_pairs: []",
      "  - {name: clamp, class: fixture, mount: world, shape: {mesh: {file: clamp.stl, unit: mm}}}\n"
      "excluded_pairs: []");
  EXPECT_TRUE(is_new());
  folder_.Write("clamp.stl", mesh);
  EXPECT_TRUE(is_new());
}

TEST_F(Inputs, WhatIsWrongWithJobCellAndFilesIsNamedTogether) {
  folder_.Change("cell.yaml", "  - {name: link5, class: link, mount: link5",
                 "  - {name: link5, class: link, mount: link4");
  folder_.Change("cell.yaml", "  - {name: link5_front, class: link, mount: link5",
                 "  - {name: link5_front, class: link, mount: link4");
  std::filesystem::remove(folder_.path() / "support_pad.stl");
  const std::string refusal = Refusal();
  EXPECT_NE(
      refusal.find("bodies: link5 has no body, so its interference would never be found; add one with mount: "
                   "link5, or name it in interference.unchecked_links"),
      std::string::npos)
      << refusal;
  EXPECT_NE(refusal.find("support_pad.stl: cannot open"), std::string::npos) << refusal;
  folder_.Change("cell.yaml", "excluded_pairs: []",
                 "interference: {unchecked_links: [link5]}\nexcluded_pairs: []");
  EXPECT_EQ(Refusal().find("has no body"), std::string::npos);
}

TEST_F(Inputs, ALinkLeftOutOnPurposeIsAWarningUnlessItHasABody) {
  folder_.Change("cell.yaml", "excluded_pairs: []",
                 "interference: {unchecked_links: [link5]}\nexcluded_pairs: []");
  EXPECT_NE(Refusal().find("interference.unchecked_links: link5 has a body; allowed: links without"),
            std::string::npos);
  CellSettings cell;
  cell.name = "c";
  cell.warnings = {"of the URDF"};
  cell.unchecked_links = {0, 4};
  EXPECT_EQ(CellWarnings(cell), (std::vector<std::string>{"of the URDF",
                                                          "c: interference of base, link4 is not checked "
                                                          "(interference.unchecked_links)"}));
}

TEST_F(Inputs, WhatTheCutterCannotDoHasTheJobsLine) {
  EXPECT_NE(
      Refusal({{"process.cutting.depth_mm", "41"}})
          .find("process.cutting.depth_mm: given 41; allowed: at most tool.cutter.cutting_length_mm of cell "
                "kr500_r2830, 40, above which the cutter does not cut"),
      std::string::npos);
  folder_.Change("job.yaml", "  lead_deg: 0\n",
                 "  ends: {lead: along, ramp_deg: 5, lead_length_mm: 1}\n  lead_deg: 0\n");
  const std::string refusal = Refusal();
  EXPECT_NE(refusal.find("toolpath.ends.ramp_deg: given 5; allowed: at most tool.cutter.max_ramp_deg of cell "
                         "kr500_r2830, 3"),
            std::string::npos)
      << refusal;
  EXPECT_TRUE(refusal.starts_with("job.yaml:")) << refusal;
}

TEST_F(Inputs, NothingOutsideOfTheRootIsOpened) {
  const FileRoot root(folder_.path());
  const auto load = [&] { LoadJobInputs(folder_.path() / "job.yaml", {}, {}, root); };
  EXPECT_EQ(RefusalOf(load), "accepted");
  folder_.Change("job.yaml", "mesh: support_pad.stl", "mesh: ../secret.stl");
  EXPECT_NE(RefusalOf(load).find("lies outside of"), std::string::npos);
  folder_.Change("job.yaml", "mesh: ../secret.stl", "mesh: support_pad.stl");
  folder_.Change("job.yaml", "cell: cell.yaml", "cell: /etc/passwd");
  EXPECT_NE(RefusalOf(load).find("lies outside of"), std::string::npos);
}

TEST_F(Inputs, TheJobMayPutTheRobotElsewhere) {
  const JobInputs here = Load(),
                  there = Load({{"base_in_world", "{xyz_mm: [0, 100, 50], abc_deg: [10, 0, 0]}"}});
  EXPECT_EQ(there.cell.base_in_world.position, Eigen::Vector3d(0, 100, 50));
  EXPECT_NE(here.hash, there.hash);
  const Cell cell = MakeJobCell(there);
  EXPECT_TRUE(cell.X_WP.isApprox(cell.X_WB * MakeJobCell(here).X_WP, 1e-12))
      << "the part is given from the robot";
}

TEST(MakeToolPose, ZIsTheAxisAndXAsNearAsItMayBe) {
  ToolSettings tool;
  tool.tip = {1, 2, 3};
  tool.axis = Eigen::Vector3d(1, 2, -1);
  tool.x = Eigen::Vector3d(0.3, 0, 1);
  const Pose X_FT = MakeToolPose(tool);
  EXPECT_LT((X_FT.linear() * X_FT.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_NEAR(X_FT.linear().determinant(), 1, 1e-15);
  EXPECT_LT((X_FT.linear().col(2) - tool.axis.normalized()).norm(), 1e-15);
  const double nearness = X_FT.linear().col(0).dot(tool.x);
  for (int k = 1; k < 36; ++k) {  // no other direction normal to z is nearer
    const Eigen::Vector3d turned =
        Eigen::AngleAxisd(k * kPi / 18, tool.axis.normalized()) * X_FT.linear().col(0);
    EXPECT_LT(turned.dot(tool.x), nearness);
  }
  EXPECT_EQ(X_FT.translation(), tool.tip);
}

WorkpieceSettings Measured(const Pose& X, double error) {
  WorkpieceSettings workpiece;
  RandomStream random(2, 0);
  for (int i = 0; i < 5; ++i) {
    TargetSettings& target = workpiece.targets.emplace_back();
    target.nominal = 500 * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
    target.measured = X * target.nominal +
                      error * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
  }
  return workpiece;
}

TEST(MakeWorkpiecePose, FitsTheMeasuredTargetsBest) {
  RandomStream random(3, 0);
  for (int k = 0; k < 20; ++k) {
    Pose X =
        Pose(Eigen::AngleAxisd(random.Uniform(0, 3), Eigen::Vector3d(1, random.Normal(), 2).normalized()));
    X.translation() = 1000 * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
    EXPECT_TRUE(MakeWorkpiecePose(Measured(X, 0), Pose::Identity()).isApprox(X, 1e-10));
    // With errors: no pose near it has a smaller sum of squares.
    const WorkpieceSettings noisy = Measured(X, 0.3);
    const Pose fit = MakeWorkpiecePose(noisy, Pose::Identity());
    const auto sum = [&](const Pose& pose) {
      double squares = 0;
      for (const TargetSettings& target : noisy.targets)
        squares += (pose * target.nominal - target.measured).squaredNorm();
      return squares;
    };
    for (int trial = 0; trial < 30; ++trial) {
      Pose other =
          fit * Pose(Eigen::AngleAxisd(1e-4 * random.Normal(), Eigen::Vector3d::Random().normalized()));
      other.translation() += 0.02 * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
      EXPECT_GE(sum(other), sum(fit) - 1e-9);
    }
  }
}

TEST(MakeWorkpiecePose, RefusesTargetsThatDoNotDetermineItOrDoNotFit) {
  WorkpieceSettings line = Measured(Pose::Identity(), 0);
  for (size_t i = 0; i < line.targets.size(); ++i)
    line.targets[i].nominal = line.targets[i].measured = static_cast<double>(i) * Eigen::Vector3d(1, 2, 3);
  EXPECT_EQ(RefusalOf([&] { MakeWorkpiecePose(line, Pose::Identity()); }),
            "workpiece.targets: the points lie on a line, so the rotation about it is not known");
  const std::string refusal =
      RefusalOf([&] { MakeWorkpiecePose(Measured(Pose::Identity(), 3), Pose::Identity()); });
  EXPECT_NE(refusal.find("allowed: at most max_residual_mm, 0.5"), std::string::npos) << refusal;
}

TEST(MakeWorkpiecePose, IsGivenInTheWorldOrFromTheRobot) {
  WorkpieceSettings workpiece;
  workpiece.pose = {{100, 200, 300}, {0.1, 0.2, 0.3}};
  const Pose X_WB = At(0, 0, 50) * Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ());
  const Pose in_world = MakeWorkpiecePose(workpiece, X_WB);
  EXPECT_EQ(in_world.translation(), Eigen::Vector3d(100, 200, 300));
  EXPECT_TRUE(in_world.linear().isApprox(
      (Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
          .toRotationMatrix(),
      1e-14));
  workpiece.frame = GivenFrame::kRobotBase;
  EXPECT_TRUE(MakeWorkpiecePose(workpiece, X_WB).isApprox(X_WB * in_world, 1e-14));
}

TEST(MakeBounds, AreTheNarrowerOfArmAndTaskMinusTheMargin) {
  JobSettings job;
  job.file = "job.yaml";
  const Arm arm = SampleArm();
  job.limit_margin = DegToRad(2);
  AdmissibleBounds bounds = MakeBounds(job, arm);
  EXPECT_TRUE(bounds.lower.isApprox((arm.lower.array() + DegToRad(2)).matrix(), 1e-15));
  EXPECT_TRUE(bounds.upper.isApprox((arm.upper.array() - DegToRad(2)).matrix(), 1e-15));
  job.task_limits = {arm.lower, arm.upper};
  (*job.task_limits)[0][1] = DegToRad(-90);   // narrower
  (*job.task_limits)[1][1] = DegToRad(1000);  // wider: the arm's holds
  bounds = MakeBounds(job, arm);
  EXPECT_DOUBLE_EQ(RadToDeg(bounds.lower[1]), -88);
  EXPECT_DOUBLE_EQ(RadToDeg(bounds.upper[1]), 18);
  job.limit_margin = DegToRad(60);
  EXPECT_EQ(RefusalOf([&] { MakeBounds(job, arm); }),
            "job.yaml: limits: axis 2 has no range left: -30.000..-40.000 deg after the margin");
}

TEST(MakePoseProblem, AnObjectiveThatNeedsAForceIsRefusedWithoutOne) {
  JobInputs inputs = SmallInputs();
  const Cell cell = MakeCell(inputs.cell, inputs.body_bytes);
  EXPECT_EQ(MakePoseProblem(inputs.job, inputs.cell, cell).objective->Name(), "surface_error");
  inputs.job.cutting.reset();
  EXPECT_NE(RefusalOf([&] {
              MakePoseProblem(inputs.job, inputs.cell, cell);
            }).find("objective surface_error: no force; give the job process.cutting"),
            std::string::npos);
}

TEST(WithAllTools, IsFreeOnlyWhereEveryToolIs) {
  const auto file = SamplePath("cells/kr500_two_tools.yaml");
  std::map<std::string, std::string> bytes;
  CellSettings settings = LoadCell(file, &bytes);
  SelectTool("drill_d5", &settings);
  const Cell with_drill = MakeCell(settings, bytes), with_all = WithAllTools(with_drill, settings);
  SelectTool("mill_d20", &settings);
  const Cell with_mill = MakeCell(settings, bytes);
  EXPECT_EQ(with_all.bodies.size(), with_drill.bodies.size() + settings.tool.stack.size());
  const World all(with_all), mill(with_mill), drill(with_drill);
  Checker of_all(all), of_mill(mill), of_drill(drill);
  RandomStream random(1, 0);
  int free = 0, barred = 0;
  for (int k = 0; k < 300; ++k) {
    const Joints q = RandomJoints(random, with_all.arm);
    const bool each = !of_mill.At(q, Phase::kFree) && !of_drill.At(q, Phase::kFree);
    EXPECT_EQ(!of_all.At(q, Phase::kFree), each) << q.transpose();
    ++(each ? free : barred);
  }
  EXPECT_GT(free, 20);
  EXPECT_GT(barred, 20);
}

TEST(Reach, IsThatOfTheStretchedArmWithItsTool) {
  const Cell cell = EmptyCell();
  RandomStream random(1, 0);
  double farthest = 0;
  const double reach = Reach(cell);
  for (int k = 0; k < 20000; ++k) {
    const Pose X_BT = ForwardFlange(cell.arm, RandomJoints(random, cell.arm)) * cell.X_FT;
    farthest = std::max(farthest, X_BT.translation().head<2>().norm());
  }
  EXPECT_LE(farthest, reach);
  EXPECT_GT(farthest, 0.7 * reach);
}

// Whether or not a job asks for the controller.
TEST_F(Inputs, AControllerNamesAxesOfTheCellAlone) {
  folder_.Write("cell.yaml", ReadFile(SamplePath("cells/kr500_rail.yaml")));
  std::map<std::string, std::string> bytes;
  EXPECT_NO_THROW(LoadCell(folder_.path() / "cell.yaml", &bytes));
  folder_.Change("cell.yaml", "axis: rail, coupled: true", "axis: rial, coupled: true");
  const std::string told = RefusalOf([&] { LoadCell(folder_.path() / "cell.yaml", &bytes); });
  EXPECT_NE(told.find("given axis 'rial'; allowed: the name of one of external_axes; did you mean 'rail'?"),
            std::string::npos)
      << told;
}

}  // namespace
}  // namespace millpose::test
