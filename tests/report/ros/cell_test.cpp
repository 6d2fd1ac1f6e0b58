// SPDX-License-Identifier: GPL-3.0-or-later
// A cell as URDF, read back by urdfdom and by millpose's own reader, against the cell itself.
#include <gtest/gtest.h>

#include "geometry/import/raw_mesh.hpp"
#include "machine/collision/cutter.hpp"
#include "machine/robot/joint_chain.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/report/ros/ros_cells.hpp"
#include "tests/report/ros/urdf_tree.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kMetre = 1000;                               // mm
constexpr double kJointsWithin = 1e-9, kShapesWithin = 1e-6;  // m

/// One drawn state of a cell, in its own terms and in those of its URDF.
struct DrawnState {
  DrawnState(const Cell& cell, const RosNames& names, RandomStream& random) : q(RandomJoints(random)) {
    for (const ExternalAxis& axis : cell.external_axes)
      external.push_back(random.Uniform(axis.lower, axis.upper));
    for (size_t i = 0; i < 6; ++i) joints[names.joints[i]] = q[static_cast<Eigen::Index>(i)];
    for (size_t i = 0; i < external.size(); ++i)
      joints[names.joints[6 + i]] =
          external[i] / (cell.external_axes[i].kind == AxisKind::kLinear ? kMetre : 1);
  }
  Joints q;
  ExternalPosition external;
  std::map<std::string, double> joints;
};

Pose BaseOf(const Cell& cell, const ExternalPosition& external) {
  return Mechanism(cell.external_axes).Moved(Carries::kRobot, external) * cell.X_WB;
}

/// Where a body's shape stands in W.
Pose PlaceOf(const Cell& cell, const Body& body, const DrawnState& at) {
  const Mechanism mechanism(cell.external_axes);
  switch (body.mount) {
    case Mount::kWorld:
      return body.X_MG;
    case Mount::kLink:
      return BaseOf(cell, at.external) * LinkFrames(cell.arm, at.q)[static_cast<size_t>(body.link)] *
             body.X_MG;
    case Mount::kTool:
      return BaseOf(cell, at.external) * ForwardFlange(cell.arm, at.q) * cell.X_FT * body.X_MG;
    case Mount::kWorkpiece:
      return mechanism.Moved(Carries::kWorkpiece, at.external) * cell.X_WP * body.X_MG;
    case Mount::kCarriage:
      return mechanism.MovedWith(static_cast<size_t>(body.axis), at.external) * body.X_MG;
  }
  return {};
}

double OffBy(const Eigen::Isometry3d& metres, const Pose& mm) {
  return std::max((metres.translation() - mm.translation() / kMetre).norm(),
                  (metres.linear() - mm.linear()).cwiseAbs().maxCoeff());
}

