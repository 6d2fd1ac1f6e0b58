// SPDX-License-Identifier: GPL-3.0-or-later
// A cell that names a URDF against the same cell computed joint by joint from that file.
#include <unistd.h>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/random.hpp"
#include "job/assemble.hpp"
#include "machine/robot/joint_chain.hpp"
#include "machine/robot/kinematics.hpp"
#include "machine/robot/make_pose.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {
namespace fs = std::filesystem;

constexpr const char* kCell = R"(millpose_cell: 1
name: own
arm:
  name: own
  urdf: {file: robot/arm.urdf, base_link: base_link, flange_link: tool0}
  accelerations_deg_s2: [200, 200, 200, 300, 300, 500]
  joint_stiffness_Nm_per_rad: [8.9e6, 6.78e6, 1.13e7, 2.01e6, 1.65e6, 1.35e6]
base_in_world: {xyz_mm: [100, 200, 300], abc_deg: [40, 0, 0]}
home_deg: [0, 0, 0, 0, 0, 0]
tool:
  name: spindle
  tip_in_flange_mm: [10, 20, 150]
  axis_in_flange: [0, 0, -1]
  x_in_flange: [1, 0, 0]
  cutter: {diameter_mm: 20, cutting_length_mm: 40}
  stack: [{name: cutter, class: cutter, length_mm: 60, diameter_mm: 20}]
bodies:
  - {name: plate, class: fixture, mount: base, shape: {box: {size_mm: [400, 400, 20]}}, pose: {xyz_mm: [0, 0, -10]}}
  - {name: cup, class: spindle, mount: link6, shape: {cylinder: {diameter_mm: 90, length_mm: 40}}, pose: {xyz_mm: [5, 0, 30]}}
)";

class UrdfCell : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(base_ / "robot");
    urdf_ = ReadFile(fs::path(SourceDir()) / "tests/machine/robot/turned_about.urdf");
  }
  void TearDown() override { fs::remove_all(base_); }

  static std::string With(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  CellSettings Load(const std::string& cell, const std::string& urdf) {
    WriteFileAtomically(base_ / "robot" / "arm.urdf", urdf);
    WriteFileAtomically(base_ / "cell.yaml", cell);
    bytes_.clear();
    return LoadCell(base_ / "cell.yaml", &bytes_);
  }
  std::string ErrorOf(const std::string& cell, const std::string& urdf) {
    return RefusalOf([&] { Load(cell, urdf); });
  }
  static Pose Of(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }
  static Pose PlaceOf(const Cell& cell, const Joints& angles, const std::string& name) {
    const auto links = LinkFrames(cell.arm, angles);
    for (const Body& body : cell.bodies) {
      if (body.name != name) continue;
      const Pose X_BM = body.mount == Mount::kTool ? links[6] * cell.X_FT : links[body.link];
      return cell.X_WB * X_BM * body.X_MG;
    }
    throw std::runtime_error("no body " + name);
  }

  const fs::path base_ = fs::temp_directory_path() / fmt::format("millpose_urdf_{}", ::getpid());
  std::string urdf_;
  std::map<std::string, std::string> bytes_;
};

TEST_F(UrdfCell, BodiesAndToolAreWhereTheFilesJointsPutThem) {
  // As it is, and with base and flange that are not those of a closed form.
  const std::string tilted =
      With(With(urdf_, "<origin xyz=\"0 0 0.3\" rpy=\"3.141592653589793 0 1.5707963267948966\"/>",
                "<origin xyz=\"0.3 0.1 0.2\" rpy=\"3 0.4 1.1\"/>"),
           "<origin xyz=\"-0.12 0 0\" rpy=\"0 -1.5707963267948966 0\"/>",
           "<origin xyz=\"-0.12 0.03 0.01\" rpy=\"0.2 1 2\"/>");
  for (const std::string& urdf : {urdf_, tilted}) {
    const Cell cell = MakeCell(Load(kCell, urdf), bytes_);
    const ChainOfLinks found = FindChain(ReadUrdf(urdf, "arm.urdf"), "base_link", "tool0");
    Pose X_WS = Of(100, 200, 300);
    X_WS.rotate(Eigen::AngleAxisd(DegToRad(40), Eigen::Vector3d::UnitZ()));
    RandomStream random(1, 0);
    for (int k = 0; k < 50; ++k) {
      Joints angles;
      for (double& angle : angles) angle = random.Uniform(-3, 3);
      const auto frames = ChainFrames(found.chain, angles);
      const auto expect = [&](const Pose& found_at, const Pose& wanted, const std::string& what) {
        ASSERT_LT((found_at.matrix() - wanted.matrix()).cwiseAbs().maxCoeff(), 1e-8) << what;
      };
      for (const AttachedLink& link : found.links) {
        for (size_t i = 0; i < link.link.collisions.size(); ++i) {
          const std::string name = link.link.name + (i == 0 ? "" : "_2");
          expect(PlaceOf(cell, angles, name),
                 X_WS * frames[link.moves_with] * link.X_ML * link.link.collisions[i].X_LG, name);
        }
      }
      expect(PlaceOf(cell, angles, "plate"), X_WS * Of(0, 0, -10), "plate");
      expect(PlaceOf(cell, angles, "cup"), X_WS * frames[7] * Of(5, 0, 30), "cup");
      Pose X_ET = Of(10, 20, 150);
      X_ET.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
      expect(cell.X_WB * ForwardFlange(cell.arm, angles) * cell.X_FT, X_WS * frames[7] * X_ET, "tool");
    }
    EXPECT_EQ(cell.bodies.size(), 11u);  // cutter, two of the cell, eight of the URDF
  }
}

