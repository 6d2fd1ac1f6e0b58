// SPDX-License-Identifier: GPL-3.0-or-later
// $BASE in the controller's $WORLD for six mountings, against where the part really is; gravity; what the
// controller is warned of.
#include "base/error.hpp"
#include "base/units.hpp"
#include "job/assemble.hpp"
#include "machine/robot/make_pose.hpp"
#include "program/krl/krl.hpp"
#include "run/pipeline/programs/program_warnings.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/program/own_options.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// The point p of a frame at `place`, turned by A, B, C degrees about Z, Y', X'', in plain numbers.
Vector3d Seen(const Vector3d& place, const Vector3d& abc, const Vector3d& p) {
  const auto turn = [](const Vector3d& v, int i, int j, double degrees) {
    Vector3d turned = v;
    const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
    turned[i] = c * v[i] - s * v[j];
    turned[j] = s * v[i] + c * v[j];
    return turned;
  };
  return place + turn(turn(turn(p, 1, 2, abc[2]), 2, 0, abc[1]), 0, 1, abc[0]);
}

struct Mounting {
  const char* name;
  Vector3d base_place, base_abc;                 // of the robot's base in the cell
  std::optional<Vector3d> root_place, root_abc;  // robroot
  bool coupled = false;
  Vector3d world_place = Vector3d::Zero();  // of the controller's $WORLD in the cell
};

/// The controller's $WORLD is parallel to the cell in all of them.
const std::vector<Mounting>& Mountings() {
  static const std::vector<Mounting> mountings = {
      // On a plinth, $ROBROOT as delivered: $WORLD is at the robot's foot.
      {"plinth", {0, 0, 800}, {0, 0, 0}, {}, {}, false, {0, 0, 800}},
      {"plinth_given", {0, 0, 800}, {0, 0, 0}, Vector3d(0, 0, 800), Vector3d(0, 0, 0), false, {0, 0, 0}},
      {"ceiling",
       {300, -40, 3500},
       {0, 0, 180},
       Vector3d(0, 0, 3500),
       Vector3d(0, 0, 180),
       false,
       {300, -40, 0}},
      {"wall",
       {200, -100, 1500},
       {0, 90, 0},
       Vector3d(0, 0, 1500),
       Vector3d(0, 90, 0),
       false,
       {200, -100, 0}},
      // A rail that the controller does not count in takes $WORLD along.
      {"rail", {1500, 0, 300}, {0, 0, 0}, {}, {}, false, {1500, 0, 300}},
      // One that it counts in: root at (0, -200, 300), 1500 mm along its y, the robot turned on its carriage.
      {"coupled_rail",
       {50, 1300, 420},
       {90, 0, 0},
       Vector3d(50, 0, 120),
       Vector3d(90, 0, 0),
       true,
       {0, 0, 0}},
  };
  return mountings;
}

PoseSettings Settings(const Vector3d& place, const Vector3d& abc) { return {place, abc * kRadPerDeg}; }

class Mounted : public testing::TestWithParam<Mounting> {
 protected:
  std::map<std::string, std::string> bytes;
  CellSettings cell = LoadCell(std::filesystem::path(SourceDir()) / "cells/kr500_r2830.yaml", &bytes);
  JobSettings job;

  void SetUp() override {
    const Mounting& mounting = GetParam();
    cell.base_in_world = Settings(mounting.base_place, mounting.base_abc);
    KrlOptions krl = OwnOptions<KrlPost>(cell.controllers.at("krl"));
    if (mounting.root_place) krl.robroot = Settings(*mounting.root_place, *mounting.root_abc);
    if (mounting.coupled) {
      cell.controllers.at("krl").shared.controller_axes = {{"E1", "", AxisKind::kLinear, 1500, true}};
      krl.ersysroot = KrlRail{Settings({0, -200, 300}, {0, 0, 0}), FrameAxis::kY};
    }
    SetOwnOptions<KrlPost>(cell.controllers.at("krl"), krl);
  }
};
INSTANTIATE_TEST_SUITE_P(Six, Mounted, testing::ValuesIn(Mountings()),
                         [](const auto& mounting) { return mounting.param.name; });