/// How far the farthest of `points` is from the nearest of `others`.
double Farthest(const std::vector<Vector3d>& points, const std::vector<Vector3d>& others) {
  double farthest = 0;
  for (const Vector3d& p : points) {
    double nearest = INFINITY;
    for (const Vector3d& other : others) nearest = std::min(nearest, (p - other).norm());
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

/// Corners of a mesh that the URDF names, in the root.
std::vector<Vector3d> CornersOf(const CellUrdf& urdf, const ReadShape& shape, const Eigen::Isometry3d& X) {
  std::vector<Vector3d> corners =
      ReadMesh(urdf.meshes.at(shape.file.substr(shape.file.rfind('/') + 1)), shape.file).triangles.vertices;
  for (Vector3d& p : corners) p = X * p;
  return corners;
}

TEST(RosCell, FramesOfEveryArmAreWhereMillposeHasThem) {
  RandomStream random(3, 0);
  for (const Arm& arm : AllArms()) {
    Cell cell;
    cell.name = arm.name;
    cell.arm = arm;
    cell.X_WB = RandomPose(random, 2000);
    cell.X_FT = RandomPose(random, 500);
    const DescribedCell described(cell);
    const UrdfTree tree(described.urdf.text);
    EXPECT_EQ(tree.Root(), "world");
    for (int k = 0; k < 200; ++k) {
      const DrawnState at(cell, described.names, random);
      const std::array<Pose, 7> frames = LinkFrames(arm, at.q);
      for (size_t i = 0; i < 6; ++i)
        ASSERT_LT(OffBy(tree.PoseOf(described.names.links[i], at.joints), cell.X_WB * frames[i + 1]),
                  kJointsWithin)
            << arm.name;
      const Pose X_WF = cell.X_WB * ForwardFlange(arm, at.q);
      ASSERT_LT(OffBy(tree.PoseOf("tool0", at.joints), X_WF), kJointsWithin) << arm.name;
      ASSERT_LT(OffBy(tree.PoseOf("tool_tip", at.joints), X_WF * cell.X_FT), kJointsWithin) << arm.name;
    }
  }
}

TEST(RosCell, BodiesStandWhereTheCellHasThemWhateverMoves) {
  RandomStream random(4, 0);
  for (const auto& [name, plain] : AllCells()) {
    const Cell cell = WithEverything(plain, random);
    const DescribedCell described(cell);
    const UrdfTree tree(described.urdf.text);
    for (int k = 0; k < 5; ++k) {
      const DrawnState at(cell, described.names, random);
      ASSERT_LT(
          OffBy(tree.PoseOf("tool0", at.joints), BaseOf(cell, at.external) * ForwardFlange(cell.arm, at.q)),
          kJointsWithin)
          << name;
      for (size_t i = 0; i < cell.bodies.size(); ++i) {
        const Body& body = cell.bodies[i];
        const Pose X_WG = PlaceOf(cell, body, at);
        const Eigen::Isometry3d X_WL = tree.PoseOf(described.names.bodies[i], at.joints);
        const std::vector<ReadShape> shapes = tree.Collisions(described.names.bodies[i]);
        ASSERT_FALSE(shapes.empty()) << body.name;
        const ReadShape& first = shapes.front();
        if (first.kind != "mesh") {
          ASSERT_LT(OffBy(X_WL * first.X_LG, X_WG),
                    std::holds_alternative<Capsule>(body.shape) ? 1 : kJointsWithin)
              << name << body.name;
        }
        if (const auto* box = std::get_if<Box>(&body.shape)) {
          EXPECT_LT((first.size - box->size / kMetre).norm(), 1e-12);
        } else if (const auto* sphere = std::get_if<Sphere>(&body.shape)) {
          EXPECT_NEAR(first.radius, sphere->radius / kMetre, 1e-12);
        } else if (const auto* c = std::get_if<Cylinder>(&body.shape)) {
          EXPECT_NEAR(first.radius, c->radius / kMetre, 1e-12);
          EXPECT_NEAR(first.length, c->length / kMetre, 1e-12);
        } else if (const auto* capsule = std::get_if<Capsule>(&body.shape)) {
          const Vector3d half(0, 0, capsule->length / 2);
          ASSERT_EQ(shapes.size(), capsule->length > 0 ? 3u : 2u);
          for (const double end : {-1, 1})
            EXPECT_TRUE(std::ranges::any_of(shapes, [&](const ReadShape& ball) {
              return ball.kind == "sphere" && std::abs(ball.radius - capsule->radius / kMetre) < 1e-12 &&
                     ((X_WL * ball.X_LG).translation() - X_WG * (end * half) / kMetre).norm() < kJointsWithin;
            })) << body.name;
        } else {
          std::vector<Vector3d> wanted;
          if (const auto* cone = std::get_if<Cone>(&body.shape)) wanted = AroundFrustum(*cone).points;
          if (const auto* convex = std::get_if<Convex>(&body.shape)) wanted = convex->points;
          if (const auto* mesh = std::get_if<Triangles>(&body.shape)) wanted = mesh->vertices;
          for (Vector3d& p : wanted) p = X_WG * p / kMetre;
          const std::vector<Vector3d> corners = CornersOf(described.urdf, first, X_WL * first.X_LG);
          EXPECT_LT(Farthest(corners, wanted), kShapesWithin) << name << " " << body.name;
          EXPECT_LT(Farthest(wanted, corners), kShapesWithin) << name << " " << body.name;
        }
        EXPECT_EQ(tree.Visuals(described.names.bodies[i]).size(), shapes.size());
      }
    }
  }
}

TEST(RosCell, LimitsAreThoseOfTheCell) {
  for (const auto& [name, cell] : AllCells()) {
    const DescribedCell described(cell);
    const std::map<std::string, ReadJoint> joints = UrdfTree(described.urdf.text).Joints();
    ASSERT_EQ(joints.size(), described.names.joints.size()) << name;
    for (size_t i = 0; i < 6; ++i) {
      const ReadJoint& joint = joints.at(described.names.joints[i]);
      const auto k = static_cast<Eigen::Index>(i);
      EXPECT_EQ(joint.type, "revolute");
      EXPECT_EQ(joint.lower, cell.arm.lower[k]);
      EXPECT_EQ(joint.upper, cell.arm.upper[k]);
      EXPECT_EQ(joint.speed, cell.arm.speed[k]);
    }
    for (size_t i = 0; i < cell.external_axes.size(); ++i) {
      const ExternalAxis& axis = cell.external_axes[i];
      const ReadJoint& joint = joints.at(described.names.joints[6 + i]);
      const double unit = axis.kind == AxisKind::kLinear ? kMetre : 1;
      EXPECT_EQ(joint.type, axis.kind == AxisKind::kLinear ? "prismatic" : "revolute");
      EXPECT_EQ(joint.lower, axis.lower / unit);
      EXPECT_EQ(joint.upper, axis.upper / unit);
      EXPECT_EQ(joint.speed, axis.speed / unit);
    }
  }
}

// Plan → URDF → millpose's own reader: an arm that moves alike, and bodies at the same places.
TEST(RosCell, MillposeReadsItsOwnUrdfAsTheSameArm) {
  RandomStream random(5, 0);
  for (const auto& [name, cell] : AllCells()) {
    const DescribedCell described(cell);
    const UrdfModel model = ReadUrdf(described.urdf.text, "cell.urdf");
    EXPECT_TRUE(model.notes.empty()) << name << ": " << fmt::format("{}", fmt::join(model.notes, "; "));
    const ChainOfLinks found = FindChain(model, kRosBase, kRosFlange);
    const DerivedArm derived = DeriveArm(found.chain, 1e-6, "cell.urdf");
    for (int k = 0; k < 100; ++k) {
      const DrawnState at(cell, described.names, random);
      const Pose again = derived.X_SB * ForwardFlange(derived.arm, at.q) * derived.X_FE,
                 wanted = ForwardFlange(cell.arm, at.q);
      ASSERT_LT((again.translation() - wanted.translation()).norm(), 1e-6) << name;
      ASSERT_LT((again.linear() - wanted.linear()).cwiseAbs().maxCoeff(), 1e-12) << name;
      const std::array<Pose, 8> frames = ChainFrames(found.chain, at.q);
      for (const AttachedLink& link : found.links) {
        const auto body = std::ranges::find(described.names.bodies, link.link.name);
        if (body == described.names.bodies.end()) continue;
        const Body& of = cell.bodies[static_cast<size_t>(body - described.names.bodies.begin())];
        if ((of.mount != Mount::kLink && of.mount != Mount::kTool) || !std::holds_alternative<Box>(of.shape))
          continue;
        DrawnState still = at;  // what carries the base is left out there
        std::ranges::fill(still.external, 0.0);
        const Pose X_BG = cell.X_WB.inverse() * PlaceOf(cell, of, still);
        const Pose read =
            frames[static_cast<size_t>(link.moves_with)] * link.X_ML * link.link.collisions.at(0).X_LG;
        ASSERT_LT((read.matrix() - X_BG.matrix()).cwiseAbs().maxCoeff(), 1e-6) << name << of.name;
      }
    }
    for (size_t i = 0; i < 6; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      EXPECT_EQ(found.chain.joints[i].lower, cell.arm.lower[k]);
      EXPECT_EQ(found.chain.joints[i].upper, cell.arm.upper[k]);
      EXPECT_EQ(found.chain.joints[i].speed, cell.arm.speed[k]);
    }
  }
}

}  // namespace
}  // namespace millpose
