// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "tests/base/refusal.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;

RotaryAxis Carried(char letter, const Vector& direction, bool workpiece,
                   const Vector& point = Vector::Zero()) {
  return {letter, direction, point, workpiece};
}

// A machine whose C table carries the workpiece (positive angles turn it against z) and whose head swivels in
// B.
CamReadOptions TableAndHead() {
  CamReadOptions options;
  options.rotary_axes = RotaryAxes(
      {Carried('C', -Vector::UnitZ(), true, {10, 0, 0}), Carried('B', Vector::UnitY(), false, {0, 0, 200})});
  return options;
}

// Snippets name no unit: the job does.
CamPath Read(const std::string& text, CamReadOptions options = {}) {
  if (!options.unit) options.unit = 1;
  return ReadCamPath(text, "part.mpf", options);
}

std::string GcodeError(const std::string& text, const CamReadOptions& options = {}) {
  return RefusalOf([&] { Read(text, options); });
}

void ExpectNear(const Vector& a, const Vector& b, double tolerance = 1e-9) {
  EXPECT_LT((a - b).norm(), tolerance) << a.transpose() << " | " << b.transpose();
}

// The angle that the path sweeps about a line along `axis` through the centre, from point `first` on.
double Swept(const CamPath& path, size_t first, const Vector& centre, const Vector& axis) {
  double angle = 0;
  for (size_t i = first + 1; i < path.points.size(); ++i) {
    const Vector a = path.points[i - 1].position - centre, b = path.points[i].position - centre;
    const Vector u = a - axis.dot(a) * axis, v = b - axis.dot(b) * axis;
    angle += std::atan2(axis.dot(u.cross(v)), u.dot(v));
  }
  return angle;
}

TEST(Gcode, WordsAreModalAndNeedNoBlanks) {
  const CamPath path = Read(
      "%\nO0001 (PART (A))\nN10 G21G90G94\nN20 G0X1.Y-2.5Z+3 ; start\r\nG1 Z0 F600\nx5\n/Y 7\nG0 "
      "Z9\nM30\nX99\n");
  ASSERT_EQ(path.points.size(), 5u);
  ExpectNear(path.points[0].position, {1, -2.5, 3});
  ExpectNear(path.points[2].position, {5, -2.5, 0});
  ExpectNear(path.points[3].position, {5, 7, 0});
  EXPECT_TRUE(path.points[0].rapid);
  EXPECT_FALSE(path.points[1].rapid);
  EXPECT_TRUE(path.points[4].rapid);
  EXPECT_EQ(path.points[3].feed_rate, 10);
  EXPECT_EQ(path.points[3].line, 7);
  EXPECT_EQ(path.notes, std::vector<std::string>{"1 blocks that may be skipped (\"/\") were read"});
}

TEST(Gcode, StepsInchesAndFeeds) {
  const CamPath path = Read(
      "G90 G20 G0 X1 Y0 Z0\nG91 G1 X1 F10\nG90 X=IC(0.5) Y=AC(2)\nG21 X0 F=30\nG95 S1200 F0.1 X1\nG93 F2 "
      "X11\n");
  ExpectNear(path.points[0].position, {25.4, 0, 0});
  ExpectNear(path.points[1].position, {50.8, 0, 0});
  EXPECT_NEAR(path.points[1].feed_rate, 254.0 / 60, 1e-12);
  ExpectNear(path.points[2].position, {63.5, 50.8, 0});
  EXPECT_NEAR(path.points[3].feed_rate, 0.5, 1e-12);
  EXPECT_NEAR(path.points[4].feed_rate, 2, 1e-12);
  EXPECT_NEAR(path.points[5].feed_rate, 10.0 * 2 / 60, 1e-12);
  // SINUMERIK: G70 changes lengths alone, G700 feeds too.
  EXPECT_NEAR(Read("G94 G70 G0 X0 Y0 Z0\nG1 X1 F60\n").points[1].feed_rate, 1, 1e-12);
  EXPECT_NEAR(Read("G94 G700 G0 X0 Y0 Z0\nG1 X1 F60\n").points[1].feed_rate, 25.4, 1e-12);
}

