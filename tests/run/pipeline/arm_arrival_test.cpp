// SPDX-License-Identifier: GPL-3.0-or-later
// What an arm from a URDF is asked when it arrives: the controller's zero, rounded angles, units, xacro.
#include <unistd.h>

#include "base/file.hpp"
#include "base/random.hpp"
#include "job/arrival.hpp"
#include "job/assemble.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {
namespace fs = std::filesystem;

constexpr const char* kArrivingCell = R"(millpose_cell: 1
name: arriving
arm:
  name: arriving
  urdf: {file: arm.urdf, base_link: base_link, flange_link: tool0}
  accelerations_deg_s2: [200, 200, 200, 300, 300, 500]
  joint_stiffness_Nm_per_rad: [8.9e6, 6.78e6, 1.13e7, 2.01e6, 1.65e6, 1.35e6]
base_in_world: {xyz_mm: [0, 0, 0], abc_deg: [0, 0, 0]}
home_deg: [0, 0, 0, 0, 0, 0]
tool:
  name: spindle
  tip_in_flange_mm: [10, 20, 150]
  axis_in_flange: [0, 0, -1]
  x_in_flange: [1, 0, 0]
  cutter: {diameter_mm: 20, cutting_length_mm: 40}
  stack: [{name: cutter, class: cutter, length_mm: 60, diameter_mm: 20}]
)";

class ArmArrives : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(base_);
    urdf_ = ReadFile(fs::path(SourceDir()) / "tests/machine/robot/upright.urdf");
  }
  void TearDown() override { fs::remove_all(base_); }

  static std::string With(std::string text, const std::string& from, const std::string& to) {
    EXPECT_NE(text.find(from), std::string::npos) << from;
    for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
    return text;
  }
  CellSettings Load(const std::string& rest, const std::string& urdf) {
    WriteFileAtomically(base_ / "arm.urdf", urdf);
    WriteFileAtomically(base_ / "cell.yaml", kArrivingCell + rest);
    bytes_.clear();
    return LoadCell(base_ / "cell.yaml", &bytes_);
  }
  std::string ErrorOf(const std::string& rest, const std::string& urdf) {
    return RefusalOf([&] { Load(rest, urdf); });
  }
  static void ExpectPart(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }

  const fs::path base_ = fs::temp_directory_path() / fmt::format("millpose_arrival_{}", ::getpid());
  std::string urdf_;
  std::map<std::string, std::string> bytes_;
};

constexpr const char* kKrl = "controllers: {krl: {tool_axis: -x}}\n";

TEST_F(ArmArrives, KukasZeroIsTheArmLevelWhateverTheUrdfsIs) {
  const CellSettings cell = Load(kKrl, urdf_);
  const PostOptions& krl = cell.controllers.at("krl").shared;
  EXPECT_EQ(krl.axis_signs, (std::array<int, 6>{-1, 1, 1, -1, 1, -1}));
  EXPECT_EQ(krl.axis_offsets, (Joints() << 0, DegToRad(-90), DegToRad(90), 0, 0, 0).finished());
  ASSERT_EQ(cell.notes.size(), 1u);
  ExpectPart(cell.notes[0], "controllers.krl: the arm's own zero has its upper arm upright, forearm level");
  // What the keys mean: the arm goes where a KUKA arm of these lengths goes by the controller's angles.
  const Arm arm = MakeArm(cell.arm);
  Arm kuka = arm;
  kuka.sign = {-1, 1, 1, -1, 1, -1};
  kuka.offset.setZero();
  const AxisConvention axes = krl.Axes();
  RandomStream random(1, 0);
  for (int k = 0; k < 50; ++k) {
    Joints shown;
    for (double& angle : shown) angle = random.Uniform(-3, 3);
    const Pose of_arm = ForwardFlange(arm, axes.ToArm(shown)), of_kuka = ForwardFlange(kuka, shown);
    EXPECT_LT((of_arm.matrix() - of_kuka.matrix()).cwiseAbs().maxCoeff(), 1e-9);
  }
  // Upper arm and forearm level and in one line at the controller's zero.
  const auto frames = LinkFrames(arm, axes.ToArm(Joints::Zero()));
  EXPECT_NEAR(frames[2].linear()(2, 0), 0, 1e-12);
  EXPECT_NEAR(frames[3].linear()(2, 0), 0, 1e-12);
}