TEST_F(UrdfCell, ResolvedCellReadsBackToTheSame) {
  const CellSettings cell = Load(kCell, urdf_);
  EXPECT_TRUE(cell.arm.urdf.file.empty());
  EXPECT_EQ(cell.arm.limits_source, "robot/arm.urdf");
  const std::string written = WriteCell(cell);
  EXPECT_EQ(WriteCell(ParseCell(written, "written")), written);
  const Cell first = MakeCell(cell, bytes_), second = MakeCell(ParseCell(written, "written"), bytes_);
  EXPECT_EQ(first.arm.offset, second.arm.offset);
  EXPECT_EQ(first.arm.d1, second.arm.d1);
}

TEST_F(UrdfCell, LimitsAndSpeedsOfTheCellGoFirst) {
  const std::string own =
      With(kCell, "  accelerations",
           "  limits_deg: [[-10, 10], [-20, 20], [-30, 30], [-40, 40], [-50, 50], [-60, 60]]\n"
           "  speeds_deg_s: [1, 2, 3, 4, 5, 6]\n  accelerations");
  const CellSettings cell = Load(own, urdf_);
  EXPECT_NEAR(cell.arm.lower[4], DegToRad(-50), 1e-15);
  EXPECT_NEAR(cell.arm.speed[5], DegToRad(6), 1e-15);
  EXPECT_EQ(Load(kCell, urdf_).arm.upper[5], 6);
  const std::string continuous = With(urdf_, "type=\"revolute\"", "type=\"continuous\"");
  EXPECT_NE(ErrorOf(kCell, continuous).find("cell.yaml:5: arm.urdf: joint 'joint_1' is continuous"),
            std::string::npos)
      << ErrorOf(kCell, continuous);
  EXPECT_EQ(ErrorOf(own, continuous), "accepted");
}

TEST_F(UrdfCell, MeshesAreFoundInTheirPackages) {
  const auto with_mesh = [&](const std::string& attributes) {
    return With(urdf_, "<box size=\"0.36 0.3 0.22\"/>", "<mesh " + attributes + "/>");
  };
  fs::create_directories(base_ / "description" / "meshes");
  WriteFileAtomically(
      base_ / "description" / "meshes" / "one.stl",
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.2 0\nendloop\n"
      "endfacet\nendsolid s\n");
  const std::string in_package = with_mesh("filename=\"package://own/meshes/one.stl\"");
  EXPECT_NE(
      ErrorOf(kCell, in_package).find("arm.urdf:9: mesh package://own/meshes/one.stl: no folder is known"),
      std::string::npos)
      << ErrorOf(kCell, in_package);
  const std::string cell =
      With(kCell, "flange_link: tool0", "flange_link: tool0, packages: {own: description}");
  const Cell made = MakeCell(Load(cell, in_package), bytes_);
  for (const Body& body : made.bodies) {
    if (body.name != "link_1") continue;
    double longest = 0;
    for (const auto& v : std::get<Triangles>(body.shape).vertices) longest = std::max(longest, v.norm());
    EXPECT_NEAR(longest, 200, 1e-9);
  }
  WriteFileAtomically(
      base_ / "description" / "meshes" / "one.stl",
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 100 0 0\nvertex 0 200 0\nendloop\n"
      "endfacet\nendsolid s\n");
  EXPECT_EQ(
      ErrorOf(kCell, with_mesh("filename=\"../description/meshes/one.stl\" scale=\"0.001 0.001 0.001\"")),
      "accepted");
  EXPECT_NE(
      ErrorOf(kCell, with_mesh("filename=\"one.stl\" scale=\"1 -1 1\"")).find("mesh scale 1 -1 1; allowed"),
      std::string::npos);
  EXPECT_NE(ErrorOf(kCell, with_mesh("filename=\"none.stl\"")).find("none.stl"), std::string::npos);
}

