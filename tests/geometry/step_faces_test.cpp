// SPDX-License-Identifier: GPL-3.0-or-later
// Faces that OpenCASCADE cannot cut, other ways of cutting, and the process that does it.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <chrono>
#include <filesystem>
#include <thread>

#include "apps/step/recut.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "geometry/import/mesh_import.hpp"
#include "geometry/import/step_reader.hpp"
#include "tests/geometry/step_parts.hpp"
#include "toolpath/lost_faces.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/strategies/parallel_planes.hpp"

namespace millpose {
namespace {

StepOptions FaceOptions() {
  StepOptions options;
  options.program = MILLPOSE_STEP_PROGRAM;
  return options;
}

const std::string kLost =
    "STEP face 7 (#388, plane, 1200 mm²) between (0, 0, 20) and (40, 30, 70) mm could not be cut into "
    "triangles";

TEST(StepFaces, ALostFaceIsNamedWithNumberAreaAndPlace) {
  const ImportResult import =
      ImportMesh(ReadMesh(LostFaceStep(), "part.step", FaceOptions()), {1, 1e-4}, "part.step");
  EXPECT_EQ(import.report.lost_faces, std::vector<std::string>{kLost});
  EXPECT_EQ(std::ranges::count(Findings(import.report), kLost), 1);
  EXPECT_EQ(import.report.closed_pieces, 1);
}

TEST(StepFaces, ALostFaceInTheRegionIsAnError) {
  const Mesh mesh =
      ImportMesh(ReadMesh(LostFaceStep(), "part.step", FaceOptions()), {1, 1e-4}, "part.step").mesh;
  ToolpathOptions options;
  options.strategy = std::make_shared<ParallelPlanes>();
  options.stepover = 8;
  options.region.facing = Eigen::Vector3d::UnitZ();
  try {
    MakeToolpath(mesh, options, {});
    FAIL() << "the region was milled without the face";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "toolpath: " + kLost +
                  ", and the region may hold points of it; leave it out with `region: {none: [{step_faces: "
                  "[\"7\"]}]}`, or give the part as a mesh");
  }
  RegionOptions lost;
  lost.source_faces = {"7"};
  options.region.none = {lost};
  EXPECT_NO_THROW(MakeToolpath(mesh, options, {}));
}

TEST(StepFaces, BoundsTellWhatARegionMayHold) {
  SourceFace face{"#12", "rib", "plane", 100, true, {0, 0, 0}, {10, 10, 10}};
  const auto may = [&](const RegionOptions& region) { return MayTouch(face, 2, region); };
  RegionOptions everywhere, near, far, above, polygon, named, other, facing;
  near.box = RegionBox{Eigen::Vector3d(9, 9, 9), Eigen::Vector3d(20, 20, 20)};
  far.box = RegionBox{Eigen::Vector3d(11, 0, 0), Eigen::Vector3d(20, 20, 20)};
  above.half_space = HalfSpace{{0, 0, 10.5}, Eigen::Vector3d::UnitZ()};
  polygon.polygon = ProjectedPolygon{{{20, 0, 0}, {30, 0, 0}, {30, 30, 0}}, Eigen::Vector3d::UnitZ()};
  named.source_faces = {"rib"};
  other.source_faces = {"4", "#13"};
  facing.facing = Eigen::Vector3d::UnitX();
  EXPECT_TRUE(may(everywhere) && may(near) && may(named) && may(facing));
  EXPECT_FALSE(may(far) || may(above) || may(polygon) || may(other));
  RegionOptions all, any, none, not_near;
  all.all = {near, far};
  any.any = {far, near};
  none.none = {named};
  not_near.none = {near};
  EXPECT_FALSE(may(all));
  EXPECT_TRUE(may(any));
  EXPECT_FALSE(may(none));
  EXPECT_TRUE(may(not_near));  // it lies there in part only
  not_near.none[0].box = RegionBox{Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(11, 11, 11)};
  EXPECT_FALSE(may(not_near));
}

TEST(StepFaces, EveryOtherWayCutsSoundFaces) {
  for (const TopoDS_Shape& shape :
       {BRepPrimAPI_MakeCylinder(15, 40).Shape(), BRepPrimAPI_MakeSphere(20).Shape()})
    for (const RecutLength& way : kRecutWays)
      for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
        const TopoDS_Face face = TopoDS::Face(it.Current());
        GProp_GProps properties;
        BRepGProp::SurfaceProperties(face, properties);
        double area = 0;
        for (const TopoDS_Face& part : Recut(face, properties.Mass(), 0.01, 0.1, way))
          area += TriangleArea(part);
        EXPECT_NEAR(area, properties.Mass(), (way.coarse ? 0.2 : 0.01) * properties.Mass());
      }
}

TEST(StepFaces, ProgressGoesUpTo100) {
  std::vector<int> told;
  StepOptions options = FaceOptions();
  options.percent = [&](int percent) { told.push_back(percent); };
  ReadMesh(DrilledBlockStep("MM"), "part.step", options);
  ASSERT_GT(told.size(), 5u);
  EXPECT_TRUE(std::ranges::is_sorted(told));
  EXPECT_EQ(told.back(), 100);
}

TEST(StepFaces, AStopEndsTheReading) {
  StepOptions options = FaceOptions();
  options.chord_tolerance = 1e-4;
  std::stop_source stop;
  options.stop = stop.get_token();
  options.percent = [&](int) { stop.request_stop(); };
  EXPECT_THROW(ReadMesh(BallStep(20000), "part.step", options), Interrupted);
}

// Processes that run millpose-step for a parent.
std::vector<pid_t> StepProcesses(pid_t parent) {
  std::vector<pid_t> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    std::error_code none;
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const auto program = std::filesystem::read_symlink(entry.path() / "exe", none);
    std::ifstream status(entry.path() / "status");
    for (std::string line; std::getline(status, line);)
      if (line == fmt::format("PPid:\t{}", parent) && program.filename() == "millpose-step")
        found.push_back(std::stoi(name));
  }
  return found;
}

TEST(StepFaces, NothingStaysWhenTheParentIsKilled) {
  const std::string ball = BallStep(20000);
  const pid_t parent = ::fork();
  ASSERT_GE(parent, 0);
  if (parent == 0) {
    StepOptions options = FaceOptions();
    options.chord_tolerance = 1e-4;
    try {
      ReadMesh(ball, "part.step", options);
    } catch (...) {
    }
    ::_exit(0);
  }
  const auto wait_for = [](auto holds) {
    for (int i = 0; i < 500 && !holds(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return holds();
  };
  ASSERT_TRUE(wait_for([&] { return !StepProcesses(parent).empty(); }));
  const pid_t child = StepProcesses(parent)[0];
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  const auto program = std::filesystem::path("/proc") / std::to_string(child) / "exe";
  EXPECT_TRUE(wait_for([&] {
    std::error_code gone;
    return std::filesystem::read_symlink(program, gone).filename() != "millpose-step";
  }));
}

}  // namespace
}  // namespace millpose