TEST(Gcode, ArcsInAllPlanesByCentreAndRadius) {
  const double quarter = kPi / 2;
  struct Case {
    std::string text;
    Vector centre, axis;
    double angle;
  };
  const std::vector<Case> cases{
      {"G17 G0 X10 Y0 Z0\nG3 X0 Y10 I-10 J0 F100\n", {0, 0, 0}, Vector::UnitZ(), quarter},
      {"G17 G0 X10 Y0 Z0\nG2 X0 Y10 I-10 J0 F100\n", {0, 0, 0}, Vector::UnitZ(), -3 * quarter},
      {"G17 G0 X10 Y0 Z0\nG3 X10 Y0 I-10\n", {0, 0, 0}, Vector::UnitZ(), 4 * quarter},
      {"G18 G0 X0 Y0 Z10\nG3 X10 Z0 K-10\n", {0, 0, 0}, Vector::UnitY(), quarter},
      {"G19 G0 X0 Y10 Z0\nG3 Y0 Z10 J-10\n", {0, 0, 0}, Vector::UnitX(), quarter},
      {"G17 G0 X10 Y0 Z0\nG3 X0 Y10 R10\n", {0, 0, 0}, Vector::UnitZ(), quarter},
      {"G17 G0 X10 Y0 Z0\nG3 X0 Y10 CR=-10\n", {10, 10, 0}, Vector::UnitZ(), 3 * quarter},
      {"G17 G0 X10 Y0 Z0\nG2 X0 Y10 CR=10\n", {10, 10, 0}, Vector::UnitZ(), -quarter},
      {"G17 G0 X10 Y0 Z0\nG3 X0 Y10 I=AC(0) J=AC(0)\n", {0, 0, 0}, Vector::UnitZ(), quarter},
      {"G17 G90.1 G0 X10 Y0 Z0\nG3 X0 Y10 I0 J0\n", {0, 0, 0}, Vector::UnitZ(), quarter},
      {"G17 G0 X10 Y0 Z0\nG3 X0 Y10 Z6 I-10 J0 TURN=2\n", {0, 0, 0}, Vector::UnitZ(), 9 * quarter},
      {"G17 G91 G0 X=AC(10) Y=AC(0) Z=AC(0)\nG3 X-10 Y10 I-10 J0\n", {0, 0, 0}, Vector::UnitZ(), quarter}};
  for (const Case& c : cases) {
    const CamPath path = Read(c.text);
    EXPECT_NEAR(Swept(path, 0, c.centre, c.axis), c.angle, 1e-9) << c.text;
    for (const CamPoint& point : path.points) {
      const Vector d = point.position - c.centre;
      EXPECT_NEAR((d - c.axis.dot(d) * c.axis).norm(), 10, 1e-9) << c.text;
    }
  }
  const CamPath helix = Read(cases[10].text);
  EXPECT_NEAR(helix.points.back().position.z(), 6, 1e-12);
  const CamPoint& middle = helix.points[helix.points.size() / 2];
  EXPECT_NEAR(middle.position.z(), 3, 0.1) << "the pitch is even";
}

TEST(Gcode, ToolVectorsAndRotaryAxesGiveTheAxis) {
  const CamPath vectors = Read("TRAORI\nG1 F100 X0 Y0 Z0 A3=0 B3=0.6 C3=0.8\nX10\nX20 A3=3 C3=0\n");
  ExpectNear(vectors.points[0].axis, {0, 0.6, 0.8});
  ExpectNear(vectors.points[1].axis, {0, 0.6, 0.8});
  ExpectNear(vectors.points[2].axis, {1, 0, 0});

  const CamPath rotary = Read("TRAORI\nG0 X1 Y2 Z3 B90 C0\nG0 X4 C=DC(90)\nG0 C180\n", TableAndHead());
  ExpectNear(rotary.points[0].axis, {1, 0, 0});
  ExpectNear(rotary.points[1].axis, {0, 1, 0});
  ExpectNear(rotary.points[2].axis, {-1, 0, 0});
  ExpectNear(rotary.points[1].position, {4, 2, 3});
  EXPECT_EQ(GcodeError("G0 X0 Y0 Z0 B5\n"),
            "part.mpf:1:13: the program turns axis B, and toolpath.cam.rotary_axes does not state an axis B");
  EXPECT_EQ(GcodeError("G0 X0 Y0 Z0 B0 C0\n"), "accepted");
}