TEST_F(UrdfCell, LinksWithoutBodiesAndDoubleStatementsAreErrors) {
  const std::string bare =
      With(urdf_, "<collision><origin xyz=\"0.1 0 -0.11\" rpy=\"3.141592653589793 0 0\"/>", "<visual>");
  const std::string without =
      With(bare, "<geometry><box size=\"0.36 0.3 0.22\"/></geometry></collision>", "</visual>");
  EXPECT_NE(ErrorOf(kCell, without).find("cell.yaml:17: bodies: link1 has no body"), std::string::npos)
      << ErrorOf(kCell, without);
  const std::string on_purpose = kCell + std::string("interference: {unchecked_links: [link1]}\n");
  EXPECT_EQ(
      CellWarnings(Load(on_purpose, without)),
      std::vector<std::string>{"own: interference of link1 is not checked (interference.unchecked_links)"});
  EXPECT_NE(ErrorOf(on_purpose, urdf_).find("interference.unchecked_links: link1 has a body"),
            std::string::npos)
      << ErrorOf(on_purpose, urdf_);
  EXPECT_NE(ErrorOf(With(kCell, "  urdf:", "  axis_signs: [1, 1, 1, 1, 1, 1]\n  urdf:"), urdf_)
                .find("cell.yaml:5:3: arm.axis_signs: is derived from the URDF"),
            std::string::npos);
  EXPECT_NE(ErrorOf(With(kCell, "tool0}", "tol0}"), urdf_).find("nearest: tool0"), std::string::npos);
}

TEST_F(UrdfCell, NeighboursThatTouchInEveryPoseAreProposedOrTaken) {
  // Covers of links 2 and 4 that reach into each other, and one of link 5 that does not.
  const auto ball = [](const char* name, const char* mount, double x, double diameter) {
    return fmt::format(
        "  - {{name: {}, class: link, mount: {}, shape: {{sphere: {{diameter_mm: {}}}}}, pose: {{xyz_mm: "
        "[{}, 0, 0]}}}}\n",
        name, mount, diameter, x);
  };
  const std::string cell = kCell + ball("big", "link2", 0, 9000) + ball("inside", "link4", 0, 20) +
                           ball("far", "link3", 90000, 20);
  const CellSettings told = Load(cell, urdf_);
  const auto names = [](const std::string& text) {
    return text.find("'big' and 'inside' touch in each of 200 poses");
  };
  EXPECT_EQ(
      std::ranges::count_if(told.warnings, [&](const auto& w) { return names(w) != std::string::npos; }), 1);
  EXPECT_TRUE(told.excluded_pairs.empty());
  const CellSettings taken = Load(cell + "auto_excluded_pairs: true\n", urdf_);
  const std::pair<std::string, std::string> pair("big", "inside");
  EXPECT_NE(std::ranges::find(taken.excluded_pairs, pair), taken.excluded_pairs.end());
  EXPECT_FALSE(taken.auto_excluded_pairs) << "the cell that is written holds the pairs";
  for (const auto& [a, b] : taken.excluded_pairs) EXPECT_TRUE(a != "far" && b != "far");
  EXPECT_TRUE(
      std::ranges::none_of(taken.warnings, [&](const auto& w) { return names(w) != std::string::npos; }));
}

TEST_F(UrdfCell, EveryToolCountsFromTheFlangeOfTheFile) {
  const std::string one = kCell;
  const size_t begin = one.find("tool:\n"), end = one.find("bodies:\n");
  constexpr const char* kTools =
      "tools:\n  - {name: first, tip_in_flange_mm: [10, 20, 150], axis_in_flange: [0, 0, -1], x_in_flange: "
      "[1, 0, 0],\n"
      "     cutter: {diameter_mm: 20, cutting_length_mm: 40}, stack: [{name: cutter, class: cutter, "
      "length_mm: 60, "
      "diameter_mm: 20}]}\n";
  // A flange that is not that of a closed form.
  const std::string tilted = With(urdf_, "<origin xyz=\"-0.12 0 0\" rpy=\"0 -1.5707963267948966 0\"/>",
                                  "<origin xyz=\"-0.12 0.03 0.01\" rpy=\"0.2 1 2\"/>");
  const CellSettings alone = Load(one, tilted),
                     several = Load(one.substr(0, begin) + kTools + one.substr(end), tilted);
  ASSERT_EQ(several.tools.size(), 1U);
  EXPECT_GT((alone.tool.tip - Eigen::Vector3d(10, 20, 150)).norm(), 1)
      << "this file's flange is not the arm's";
  EXPECT_EQ(several.tools[0].tip, alone.tool.tip);
  EXPECT_EQ(several.tools[0].axis, alone.tool.axis);
  EXPECT_EQ(several.tools[0].x, alone.tool.x);
}