TEST_P(Mounted, BaseIsWhereTheControllerSeesThePart) {
  const PoseSettings part = Settings({1800, 250, 1100}, {15, -70, 5});
  MotionProgram program;
  program.name = "part";
  program.X_BP = MakePose(cell.base_in_world).inverse() * MakePose(part);
  program.X_FT = MakeToolPose(cell.tool);
  Motion& home = program.motions.emplace_back();
  home.q = cell.home;
  home.exact = true;
  const PostSettings settings = MakePostSettings(job, cell, "krl");
  const Arm arm = MakeArm(cell.arm);
  const PostPointer& post = cell.controllers.at("krl").post;
  const std::string text = post->Write(program, arm, settings).at("part.src");
  const size_t at = text.find("$BASE = {FRAME: X ");
  ASSERT_NE(at, std::string::npos);
  double x = 0, y = 0, z = 0, a = 0, b = 0, c = 0;
  ASSERT_EQ(std::sscanf(text.c_str() + at, "$BASE = {FRAME: X %lf,Y %lf,Z %lf,A %lf,B %lf,C %lf}", &x, &y, &z,
                        &a, &b, &c),
            6);
  // Points of the part, once by the cell and once by what the program states.
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(500, 0, 0), Vector3d(0, 700, -40)}) {
    const Vector3d in_cell = Seen({1800, 250, 1100}, {15, -70, 5}, p);
    const Vector3d by_program = GetParam().world_place + Seen({x, y, z}, {a, b, c}, p);
    EXPECT_LT((in_cell - by_program).norm(), 0.001) << GetParam().name;
  }
  // And back: the robot sees the part where it was planned.
  const MotionProgram read = post->Read({{"part.src", text}}, arm, settings);
  EXPECT_LT((read.X_BP->matrix() - program.X_BP->matrix()).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(KrlFrames, AnArmTurnedAgainstGravityNeedsItsRobroot) {
  std::map<std::string, std::string> bytes;
  CellSettings cell = LoadCell(std::filesystem::path(SourceDir()) / "cells/kr500_r2830.yaml", &bytes);
  KrlOptions krl = OwnOptions<KrlPost>(cell.controllers.at("krl"));
  const auto problem = [&]() -> std::string {
    SetOwnOptions<KrlPost>(cell.controllers.at("krl"), krl);
    try {
      MakePostSettings({}, cell, "krl");
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  cell.base_in_world = Settings({0, 0, 0}, {40, 0, 0});  // about the vertical: nothing to state
  EXPECT_EQ(problem(), "");
  cell.base_in_world = Settings({0, 0, 0}, {0, 0.5, 0});  // levelled
  EXPECT_EQ(problem(), "");
  cell.base_in_world = Settings({0, 0, 3000}, {0, 0, 180});
  EXPECT_NE(problem().find("robroot is missing"), std::string::npos) << problem();
  krl.robroot = Settings({0, 0, 0}, {0, 90, 0});
  EXPECT_NE(problem().find("robroot must agree"), std::string::npos) << problem();
  krl.robroot = Settings({0, 0, 0}, {70, 0, 180});
  EXPECT_EQ(problem(), "");
  // Other controllers count from the robot's base.
  krl.robroot.reset();
  EXPECT_NO_THROW(MakePostSettings({}, cell, "sinumerik"));
}

TEST(KrlFrames, ALoadToWriteMustBeGiven) {
  std::map<std::string, std::string> bytes;
  CellSettings cell = LoadCell(std::filesystem::path(SourceDir()) / "cells/kr500_r2830.yaml", &bytes);
  KrlOptions krl = OwnOptions<KrlPost>(cell.controllers.at("krl"));
  krl.write_load = true;
  SetOwnOptions<KrlPost>(cell.controllers.at("krl"), krl);
  cell.tool.load.reset();
  EXPECT_THROW(MakePostSettings({}, cell, "krl"), InputError);
  cell.tool.load = ToolLoad{180, {0, 0, 150}, {9, 9, 5}};
  EXPECT_EQ(MakePostSettings({}, cell, "krl").load->mass, 180);
}

TEST(ProgramWarnings, NameTheSlowestPointsAndWhatHelps) {
  PathSpeed speed{"krl", 0.4, {}};
  EXPECT_EQ(SpeedWarning(speed), "");
  for (int i = 0; i < 9; ++i) speed.slow.push_back({2, i, 10, 9.0 - i * 0.5, "corner"});
  const std::string warning = SpeedWarning(speed);
  EXPECT_NE(
      warning.find("at 9 places, estimated: pass 2 point 8: 300 of 600 mm/min (corner), pass 2 point 7"),
      std::string::npos)
      << warning;
  EXPECT_EQ(warning.find("point 3:"), std::string::npos);
  EXPECT_NE(warning.find("path_tolerance_mm"), std::string::npos);
}

TEST(ProgramWarnings, MemoryIsSummedOverAllFiles) {
  const ProgramFiles files = {{"a.src", std::string(3000, 'x')}, {"b.src", std::string(2500, 'x')}};
  EXPECT_EQ(MemoryWarning(files, 0), "");  // no budget
  EXPECT_EQ(MemoryWarning(files, 5500), "");
  EXPECT_NE(MemoryWarning(files, 5400).find("take 5 kB"), std::string::npos);
}

}  // namespace
}  // namespace millpose