TEST_F(ArmArrives, WhatIsTakenStandsInTheCellThatIsWritten) {
  const std::string written = WriteCell(Load(kKrl, urdf_));
  ExpectPart(written, "axis_signs: [-1, 1, 1, -1, 1, -1]");
  ExpectPart(written, "axis_offsets_deg: [0, -90, 90, 0, 0, 0]");
}

TEST_F(ArmArrives, AKukaArmsOwnCountIsItsControllers) {
  // KUKA's own URDFs: all axes 0 is the arm level.
  std::string kuka =
      With(urdf_, "<origin xyz=\"0 0 1.0\" rpy=\"0 0 0\"/>", "<origin xyz=\"1.0 0 0\" rpy=\"0 0 0\"/>");
  kuka = With(kuka, "rpy=\"0 0 0\"/><axis xyz=\"0 0 1\"/>", "rpy=\"0 0 0\"/><axis xyz=\"0 0 -1\"/>");
  kuka = With(kuka, "<axis xyz=\"1 0 0\"/>", "<axis xyz=\"-1 0 0\"/>");
  kuka = With(kuka, "rpy=\"0 1.5707963267948966 0\"/><axis xyz=\"0 0 1\"/>",
              "rpy=\"0 1.5707963267948966 0\"/><axis xyz=\"0 0 -1\"/>");
  const CellSettings cell = Load(kKrl, kuka);
  EXPECT_EQ(cell.controllers.at("krl").shared.axis_signs, (std::array<int, 6>{1, 1, 1, 1, 1, 1}));
  EXPECT_TRUE(cell.controllers.at("krl").shared.axis_offsets->isZero(0.0));
  EXPECT_TRUE(cell.notes.empty());
}

TEST_F(ArmArrives, AZeroThatGeometryDoesNotTellMustBeStated) {
  // A wrist that the file counts from elsewhere: axis 4 looks the same after half a turn.
  const std::string turned = With(urdf_, "<origin xyz=\"0.5 0 0\" rpy=\"0 0 0\"/>",
                                  "<origin xyz=\"0.5 0 0\" rpy=\"1.5707963267948966 0 0\"/>");
  const std::string error = ErrorOf(kKrl, turned);
  ExpectPart(error, "controllers.krl: axis_signs and axis_offsets_deg are missing");
  ExpectPart(error, "zero of axis 4");
  const std::string calibrated =
      With(urdf_, "<origin xyz=\"0 0 1.0\" rpy=\"0 0 0\"/>", "<origin xyz=\"0 0 1.0\" rpy=\"0 0.01 0\"/>");
  ExpectPart(ErrorOf(kKrl, calibrated), "axis 3 is off the controller's zero by");
  const std::string stated =
      "controllers: {krl: {tool_axis: -x, axis_signs: [-1, 1, 1, -1, 1, -1], axis_offsets_deg: [0, -90, 90, "
      "0, 0, 0]}}\n";
  EXPECT_EQ(ErrorOf(stated, turned), "accepted");
  const std::string half = "controllers: {krl: {tool_axis: -x, axis_signs: [-1, 1, 1, -1, 1, -1]}}\n";
  ExpectPart(ErrorOf(half, urdf_), "controllers.krl: axis_offsets_deg is missing");
}

TEST_F(ArmArrives, WhatIsStatedAgainstTheControllersZeroIsAWarning) {
  const std::string wrong =
      "controllers: {krl: {tool_axis: -x, axis_signs: [1, 1, 1, 1, 1, 1], axis_offsets_deg: [0, 0, 0, 0, 0, "
      "0]}}\n";
  const CellSettings cell = Load(wrong, urdf_);
  ASSERT_EQ(cell.warnings.size(), 1u);
  ExpectPart(cell.warnings[0], "axis_offsets_deg: [0, -90, 90, 0, 0, 0]");
}