TEST(Gcode, WithoutTipProgrammingTheMachinesGeometryCounts) {
  // B about y through a pivot 200 above the tip: at 90° the tip stands 200 to −x and 200 above.
  const CamPath head = Read("G0 X0 Y0 Z0 B90\n", TableAndHead());
  ExpectNear(head.points[0].position, {-200, 0, 200});
  ExpectNear(head.points[0].axis, {1, 0, 0});
  // The table turns about (10, 0): what stands at (0, 0) in the machine is the workpiece's (10, −10) at C90,
  // by the table's sense.
  const CamPath table = Read("G0 X0 Y0 Z5 C90\n", TableAndHead());
  ExpectNear(table.points[0].position, {10, -10, 5});
  // Switching the tip programming on keeps the tip's place.
  const CamPath both = Read("G0 X0 Y0 Z0 B90\nTRAORI\nG91 G1 Z1 F100\n", TableAndHead());
  ExpectNear(both.points[1].position, {-200, 0, 201});
}

TEST(Gcode, TurningAxesBendTheWayOfTheTip) {
  CamReadOptions options = TableAndHead();
  options.chord_tolerance = 0.01;
  // The table turns under a tool that stands: an arc about (10, 0) in the workpiece frame.
  const CamPath path = Read("G0 X60 Y0 Z0 C0\nG1 C90 F100\n", options);
  ASSERT_GT(path.points.size(), 20u);
  for (size_t i = 1; i < path.points.size(); ++i) {
    const Vector &a = path.points[i - 1].position, &b = path.points[i].position;
    EXPECT_NEAR((b - Vector(10, 0, 0)).norm(), 50, 1e-9);
    EXPECT_GE(((a + b) / 2 - Vector(10, 0, 0)).norm(), 50 - 0.011);
  }
  // With tip programming the way is straight and the axis turns evenly.
  const CamPath tip = Read("TRAORI\nG0 X0 Y0 Z0 B0\nG1 X30 B30 F100\n", TableAndHead());
  ASSERT_EQ(tip.points.size(), 11u);
  for (size_t i = 0; i < tip.points.size(); ++i) {
    ExpectNear(tip.points[i].position, {3.0 * static_cast<double>(i), 0, 0});
    const double angle = DegToRad(3.0 * static_cast<double>(i));
    ExpectNear(tip.points[i].axis, {std::sin(angle), 0, std::cos(angle)});
  }
}

TEST(Gcode, FramesAreApplied) {
  // The swivelled plane of 3+2 work: the programmed z is the tool axis.
  const CamPath path = Read(
      "TRAORI\nG0 B90 C90\nTRANS X1 Y2 Z3\nAROT X-90\nAROT Z90\nG0 X0 Y0 Z10\nG1 Z0 F100\nX5\nTRANS\nG0 X0 "
      "Y0 Z0\n",
      TableAndHead());
  ASSERT_EQ(path.points.size(), 4u);
  const Vector tool = path.points[1].axis;
  ExpectNear(tool, {0, 1, 0});
  ExpectNear(path.points[0].position, Vector(1, 2, 3) + 10 * tool);
  ExpectNear(path.points[1].position, {1, 2, 3});
  EXPECT_NEAR((path.points[2].position - path.points[1].position).dot(tool), 0, 1e-12);
  EXPECT_NEAR((path.points[2].position - path.points[1].position).norm(), 5, 1e-12);
  ExpectNear(path.points[3].position, {0, 0, 0});
  // ROT X Y Z: about Z, the new Y, the new X; tool vectors turn with the frame.
  const CamPath turned = Read("ROT Z90 X90\nG0 X0 Y1 Z0 A3=0 B3=0 C3=1\n");
  ExpectNear(turned.points[0].position, {0, 0, 1});
  ExpectNear(turned.points[0].axis, {1, 0, 0});
}

TEST(Gcode, VariablesWithPlainNumbersAndMachineCoordinates) {
  const CamPath path = Read(
      "DEF REAL _HOME, _F=1200\nN1 _HOME=610. R5=-3\nSUPA G0 Z=_HOME D0\nG0 X0 Y0 Z=R5\nG1 X=-R5 F=_F\nSUPA "
      "G0 Z=_HOME\n"
      "G0 X9 Y9\nG0 Z0\n");
  ASSERT_EQ(path.points.size(), 3u);
  ExpectNear(path.points[0].position, {0, 0, -3});
  ExpectNear(path.points[1].position, {3, 0, -3});
  EXPECT_EQ(path.points[1].feed_rate, 20);
  EXPECT_TRUE(path.points[2].fresh) << "the way back from home is no cut";
  EXPECT_EQ(GcodeError("G0 X=_NOTHING\n"), "part.mpf:1:4: the variable \"_NOTHING\" has no value");
}