TEST_F(UrdfCell, ATableGivesTheArmOfItsLengths) {
  const std::string sample = ReadFile(fs::path(SourceDir()) / "cells/r2000ic_165f.yaml");
  const size_t begin = sample.find("  lengths_mm:"), end = sample.find("  limits_deg:");
  constexpr const char* kTable = R"(  dh:
    convention: modified
    rows:
      - {d_mm: 670}
      - {a_mm: 312, alpha_deg: -90, theta_deg: -90}
      - {a_mm: 1075, sign: -1}
      - {a_mm: 225, alpha_deg: -90, d_mm: 1280, sign: -1}
      - {alpha_deg: 90, sign: -1}
      - {alpha_deg: -90, d_mm: 215, sign: -1}
)";
  const std::string text = sample.substr(0, begin) + kTable + sample.substr(end);
  const CellSettings by_lengths = Load(sample, ""), by_table = Load(text, "");
  EXPECT_TRUE(by_table.arm.dh.rows.empty()) << "nothing after reading knows of tables";
  const Arm a = MakeArm(by_lengths.arm), b = MakeArm(by_table.arm);
  RandomStream random(4, 0);
  for (int k = 0; k < 20; ++k) {
    Joints q;
    for (int i = 0; i < 6; ++i) q[i] = random.Uniform(-2, 2);
    // The wrist centre and the axis of the flange; about it each has its own zero.
    const Pose of_a = MakePose(by_lengths.base_in_world) * ForwardFlange(a, q),
               of_b = MakePose(by_table.base_in_world) * ForwardFlange(b, q);
    EXPECT_LT((of_a.translation() - of_b.translation()).norm(), 1e-9);
    EXPECT_LT((of_a.linear().col(2) - of_b.linear().col(2)).norm(), 1e-12);
  }
  const std::string five = With(text, "      - {alpha_deg: 90, sign: -1}\n", "");
  EXPECT_NE(ErrorOf(five, "").find("given 5 rows; allowed: six"), std::string::npos) << ErrorOf(five, "");
  const std::string both =
      With(text, "  dh:", "  urdf: {file: robot/arm.urdf, base_link: a, flange_link: b}\n  dh:");
  EXPECT_NE(ErrorOf(both, "").find("given together with arm.urdf"), std::string::npos) << ErrorOf(both, "");
  const std::string lengths = With(text, "  dh:", "  axis_signs: [1, 1, 1, 1, 1, 1]\n  dh:");
  EXPECT_NE(ErrorOf(lengths, "").find("is derived from the D-H table"), std::string::npos)
      << ErrorOf(lengths, "");
  const std::string offset = With(text, "{alpha_deg: 90, sign: -1}", "{alpha_deg: 90, a_mm: 50, sign: -1}");
  EXPECT_NE(ErrorOf(offset, "").find("arm.dh: no spherical wrist"), std::string::npos) << ErrorOf(offset, "");
}

TEST_F(UrdfCell, LimitsInDegreesAreToldAsSuch) {
  const std::string degrees = With(urdf_, "lower=\"-3\" upper=\"3\"", "lower=\"-178\" upper=\"178\"");
  const std::string told = ErrorOf(kCell, degrees);
  EXPECT_NE(told.find("arm.urdf:"), std::string::npos) << told;
  EXPECT_NE(
      told.find("joint 'joint_1': limits -178 to 178 rad are 56.7 revolutions; allowed: within ±12.57 rad "
                "(±720°); are they given in degrees?"),
      std::string::npos)
      << told;
  // Where the cell says them they do not matter.
  const std::string own = With(
      kCell, "  accelerations",
      "  limits_deg: [[-10, 10], [-20, 20], [-30, 30], [-40, 40], [-50, 50], [-60, 60]]\n  accelerations");
  EXPECT_EQ(ErrorOf(own, degrees), "accepted");
}

}  // namespace
}  // namespace millpose