TEST_F(ArmArrives, ControllersWithoutAZeroOfTheirOwnMustBeTold) {
  for (const std::string controller : {"sinumerik", "linuxcnc"}) {
    const std::string frame = controller == "sinumerik"
                                  ? "settable_frame: 505, stat_a5_positive: true, orientation_words: {names: "
                                    "[A2, B2, C2], group: orirpy}"
                                  : "tool_axis: z";
    const std::string error = ErrorOf(fmt::format("controllers: {{{}: {{{}}}}}\n", controller, frame), urdf_);
    ExpectPart(error, fmt::format("cell.yaml:17: controllers.{}: axis_signs and axis_offsets_deg are missing",
                                  controller));
    ExpectPart(error, "upper arm upright, forearm level");
    EXPECT_EQ(
        ErrorOf(fmt::format(
                    "controllers: {{{}: {{{}, axis_signs: [1, 1, 1, 1, 1, 1], axis_offsets_deg: [0, 0, 0, 0, "
                    "0, 0]}}}}\n",
                    controller, frame),
                urdf_),
        "accepted");
  }
}

TEST_F(ArmArrives, RightAnglesOfFewDigitsAreRightAngles) {
  for (const std::string rounded : {"1.571", "1.5708", "1.5707", "1.570796", "1.5706"}) {
    const CellSettings exact = Load("", urdf_),
                       snapped = Load("", With(urdf_, "1.5707963267948966", rounded));
    EXPECT_EQ(exact.arm.offset, snapped.arm.offset) << rounded;
    EXPECT_EQ(exact.arm.d6, snapped.arm.d6) << rounded;
    EXPECT_LT(snapped.arm.deviation.value(), 1e-9) << rounded;
    if (rounded == "1.570796") continue;  // nothing to tell
    ASSERT_EQ(snapped.notes.size(), 1u) << rounded;
    ExpectPart(snapped.notes[0], rounded + " of joints taken for a right angle (line");
  }
  // With more digits it was measured: nothing is snapped, and the tolerance decides.
  ExpectPart(ErrorOf("", With(urdf_, "\"0 1.5707963267948966 0\"", "\"0 1.57098123 0\"")),
             "arm.urdf.tolerance_mm");
}

TEST_F(ArmArrives, ARightAngleRoundedTooFarIsRefused) {
  const std::string half_turn = With(urdf_, "<origin xyz=\"0 0 0.079\" rpy=\"0 0 1.5707963267948966\"/>",
                                     "<origin xyz=\"0 0 0.079\" rpy=\"0 0 3.141\"/>");
  ExpectPart(ErrorOf("", half_turn), "joint 'link_6-tool0': its origin's rpy 3.141 is a rounded π");
  ExpectPart(ErrorOf("", half_turn), "write 3.141592653589793");
  ExpectPart(ErrorOf("", With(urdf_, "-1.5707963267948966 0 0", "-1.57 0 0")), "rpy -1.57 is a rounded −π/2");
  EXPECT_EQ(ErrorOf("", With(half_turn, "3.141", "3.0")), "accepted");
}

TEST_F(ArmArrives, LimitsInDegreesAreRefused) {
  const std::string degrees = With(urdf_, "lower=\"-3.1\" upper=\"3.1\"", "lower=\"-178\" upper=\"178\"");
  const std::string error = ErrorOf("", degrees);
  ExpectPart(error, "joint 'joint_1': limits -178 to 178 rad are 56.7 revolutions");
  WriteFileAtomically(
      base_ / "cell.yaml",
      With(kArrivingCell, "  accelerations",
           "  limits_deg: [[-178, 178], [-69, 86], [-149, 75], [-183, 183], [-120, 120], [-350, 350]]\n"
           "  accelerations"));
  WriteFileAtomically(base_ / "arm.urdf", degrees);
  EXPECT_NO_THROW(LoadCell(base_ / "cell.yaml", &bytes_)) << "the cell's own go first";
}