TEST(Gcode, UnknownWordsAreCountedOnce) {
  const CamPath path = Read(
      "G0 X0 Y0 Z0\nG1 X1 F5 M123\nMSG(\"a/b; c\")\nCYCLE832(0.1,1,1)\nG64 P0.1 T=\"MILL\" D1 "
      "M6\nCYCLE800() M123 M57\n");
  EXPECT_EQ(path.points.size(), 2u);
  EXPECT_EQ(path.notes, (std::vector<std::string>{
                            "M codes that are not known, taken for no motion: M57 (1), M123 (2)",
                            "skipped, as they say nothing about the motion: 1 CYCLE800, 1 CYCLE832, "
                            "1 D, 1 G64, 1 MSG"}));
  // All unknown words are reported at once.
  const std::string why =
      " in the file), and a word that is not known may change the path: take it out if it says nothing about "
      "the "
      "motion";
  EXPECT_EQ(GcodeError("G0 X0 Y0 Z0 Q5\nG1 X1 F5 Q6 G123\nX2 E5\n"),
            "part.mpf:1:13: \"Q\" is not known (2" + why + "\npart.mpf:2:13: \"G123\" is not known (1" + why +
                "\npart.mpf:3:4: \"E\" is not known (1" + why);
}

TEST(Gcode, WhatCannotBeReadIsToldWithItsPlace) {
  const std::string start = "G0 X0 Y0 Z0\n";
  for (const auto& [text, place] :
       {std::pair("G41 X1\n", "2:1: G41 is not read"),
        std::pair("G1 X1 G81 Z-5\n", "2:1: G81 needs R and the hole's depth"),
        std::pair("G1 X1 R5\n", "2:7: a radius without an arc"),
        std::pair("G1 X1 I5\n", "2:7: I without an arc"),
        std::pair("G1 X1 ,R5\n", "2:7: ,R is not read"),
        std::pair("G1 X1 X2\n", "2:7: X is there twice"),
        std::pair("G5 X1 I1 J1 P1 Q1\n", "2:1: G5 is a spline"),
        std::pair("LEAD=5 X1\n", "2:1: LEAD is not read"),
        std::pair("THETA=5 X1\n", "2:1: \"THETA\" is not known"),
        std::pair("TRAORI(1,0,0,1)\n", "2:1: TRAORI with a basic orientation"),
        std::pair("DIAMON\n", "2:1: \"DIAMON\" is not known"),
        std::pair("X5 M428\n", "2:4: M428 switches the machine's kinematics"),
        std::pair("  CIP X1 Y1\n", "2:3: CIP is not read"),
        std::pair("M98 P100\n", "2:1: M98: subprograms"),
        std::pair("HOLES(1)\n", "2:1: \"HOLES\" is not known: subprograms"),
        std::pair("IF R1==2 GOTOF A\n", "2:7: R1 needs a value"),
        std::pair("GOTOF MARK\n", "2:1: \"GOTOF\" is not known"),
        std::pair("L100\n", "2:1: \"L\" is not known"),
        std::pair("#1=5\n", "2:1: parameters"),
        std::pair("G1 X#1\n", "2:5: parameters"),
        std::pair("G1 X[1+2]\n", "2:5: parameters"),
        std::pair("G1 X=1+2\n", "2:6: X: expressions are not read"),
        std::pair("G1 X=SIN(2)\n", "2:6: X: expressions are not read"),
        std::pair("G1 X\n", "2:4: X needs a number"),
        std::pair("G1 X1.2.3\n", "2:5: expected a number"),
        std::pair("G1 Xnan\n", "2:4: \"XNAN\" is not known"),
        std::pair("G1 ?\n", "2:4: \"?\" begins no word"),
        std::pair("G2 X1 Y1\n", "2:1: an arc needs its centre"),
        std::pair("G2 X10 Y0 I4 J0\n", "2:1: the arc's ends lie 4 mm and 6 mm from its centre"),
        std::pair("G2 X10 Y0 R4\n", "2:1: a radius of 4 mm does not span the 10 mm"),
        std::pair("G2 X0 Y0 R4\n", "2:1: an arc by its radius needs an end that is not its start"),
        std::pair("G2 X1 Y0 I1E9\n", "2:12: exponents are not read"),
        std::pair("G2 X0 Y0 I9000000\n", "2:1: an arc's radius must be above 0"),
        std::pair("G1 X99999999\n", "2:4: 99999999 mm is beyond"),
        std::pair("G1 X1 A3=0 B3=0 C3=0\n", "2:17: the tool vector"),
        std::pair("TRANS X1 F5\n", "2:10: TRANS takes X, Y and Z alone"),
        std::pair("$P_UIFR[1]=CTRANS(X,1)\n", "2:12: $P_UIFR[1]: expressions"),
        std::pair("G1 C4=3\n", "2:4: C4 is not read"),
        std::pair("CYCLE800(0,\"TC1\",0,57)\n", "2:1: \"CYCLE800\" is not known")}) {
    const std::string error = GcodeError(start + text);
    EXPECT_EQ(error.substr(0, 9 + std::string(place).size()), "part.mpf:" + std::string(place))
        << text << error;
  }
  EXPECT_EQ(GcodeError("G93 G0 X0 Y0 Z0\nG1 X1\n"), "part.mpf:2:1: under G93 each cut needs its F");
  EXPECT_EQ(GcodeError("G1 X1 F5\n"), "part.mpf:1:1: a cut before X, Y and Z have been given in this system");
  EXPECT_EQ(GcodeError("G91 G0 X1\n"), "part.mpf:1:8: a step from a place that is not known");
  EXPECT_EQ(GcodeError("G21\nM30\n"), "part.mpf: the program holds no motion");
}

