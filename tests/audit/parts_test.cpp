// SPDX-License-Identifier: GPL-3.0-or-later
// What the judge is made of: laws of single points, distances, shapes, kinematics.
#include <gtest/gtest.h>

#include "audit/distance.hpp"
#include "audit/interference.hpp"
#include "audit/tessellate.hpp"
#include "base/file.hpp"
#include "tests/audit/kinematics.hpp"
#include "tests/audit/laws.hpp"

namespace millpose::audit {
namespace {

TEST(Laws, SurfaceErrorIsTheLargestOverAllForcesOfTheUncertainty) {
  Matrix3 c;
  c << 3, 0.4L, -0.7L, 0.4L, 2, 0.9L, -0.7L, 0.9L, 5;
  Folder folder;
  Row row{};
  row.normal = Vector3(1, 2, 2) / 3;
  for (const Vector3& force : {Vector3(10, -3, 2), Vector3(-4, 9, -1), Vector3(0.2L, 1, 2.4L)})
    for (const int direction : {0, 20, 90}) {
      folder.goal = {.objective = "surface_error", .uncertainty = 0.3L, .direction = direction * kDegree};
      folder.deflected[0].force = force;
      Real most = 0;
      const Vector3 aside = force.cross(Vector3::UnitX()).normalized(),
                    beside = force.normalized().cross(aside);
      for (int turn = 0; turn < 3600; ++turn)
        for (const Real off : {Real{0}, direction * kDegree / 2, direction * kDegree}) {
          const Real angle = turn * 0.1L * kDegree;
          const Vector3 side = std::cos(angle) * aside + std::sin(angle) * beside;
          const Vector3 F = 1.3L * (std::cos(off) * force + std::sin(off) * force.norm() * side);
          most = std::max(most, std::abs(row.normal.dot(c * F)));
        }
      const Real own = ObjectiveOf(folder, row, c)->value;
      EXPECT_GE(static_cast<double>(own), static_cast<double>(most) * (1 - 1e-12));
      EXPECT_LT(static_cast<double>(own), static_cast<double>(most) * 1.2);
      if (direction == 20 && own < (1.3L * force.norm() * (c * row.normal).norm()) * 0.999L) {
        EXPECT_NEAR(static_cast<double>(own), static_cast<double>(most), 1e-5 * static_cast<double>(own));
      }
    }
}

TEST(Laws, TheWallIsAcrossFeedAndAxisAndAnyIsTheLongest) {
  const Matrix3 c = Vector3(2, 3, 5).asDiagonal();
  Folder folder;
  Row row{};
  row.normal = row.axis = Vector3::UnitZ();
  row.feed_direction = Vector3::UnitX();
  folder.deflected[0].force = Vector3(0, 10, 0);
  const auto value = [&](const std::string& counted, int direction) {
    folder.goal = {.objective = "surface_error", .counted = counted, .direction = direction * kDegree};
    return static_cast<double>(ObjectiveOf(folder, row, c)->value);
  };
  EXPECT_NEAR(value("wall", 0), 30, 1e-12);
  EXPECT_NEAR(value("normal", 0), 0, 1e-12);
  EXPECT_NEAR(value("any", 0), 30, 1e-12);
  // Turned towards z, the softest, as far as it may be.
  const double off = static_cast<double>(20 * kDegree);
  EXPECT_NEAR(value("any", 20), 10 * std::hypot(3 * std::cos(off), 5 * std::sin(off)), 1e-9);
  EXPECT_NEAR(value("any", 90), 50, 1e-9);
}

TEST(Laws, ABendMayBeAQuarterMoreThanThatOfAnUnchangedRotation) {
  const Goal goal{.objective = "chen2021", .max_halfway = 5};
  EXPECT_EQ(MostHalfway(goal, 3.9L), 5);
  EXPECT_EQ(MostHalfway(goal, 8), 10);
}

TEST(Laws, OtherObjectivesByTheirDefinitions) {
  Folder folder;
  Row row{};
  row.normal = Vector3::UnitZ();
  row.axis = Vector3::UnitX();
  row.feed_direction = Vector3::UnitY();
  Matrix3 c = Vector3(2, 3, 5).asDiagonal();
  const auto value = [&](const std::string& name) {
    folder.goal.objective = name;
    return static_cast<double>(ObjectiveOf(folder, row, c)->value);
  };
  EXPECT_DOUBLE_EQ(value("normal_deflection"), 5);
  EXPECT_DOUBLE_EQ(value("drilling"), 2);
  EXPECT_DOUBLE_EQ(value("worst_in_plane"), 3);
  folder.goal.given_force = Vector3(1, 2, 4);  // along y, z and x
  EXPECT_DOUBLE_EQ(value("process_force"), std::sqrt(9.0 + 100 + 64));
  folder.goal.given_force.setZero();
  folder.deflected[0].force = Vector3(1, 0, 2);
  EXPECT_DOUBLE_EQ(value("process_force"), std::sqrt(4.0 + 100));
  folder.goal.objective = "of_another_program";
  EXPECT_FALSE(ObjectiveOf(folder, row, c));
  folder.goal.objective = "surface_error";
  row.point = 7;
  EXPECT_FALSE(ObjectiveOf(folder, row, c));
}

TEST(Distance, OfMeshesMatchesWhatIsKnown) {
  const Mesh cube = BoxMesh({10, 10, 10});
  const auto moved = [&](const Matrix4& X) {
    Mesh mesh = cube;
    for (auto& t : mesh)
      for (Vector3& p : t) p = X.block<3, 3>(0, 0) * p + X.block<3, 1>(0, 3);
    return mesh;
  };
  EXPECT_NEAR(static_cast<double>(Distance(cube, moved(Shift(13, 4, -2)), 50)), 3, 1e-12);
  EXPECT_EQ(static_cast<double>(Distance(cube, moved(Shift(9, 4, -2)), 50)), 0);
  EXPECT_EQ(static_cast<double>(Distance(cube, moved(Shift(90, 4, -2)), 50)), 50);
  // Edge over edge: both turned by 45° about axes across each other.
  const Mesh ridge = moved(Turn(0, 45 * kDegree)), across = moved(Shift(0, 0, 20) * Turn(1, 45 * kDegree));
  EXPECT_NEAR(static_cast<double>(Distance(ridge, across, 50)), 20 - 10 * std::sqrt(2.0), 1e-12);
}

TEST(Urdf, ReadByTheJudgeMovesAsItsJointsSay) {
  const UrdfArm arm = ReadUrdf(R"(<robot><!-- <joint name="x" type="fixed"><child link="a"/></joint> -->
    <joint name="j" type="revolute"><origin xyz="0 0 0.5" rpy="0 1.5707963267948966 0"/>
      <axis xyz="0 0 2"/><parent link="o"/><child link="a"/></joint>
    <joint name="f" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0.1 0 0"/></joint></robot>)",
                               "o", "b");
  ASSERT_EQ(arm.joints.size(), 2u);
  UrdfArm placed = arm;
  placed.X_WS = Shift(1, 0, 0);
  placed.X_ET = Matrix4::Identity();
  // z of the joint lies along x; at 90° its x, first downwards, looks along y.
  const Matrix4 X = UrdfTool(placed, {90 * kDegree});
  EXPECT_LT(static_cast<double>((X.block<3, 1>(0, 3) - Vector3(1, 100, 500)).norm()), 1e-12);
  EXPECT_THROW(ReadUrdf("<robot/>", "o", "b"), std::runtime_error);
}

TEST(Distance, OfAPointFromATriangle) {
  const std::array<Vector3, 3> triangle{Vector3(0, 0, 0), Vector3(4, 0, 0), Vector3(0, 4, 0)};
  EXPECT_NEAR(static_cast<double>(Distance(Vector3(1, 1, 3), triangle)), 3, 1e-15);
  EXPECT_NEAR(static_cast<double>(Distance(Vector3(2, -5, 0), triangle)), 5, 1e-15);
  EXPECT_NEAR(static_cast<double>(Distance(Vector3(-3, -4, 0), triangle)), 5, 1e-15);
  EXPECT_NEAR(static_cast<double>(Distance(Vector3(4, 4, 0), triangle)), 2 * std::sqrt(2.0), 1e-15);
}

TEST(Shapes, AreClosedAndKnowTheirInside) {
  const std::vector<Vector3> corners{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {10, 10, 0}, {5, 5, 8}};
  for (const Mesh& mesh :
       {BoxMesh({10, 20, 30}), Frustum(10, 5, 20), CapsuleMesh(10, 20), CapsuleMesh(10, 0)}) {
    EXPECT_TRUE(IsClosed(mesh));
    EXPECT_TRUE(IsInside(Vector3(1, 0.5L, 0.3L), mesh));
    EXPECT_FALSE(IsInside(Vector3(11, 0.5L, 0.3L), mesh));
  }
  EXPECT_TRUE(IsClosed(HullMesh(corners)));
  EXPECT_TRUE(IsInside(Vector3(5, 4, 2), HullMesh(corners)));
  EXPECT_FALSE(IsInside(Vector3(1, 1, 5), HullMesh(corners)));
  Mesh open = BoxMesh({1, 1, 1});
  open.pop_back();
  EXPECT_FALSE(IsClosed(open));
}

TEST(Interference, ABodyInsideAnotherTouchesIt) {
  audit::Setup setup{};
  setup.X_WB = setup.X_FT = setup.X_WP = Matrix4::Identity();
  const Matrix4 I = Matrix4::Identity();
  setup.bodies = {{"link", "spindle", 6, false, I, BoxMesh({10, 10, 10})},
                  {"hall", "fixture", -1, false, I, BoxMesh({90, 90, 90})}};
  Judge judge(setup);
  EXPECT_FALSE(judge.At({}, false, false));
  EXPECT_TRUE(judge.At({}, false, true));
  setup.excluded_pairs = {{"hall", "link"}};
  EXPECT_FALSE(Judge(setup).At({}, false, true));
}

TEST(Interference, NothingThatTheArmSweepsIsMissed) {
  // A plate of 1 mm beside the way of a link that turns through it.
  audit::Setup setup{};
  setup.sign.fill(1);
  setup.X_WB = setup.X_FT = setup.X_WP = Matrix4::Identity();
  setup.bodies = {{"link", "link", 1, false, Shift(1000, 0, 0), BoxMesh({10, 10, 10})},
                  {"plate", "fixture", -1, false, Turn(2, 0.5L) * Shift(1000, 0, 0), BoxMesh({200, 1, 200})}};
  Judge judge(setup);
  EXPECT_FALSE(judge.At({}, false, true));
  EXPECT_FALSE(judge.At({1}, false, true));
  EXPECT_TRUE(judge.Between({{}, {1}}, 0.2));
  EXPECT_FALSE(judge.Between({{1}, {2}}, 0.2));
}

TEST(Kinematics, KukaAtHomeLooksAlongX) {
  audit::Setup setup{};
  setup.sign = {-1, 1, 1, -1, 1, -1};
  setup.d1 = 1045, setup.a1 = 500, setup.a2 = 1300, setup.d4 = 1025, setup.dz = -55, setup.d6 = 290;
  setup.X_WB = setup.X_FT = Matrix4::Identity();
  // A = (0, −90, 90, 0, 0, 0): flange at (a1 + d4 + d6, 0, d1 + a2 + dz), A, B, C = 0, 90, 0.
  const Matrix4 X = Tool(setup, {0, -90 * kDegree, 90 * kDegree, 0, 0, 0});
  EXPECT_LT(static_cast<double>((X - FrameXyzAbc(1815, 0, 2290, 0, 90, 0)).norm()), 1e-12);
}
}  // namespace
}  // namespace millpose::audit