TEST_F(ArmArrives, MeshesInMillimetresAreRefused) {
  const auto with_mesh = [&](const std::string& scale) {
    return With(urdf_, "<box size=\"0.22 0.2 0.2\"/>", "<mesh filename=\"link.stl\"" + scale + "/>");
  };
  WriteFileAtomically(
      base_ / "link.stl",
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 200 0 0\nvertex 0 200 0\nendloop\n"
      "endfacet\nendsolid s\n");
  ExpectPart(ErrorOf("", with_mesh("")),
             "link_3 is 200 m wide with the scale 1, while the arm reaches 2.55 m: scale 0.001?");
  EXPECT_EQ(ErrorOf("", with_mesh(" scale=\"0.001 0.001 0.001\"")), "accepted");
  WriteFileAtomically(
      base_ / "link.stl",
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.2 0 0\nvertex 0 0.2 0\nendloop\n"
      "endfacet\nendsolid s\n");
  ExpectPart(ErrorOf("", with_mesh(" scale=\"0.001 0.001 0.001\"")),
             "link_3 is 0.2 mm small with the scale 0.001");
}

TEST_F(ArmArrives, PlainXacroIsExpanded) {
  const CellSettings plain = Load("", urdf_);
  std::string macro = With(urdf_, "xyz=\"0 0 1.0\"", "xyz=\"0 0 ${upper}\"");
  macro = With(macro, "<robot name=\"upright\">",
               "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:property name=\"upper\" "
               "value=\"1.0\"/>\n"
               "<xacro:macro name=\"arm\" params=\"\">");
  macro = With(macro, "</robot>", "</xacro:macro></robot>");
  WriteFileAtomically(base_ / "parts.xacro", macro);
  const std::string top =
      "<robot name=\"upright\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:include "
      "filename=\"parts.xacro\"/>\n<xacro:arm/>\n</robot>\n";
  const CellSettings expanded = Load("", top);
  EXPECT_EQ(expanded.arm.a2, plain.arm.a2);
  EXPECT_EQ(expanded.arm.offset, plain.arm.offset);
  EXPECT_EQ(expanded.bodies.size(), plain.bodies.size());
  const std::string parameters = With(top, "<xacro:arm/>", "<xacro:arm prefix=\"\"/>");
  ExpectPart(ErrorOf("", parameters),
             "arm.urdf:3: xacro: macro arm is called with parameters; expand the file with xacro first");
  ExpectPart(ErrorOf("", With(top, "parts.xacro", "$(find arm)/parts.xacro")),
             "arm.urdf:2: xacro: '$(find arm)/parts.xacro'");
  WriteFileAtomically(base_ / "parts.xacro", With(macro, "${upper}", "${2*upper}"));
  ExpectPart(ErrorOf("", top), "'${2*upper}' is no property that was defined before");
  WriteFileAtomically(base_ / "parts.xacro", With(macro, "params=\"\"", "params=\"prefix\""));
  ExpectPart(ErrorOf("", top), "macro arm has parameters");
  WriteFileAtomically(base_ / "parts.xacro", top);
  ExpectPart(ErrorOf("", top), "too deeply");
}

TEST_F(ArmArrives, TheReportSaysHowItWasUnderstood) {
  const CellSettings cell = Load(kKrl, With(urdf_, "1.5707963267948966", "1.571"));
  const ArmArrival arrival = DescribeArrival(cell, MakeCell(cell, bytes_));
  const std::string text = ToText(arrival);
  for (const char* part : {"joint_1 … joint_6, from base_link to tool0", "upper arm upright, forearm level",
                           "axes 4, 5 and 6 meet in one point", "limits              -177.617 to 177.617, ",
                           "link_3 on link3: 220 x 200 x 200 mm",
                           "krl: its angle = [-1, 1, 1, -1, 1, -1] × the arm's + [0, -90, 90, 0, 0, 0]°",
                           "1.571 of joints taken for a right angle (lines"})
    ExpectPart(text, part);
}

}  // namespace
}  // namespace millpose