TEST(Gcode, HarmlessWordsOfPostprocessors) {
  const CamPath path = Read(
      "%\nONONAME\n%\nG05 P10000\nG0 X0 Y0 Z0\nMCALL\nG05.1 Q1\nG8 P1\nG28 U0 W0\nG5 P0\nG61.1\nG187 P3 "
      "E0.01\n"
      "M66 P0 L0 Q1\nM30 %\n");
  EXPECT_EQ(path.points.size(), 1u);
  EXPECT_EQ(GcodeError("G0 X0 Y0 Z0\nONONAME\n").substr(0, 33), "part.mpf:2:1: \"ONONAME\" is not kn");
}

TEST(Gcode, CodesOfTheKinematicsAreStatedByTheJob) {
  const std::string text = "G0 X0 Y0 Z0 B0\nM429\nG0 B90 Z0\nM428\nG1 X1 F100\n";
  CamReadOptions options = TableAndHead();
  options.kinematics_codes = {{428, true}, {429, false}};
  const CamPath coded = Read(text, options);
  ExpectNear(coded.points[1].position, {-200, 0, 200});
  ExpectNear(coded.points[2].position, {1, 0, 200});  // the switch keeps the tip's place
  options.kinematics_codes.clear();
  options.tip_programming = true;
  ExpectNear(Read(text, options).points[1].position, {0, 0, 0});
  ExpectNear(Read("G1 X5 Y0 Z0 B90 F100\n", options).points[0].position, {5, 0, 0});
  options.tip_programming = false;
  ExpectNear(Read(text, options).points[1].position, {-200, 0, 200});
  // Only one of two codes is stated.
  options.tip_programming.reset();
  options.kinematics_codes = {{429, false}};
  EXPECT_EQ(GcodeError(text, options).substr(0, 19), "part.mpf:4:1: M428 ");
  // A code is the whole number.
  options.kinematics_codes = {{429, true}};
  ExpectNear(Read("G0 X0 Y0 Z0 B0\nM429.5\nG0 B90 Z0\nG1 X1 F100\n", options).points[1].position,
             {-200, 0, 200});
}

// A call was kept for a block that came later, where it pointed to nothing.
TEST(Gcode, ACycleCallBesideADwellIsRefused) {
  EXPECT_EQ(GcodeError("G0 X0 Y0 Z50\nG4 F1 CYCLE81(10,0,2,-5)\nG0 X5\n", {}),
            "part.mpf:2:7: CYCLE81 together with a dwell in one block is not read");
}

TEST(Gcode, ToolVectorsInIJK) {
  const CamPath path = Read("G43.5 H1\nG1 F100 X0 Y0 Z0 I0 J0.6 K0.8\nX10\nI1 J0 K0 X20\nG49\n");
  ExpectNear(path.points[0].axis, {0, 0.6, 0.8});
  ExpectNear(path.points[1].axis, {0, 0.6, 0.8});
  ExpectNear(path.points[2].axis, {1, 0, 0});
  EXPECT_EQ(GcodeError("G43.5\nG1 X0 Y0 Z0 K1 F1\nG2 X5 I1\n"),
            "part.mpf:3:1: arcs under G43.5 are not read");
}

}  // namespace
}  // namespace millpose
