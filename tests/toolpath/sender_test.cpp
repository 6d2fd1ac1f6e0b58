// SPDX-License-Identifier: GPL-3.0-or-later
// Words whose meaning depends on who wrote the file: each read as its sender means it, or asked for.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "tests/base/refusal.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;

CamPath Path(const std::string& text, const CamReadOptions& options = {}) {
  return ReadCamPath(text, "path", options);
}

std::string Refusal(const std::string& text, const CamReadOptions& options = {}) {
  return RefusalOf([&] { Path(text, options); });
}

void ExpectAt(const CamPoint& point, const Vector& position, const Vector& axis) {
  EXPECT_LT((point.position - position).norm(), 1e-9) << point.position.transpose();
  EXPECT_LT((point.axis - axis).norm(), 1e-9) << point.axis.transpose();
}

CamReadOptions By(CamSender sender) {
  CamReadOptions options;
  options.sender = sender;
  return options;
}

const std::string kAutodeskHead = "MODE/MILL\nPARTNO/'P'\nUNITS/MM\nMULTAX/ON\n";
const Vector kUp = Vector::UnitZ(), kLean(0.6, 0, 0.8);

TEST(Sender, IsToldByItsMarks) {
  const auto sender = [](const std::string& text) { return Path(text).source.sender; };
  const std::string body = "UNITS/MM\nGOTO/0,0,0\nGOTO/1,0,0\n";
  EXPECT_EQ(sender("TOOL PATH/A,TOOL,B\n" + body), "NX");
  EXPECT_EQ(sender("$$*CATIA0\n" + body), "CATIA");
  EXPECT_EQ(sender("$$*         Creo Parametric CL data\n" + body), "Creo");
  EXPECT_EQ(sender("$$-> MFGNO / X\n" + body), "Creo");
  EXPECT_EQ(sender("MODE/MILL\n" + body + "MULTAX/OFF\n"), "Autodesk (HSM, Fusion)");
  EXPECT_EQ(sender("PPRINT / SolidWorks CAM 2024\n" + body), "SolidWorks CAM");
  EXPECT_EQ(sender("PPRINT/ MASTERCAM X9\n" + body), "Mastercam");
  EXPECT_EQ(sender("PARTNO/X\n" + body), "not recognised");
  EXPECT_EQ(sender("$$*CATIA0\n$$-> MFGNO / X\n" + body), "not recognised, with marks of Creo and CATIA");
  const std::string blocks = "G0 X0 Y0 Z0\nG1 X1 F100\n";
  EXPECT_EQ(sender("G21\n" + blocks), "not recognised");
  EXPECT_EQ(sender("(Post Processor: linuxcnc_post)\nG21\n" + blocks), "LinuxCNC");
  EXPECT_EQ(sender("N10 G710\nTRAORI\n" + blocks), "SINUMERIK 840D");
  EXPECT_EQ(sender("(HSMWorks)\nG71\nTRAORI\n" + blocks), "SINUMERIK 840D") << "the control tells more";
  EXPECT_EQ(sender("(MASTERCAM - X9)\nG20\n" + blocks), "Mastercam");
  EXPECT_EQ(sender("%P G71 *\nG00 X+0 Y+0 Z+0 *\nG01 X+1 F100 *\n"), "Heidenhain DIN/ISO");
  CamReadOptions options = By(CamSender::kNx);
  EXPECT_EQ(Path("PARTNO/X\n" + body, options).source.sender, "NX (by toolpath.cam.sender)");
  EXPECT_EQ(Refusal("G21\n" + blocks, options),
            "path: toolpath.cam.sender: nx writes no G-code; given such a file, it is one of autodesk, "
            "solidworks_cam, mastercam, linuxcnc, sinumerik");
}

TEST(Sender, DecidesWhatThreeNumbersMeanBehindALeaningTool) {
  const std::string body =
      "UNITS/MM\nGOTO/0,0,9,0.6,0,0.8\nGOTO/0,0,0,0.6,0,0.8\nMULTAX/OFF\nGOTO/5,0,0\nGODLTA/1,0,0\nGOTO/"
      "5,5,0,0,0,1\n";
  for (const std::string head : {"MODE/MILL\n", "$$-> MFGNO / X\n"}) {
    const CamPath path = Path(head + body);
    ExpectAt(path.points[2], {5, 0, 0}, kUp);
    ExpectAt(path.points[3], {6, 0, 0}, kUp);
    EXPECT_EQ(path.source.three_numbers, "+z");
  }
  for (const std::string head : {"TOOL PATH/A,TOOL,B\n", "$$*CATIA0\n"}) {
    const CamPath path = Path(head + body);
    ExpectAt(path.points[2], {5, 0, 0}, kLean);
    ExpectAt(path.points[3], {6, 0, 0}, kLean);
    EXPECT_EQ(path.source.three_numbers, "the axis stays");
  }
  EXPECT_EQ(
      Refusal("PARTNO/X\n" + body),
      "path:6:1: three numbers behind a leaning tool: the axis stays, or the tool stands along +z, and who "
      "wrote "
      "the file is not recognised: state whose way this file follows, toolpath.cam.sender: nx or catia (it "
      "stays), creo or autodesk (+z)");
  EXPECT_NE(Refusal("PPRINT/MASTERCAM\n" + body).find("which one Mastercam means is not known"),
            std::string::npos);
  ExpectAt(Path("PARTNO/X\n" + body, By(CamSender::kCreo)).points[2], {5, 0, 0}, kUp);
  ExpectAt(Path("PARTNO/X\n" + body, By(CamSender::kCatia)).points[2], {5, 0, 0}, kLean);
  // An axis by a word of its own, or none that leans, is no question.
  ExpectAt(Path("UNITS/MM\nTLAXIS/0.6,0,0.8\nGOTO/1,2,3\n").points[0], {1, 2, 3}, kLean);
  ExpectAt(Path("UNITS/MM\nGOTO/0,0,0,0,0,1\nGOTO/1,2,3\n").points[1], {1, 2, 3}, kUp);
}

TEST(Sender, OperationsOfNxStandOnTheirOwn) {
  const std::string first =
      "TOOL PATH/A,TOOL,B\nMSYS/9,0,0,1,0,0,0,1,0\nFEDRAT/MMPM,600\nGOTO/0,0,0,0,0,1\n"
      "GOTO/1,0,0,0.6,0,0.8\nEND-OF-PATH\nTOOL PATH/C,TOOL,B\n";
  EXPECT_EQ(
      Refusal(first + "GOTO/2,0,0\n"),
      "path:8:1: the operation states neither MSYS nor the tool axis, and the one before it had its own");
  const CamPath path = Path(first + "MSYS/0,0,0,1,0,0,0,1,0\nGOTO/2,0,0\nGOTO/3,0,0\n");
  ExpectAt(path.points[2], {2, 0, 0}, kUp);
  EXPECT_TRUE(path.points[2].fresh);
  EXPECT_EQ(path.source.sections.size(), 1u) << "the same tool";
}

TEST(Frames, OfCommentsAreEvaluatedOrRefused) {
  const std::string body = "PARTNO X\nFEDRAT/600,MMPM\nGOTO/1,2,3\nGOTO/2,2,3\n";
  const std::string catia =
      "$$*CATIA0\n$$ Program.1\n$$   0.00000 -1.00000 0.00000 250.00000\n$$   1.00000 0.00000 0.00000 "
      "0.00000\n"
      "$$   0.00000 0.00000 1.00000 40.00000\n";
  const std::string turned = "path:1:1: CATIA0 turns the axes, and whether its rows or its columns are";
  EXPECT_EQ(Refusal(catia + body).substr(0, turned.size()), turned);
  CamReadOptions given;
  given.frame = CamFrame::kStated;
  CamPath path = Path(catia + body, given);
  ExpectAt(path.points[0], {248, 1, 43}, kUp);
  EXPECT_EQ(path.source.frame, "CATIA0 in line 1");
  EXPECT_TRUE(path.keys_used.contains("frame"));
  EXPECT_EQ(Path(catia + body + "$$*CATIA0\n$$ B\n$$ 1 0 0 0\n$$ 0 1 0 0\n$$ 0 0 1 0\nGOTO/1,2,3\n", given)
                .points[2]
                .position,
            Vector(1, 2, 3))
      << "a machining axis change";
  // As CATIA's manual shows it: the same path in a system whose origin is (0, 0, 20).
  ExpectAt(
      Path("$$*CATIA0\n$$*AXS2\n$$ 1 0 0 0\n$$ 0 1 0 0\n$$ 0 0 1 20\nMULTAX/ON\nUNITS/MM\nGOTO/-40,-30,0\n")
          .points[0],
      {-40, -30, 20}, kUp);
  // Half a turn about x: rows and columns say the same.
  ExpectAt(Path("$$*CATIA0\n$$ P\n$$ 1 0 0 5\n$$ 0 -1 0 0\n$$ 0 0 -1 0\n" + body).points[0], {6, -2, -3},
           -kUp);
  given.frame = CamFrame::kAsGiven;
  path = Path(catia + body, given);
  ExpectAt(path.points[0], {1, 2, 3}, kUp);
  EXPECT_TRUE(path.keys_used.contains("frame"));
  EXPECT_EQ(Refusal("$$*CATIA0\n$$ P\n$$ 1 0 0 250\n" + body),
            "path:1:1: CATIA0 needs three rows of four numbers, found 1");
  EXPECT_EQ(Refusal("$$*CATIA0\n$$ P\n$$ 1 0 0 0\n$$ 0 2 0 0\n$$ 0 0 1 0\n" + body),
            "path:1:1: CATIA0: the axes of the matrix are no right-handed unit vectors");
  // The unit may come behind the matrix.
  EXPECT_LT((Path("$$*CATIA0\n$$ P\n$$ 1 0 0 10\n$$ 0 1 0 0\n$$ 0 0 1 0\nUNITS/INCH\nGOTO/1,2,3\n")
                 .points[0]
                 .position -
             25.4 * Vector(11, 2, 3))
                .norm(),
            1e-9);
  const std::string csys =
      "$$-> CSYS / 1.0, 0.0, 0.0, 100.0, $\n 0.0, 1.0, 0.0, 0.0, $\n 0.0, 0.0, 1.0, 0.0\n";
  EXPECT_EQ(
      Refusal(csys + body),
      "path:1:1: a comment names a system of coordinates (CSYS) that is not the file's own: state "
      "toolpath.cam.frame: as_given when the points stand in the workpiece frame as they are written, or "
      "stated when this system places them there");
  given.frame = CamFrame::kStated;
  ExpectAt(Path(csys + body, given).points[0], {101, 2, 3}, kUp);
  given.frame = CamFrame::kAsGiven;
  ExpectAt(Path(csys + body, given).points[0], {1, 2, 3}, kUp);
  EXPECT_EQ(Path("$$-> CSYS / 1, 0, 0, 0, $\n 0, 1, 0, 0, $\n 0, 0, 1, 0\n" + body).source.frame,
            "CSYS in line 1 (identity)");
  for (const std::string comment :
       {"$$ MCS/100,0,0,1,0,0,0,1,0\n", "$$ MATRIX\n$$ 1 0 0\n$$ 0 1 0\n$$ 0 0 1\n$$ 5 0 0\n",
        "$$ part WCS: 5, 0, 0\n"}) {
    EXPECT_EQ(Refusal(comment + body).substr(0, 49), "path:1:1: a comment names a system of coordinates")
        << comment;
    ExpectAt(Path(comment + body, given).points[0], {1, 2, 3}, kUp);
  }
  EXPECT_EQ(Path("$$ MCS/0,0,0,1,0,0,0,1,0\n$$ a remark of the part\n" + body).source.frame, "as written");
}

TEST(Frames, OfTheMachineMayNotChangeBetweenPoints) {
  const std::string body = "UNITS/MM\nORIGIN/1,2,3\nGOTO/0,0,0\nGOTO/1,0,0\n";
  EXPECT_EQ(Path(body + "ORIGIN/1,2,3\nGOTO/0,0,0\n").points.size(), 3u);
  const std::string changes =
      "path:5:1: ORIGIN changes between points: whether the points behind it are the "
      "workpiece's as they are written is not known.";
  EXPECT_EQ(Refusal(body + "ORIGIN/5,2,3\nGOTO/0,0,0\n").substr(0, changes.size()), changes);
  EXPECT_EQ(Refusal(body + "TRANS/0,0,5\nGOTO/0,0,0\n").substr(0, 41),
            "path:5:1: TRANS changes between points: w");
  EXPECT_EQ(Refusal("UNITS/MM\nTRANS/0,0,5\nGOTO/0,0,0\n").substr(0, 43),
            "path:2:1: TRANS shifts the points at the ma");
  CamReadOptions given;
  given.frame = CamFrame::kAsGiven;
  EXPECT_EQ(Path(body + "ORIGIN/5,2,3\nGOTO/0,0,0\n", given).points[2].position, Vector(0, 0, 0));
  for (const std::string word :
       {"ROTATE/45", "TRANSL/1,2,3", "COORD/1", "TRACUT/1,0,0,5,0,1,0,0,0,0,1,0", "ROTABL/90"})
    EXPECT_NE(Refusal(body + word + "\nGOTO/0,0,0\n"), "accepted") << word;
}

TEST(Frames, ZeroOffsetsAreStatedWhereAFileHasSeveral) {
  const std::string one = "G54\nG0 X0 Y0 Z50\nG1 Z0 F600\nY100\nG0 Z50\n", head = "G21 G90\n";
  const std::string two = head + one + "G55\nG0 X0 Y0\nG1 Z0\nY100\n";
  EXPECT_EQ(
      Refusal(two),
      "path:7:1: G55 behind cuts under G54: where the two lie to each other is known to the control alone. "
      "State toolpath.cam.offsets_mm, e.g. {G54: [0, 0, 0], G55: [250, 0, 0]}, where the zero of each lies "
      "in the workpiece frame");
  CamReadOptions options;
  options.offsets = {{"G54", {0, 0, 0}}, {"G55", {250, 0, 10}}};
  const CamPath path = Path(two, options);
  ASSERT_EQ(path.points.size(), 7u);
  ExpectAt(path.points[2], {0, 100, 0}, kUp);
  ExpectAt(path.points[4], {250, 0, 50}, kUp);  // Z stays where it is
  ExpectAt(path.points[6], {250, 100, 10}, kUp);
  EXPECT_TRUE(path.keys_used.contains("offsets_mm.G55"));
  options.offsets.erase("G54");
  EXPECT_NE(Refusal(two, options), "accepted");
  // The same again, and what the control begins with, are no second one.
  EXPECT_EQ(Path(head + one + one).points.size(), 8u);
  EXPECT_EQ(Path(head + one.substr(4) + one).points.size(), 8u);
  EXPECT_NE(Refusal("G710 G90\n" + one.substr(4) + one), "accepted") << "SINUMERIK begins with G500";
  for (const std::string other : {"G59.1", "G505", "G500", "G54.1 P2", "G154 P3"})
    EXPECT_NE(Refusal(head + one + other + "\nG0 X0 Y0 Z0\nG1 X1\n"), "accepted") << other;
  EXPECT_NE(Refusal(head + "G54.1 P1\n" + one.substr(4) + "G54.1 P2\nG0 X0 Y0 Z0\nG1 X1\n"), "accepted");
  for (const std::string shift :
       {"G92 X0", "G10 L2 P1 X5", "G52 X10", "G92.2", "$P_UIFR[1]=CTRANS(X,100)", "FRAME"})
    EXPECT_NE(Refusal(head + one + shift + "\nG0 X0 Y0 Z0\n"), "accepted") << shift;
  // G58 with coordinates: SINUMERIK's shift, or an offset and a motion.
  EXPECT_NE(Refusal(head + "G0 X0 Y0 Z0\nG58 X5 Y0\nG1 X1 F9\n").find("state toolpath.cam.sender"),
            std::string::npos);
  EXPECT_NE(Refusal("G710 G90\nG0 X0 Y0 Z0\nG58 X5\nG1 X1 F9\n").find("shifts the frame"), std::string::npos);
  EXPECT_EQ(Path("%P G71 *\nG247 Q339=+1 *\nG00 X+0 Y+0 Z+0 *\nG01 X+1 F100 *\n").points.size(), 2u);
  EXPECT_EQ(
      Refusal("%P G71 *\nG247 Q339=+1 *\nG00 X+0 Y+0 Z+0 *\nG01 X+1 F100 *\nG247 Q339=+2 *\nG01 X+0 *\n")
          .substr(0, 48),
      "path:5:1: G247 chooses preset Q339=2 behind Q339");
}

TEST(Units, AreStatedOrToldByFeeds) {
  const std::string body = "CUTTER/0.7874\nGOTO/0,0,2\nFEDRAT/24,IPM\nGOTO/0,4,0\n";
  EXPECT_EQ(Refusal("PARTNO/X\n" + body),
            "path:3:1: the file states no UNITS before its lengths, and its feeds are in IPM (line 4), and a "
            "cutter "
            "of 0.7874 would be one of 20 mm in inches: inches? State toolpath.cam.unit: mm or inch");
  CamReadOptions inch;
  inch.unit = 25.4;
  const CamPath path = Path("PARTNO/X\n" + body, inch);
  EXPECT_NEAR(path.points[1].position.y(), 101.6, 1e-9);
  EXPECT_NEAR(*path.source.sections[0].diameter, 20, 1e-3);
  EXPECT_TRUE(path.keys_used.contains("unit"));
  EXPECT_NE(Refusal("GOTO/0,0,0\nGOTO/1,0,0\n"), "accepted") << "nothing tells";
  EXPECT_NE(Refusal("CUTTER/0.5\nFEDRAT/600,MMPM\nGOTO/0,0,0\n"), "accepted")
      << "a cutter of half a millimetre";
  EXPECT_NE(Refusal("FEDRAT/600,MMPM\nGOTO/0,0,0\nFEDRAT/9,IPM\nGOTO/1,0,0\n"), "accepted") << "both";
  EXPECT_EQ(Path("FEDRAT/600,MMPM\nGOTO/0,0,0\n").source.unit, "mm, by MMPM in line 1");
  EXPECT_EQ(Path("CUTTER/20\nFEDRAT/600\nGOTO/0,0,0\n").source.unit, "mm, by the size of the cutter");
  EXPECT_EQ(Path("UNITS/INCHES\nFEDRAT/9,IPM\nGOTO/1,0,0\n").source.unit, "inches, by UNITS in line 1");
  // Cutters before UNITS are in them too; a second UNITS counts from its line on.
  EXPECT_NEAR(Path("CUTTER/0.5\nUNITS/INCHES\nGOTO/1,0,0\nUNITS/MM\nGOTO/1,0,0\n").cutters[0].diameter, 12.7,
              1e-9);
  EXPECT_NEAR(Path("UNITS/INCHES\nGOTO/1,0,0\nUNITS/MM\nGOTO/1,0,0\n").points[1].position.x(), 1, 1e-12);
  EXPECT_EQ(Refusal("G90 G0 X1 Y0 Z0\nG1 X2 F24\n"),
            "path:1: no G20, G21 (G70, G71, G700, G710) stands before the program's lengths: state "
            "toolpath.cam.unit: mm or inch, whichever the control assumes");
  EXPECT_NEAR(Path("G90 G0 X1 Y0 Z0\nG1 X2 F24\n", inch).points[1].position.x(), 50.8, 1e-9);
}

TEST(Spindle, SpeedAndSenseAreTheFiles) {
  const auto section = [](const std::string& text) { return Path(text).source.sections.at(0); };
  const auto apt = [&](const std::string& words) {
    return section("UNITS/MM\nCUTTER/20\nSPINDL/" + words + "\nRAPID\nGOTO/0,0,9\nGOTO/0,0,0\n");
  };
  for (const std::string words :
       {"12000,RPM,CCLW", "RPM,12000,CCLW", "CCLW,12000", "12000,CCLW,RPM", "RPM, CCLW, 12000"}) {
    EXPECT_NEAR(*apt(words).speed, 200, 1e-9) << words;
    EXPECT_EQ(apt(words).sense, SpindleSense::kCounterClockwise) << words;
  }
  EXPECT_EQ(apt("12000,RPM,CLW").sense, SpindleSense::kClockwise);
  EXPECT_EQ(apt("12000").sense, SpindleSense::kNotStated);
  EXPECT_NEAR(*apt("SFM,1000,CLW").speed, 304800 / (kPi * 20) / 60, 1e-9);
  EXPECT_EQ(
      Refusal("UNITS/MM\nSPINDL/SFM,1000,CLW\nGOTO/0,0,0\n"),
      "path:2:1: SPINDL gives the speed of the cutting edge, and no CUTTER before it says its diameter");
  EXPECT_EQ(Refusal("UNITS/MM\nSPINDL/FAST\nGOTO/0,0,0\n"), "path:2:8: SPINDL/\"FAST\" is not known");
  EXPECT_NE(Refusal("UNITS/MM\nSPINDL/-100,RPM\nGOTO/0,0,0\n"), "accepted");
  const auto code = [&](const std::string& words) {
    return section("G21 G0 X0 Y0 Z0\n" + words + "\nG1 X1 F100\n");
  };
  EXPECT_EQ(code("S12000 M4").ToText(), "tool not named at 12,000/min counter-clockwise");
  EXPECT_EQ(code("S12000 M3").ToText(), "tool not named at 12,000/min clockwise");
  EXPECT_EQ(code("M3 S900").ToText(), "tool not named at 900/min clockwise");
  EXPECT_EQ(code("S1=5000 M1=4").sense, SpindleSense::kCounterClockwise);
  EXPECT_NE(Refusal("G21 G0 X0 Y0 Z0\nG96 S200 M3\nG1 X1 F100\n"), "accepted") << "a speed of the edge";
  // Rapids before the spindle turns, or after it stops, are no other section.
  EXPECT_EQ(Path("G21 G0 X0 Y0 Z0\nS900 M3\nG1 X1 F9\nM5\nG0 Z9\n").source.sections.size(), 1u);
}

TEST(Sections, AreWhatOneToolCutsAtOneSpeed) {
  const std::string head =
      "UNITS/MM\nCUTTER/20\nLOADTL/1\nSPINDL/7000,RPM,CLW\nRAPID\nGOTO/0,0,50\nGOTO/0,0,0\nRAPID\nGOTO/"
      "0,0,50\n";
  const CamPath path = Path(
      head + "CUTTER/6\nLOADTL/2\nSPINDL/15000,RPM,CLW\nRAPID\nGOTO/50,0,50\nGOTO/50,0,-5\nGOTO/50,9,-5\n");
  ASSERT_EQ(path.source.sections.size(), 2u);
  EXPECT_EQ(path.source.sections[0].ToText(), "tool 1 D20 at 7,000/min clockwise");
  EXPECT_EQ(path.source.sections[1].ToText(), "tool 2 D6 at 15,000/min clockwise");
  EXPECT_EQ(path.source.sections[1].first_line, 15);
  EXPECT_EQ(path.source.sections[1].last_line, 16);
  const CamPath second = TakeSection(path, 1);
  ASSERT_EQ(second.points.size(), 3u);
  ExpectAt(second.points[0], {50, 0, 50}, kUp);
  // The same tool, loaded again, is one; another speed in the middle of a cut goes on from where it is.
  EXPECT_EQ(Path(head + "LOADTL/1\nRAPID\nGOTO/1,0,9\nGOTO/1,0,0\n").source.sections.size(), 1u);
  const CamPath faster = TakeSection(Path(head + "GOTO/0,0,1\nSPINDL/9000,RPM,CLW\nGOTO/0,0,2\n"), 1);
  ASSERT_EQ(faster.points.size(), 2u);
  EXPECT_TRUE(faster.points[0].rapid);
  ExpectAt(faster.points[0], {0, 0, 1}, kUp);
  // T names the next tool where M6 changes it.
  const std::string blocks = "G21\nT1 M6\nS9 M3\nG0 X0 Y0 Z0\nG1 X1 F9\nT2\nX2\n";
  EXPECT_EQ(Path(blocks).source.sections.size(), 1u);
  EXPECT_FALSE(Path(blocks).points[2].fresh) << "the next tool is named while this one cuts";
  EXPECT_EQ(Path(blocks + "M6\nG0 Z9\nG1 Z0\n").source.sections.size(), 2u);
  EXPECT_EQ(Path("G21\nT1\nG0 X0 Y0 Z0\nG1 X1 F9\nT2\nG0 Z9\nG1 Z0\n").source.sections.size(), 2u);
  EXPECT_EQ(Path("(T1 D=8. CR=4. - BALL)\n" + blocks).source.sections[0].ToText(),
            "tool 1 D8 at 9/min clockwise");
  EXPECT_EQ(Path("$$-> CUTTER / 8.0\n"
                 "UNITS/MM\nLOADTL / 1\nGOTO/0,0,0\nGOTO/1,0,0\n")
                .source.sections[0]
                .ToText(),
            "tool 1 D8");
  EXPECT_EQ(
      Path("G710\nT=\"A\" M6\nG0 X0 Y0 Z0\nG1 X1 F9\nT=\"B\" M6\nG0 Z9\nG1 Z0\n").source.sections.size(), 2u);
}

TEST(CyclesByPlaces, AreReadInTheirTwoOrders) {
  const std::string head = "UNITS/MM\nRAPID\nGOTO/10,10,50\n";
  for (const std::string words : {"12.0, MMPM, 120.0, 5.0", "12,120,MMPM,5", "12,MMPM,120,5,DWELL,0.5"}) {
    const CamPath path =
        Path(head + "CYCLE/DRILL, " + words + "\nFEDRAT/99,MMPM\nGOTO/10,10,0\nGOTO/40,10,0\nCYCLE/OFF\n");
    ASSERT_EQ(path.points.size(), 7u) << words;
    ExpectAt(path.points[1], {10, 10, 5}, kUp);
    ExpectAt(path.points[2], {10, 10, -12}, kUp);
    ExpectAt(path.points[3], {10, 10, 5}, kUp);
    ExpectAt(path.points[5], {40, 10, -12}, kUp);
    EXPECT_NEAR(path.points[2].feed_rate, 2, 1e-12);
    EXPECT_TRUE(path.points[1].rapid);
  }
  EXPECT_EQ(Path(head + "CYCLE/DEEP,12,INCR,8,MMPM,120,5\nGOTO/0,0,0\n").points.size(), 8u);
  // Where the order is not certain the holes are left out, and say why.
  for (const std::string words : {"12,120,5,MMPM", "12,120,5", "12,MMPM,120", "12,MMPM,120,5,RAPTO,2"})
    EXPECT_EQ(Path(head + "CYCLE/DRILL," + words + "\nGOTO/0,0,0\n").holes_left_out.size(), 1u) << words;
  EXPECT_NE(Refusal(head + "CYCLE/DRILL,-12,MMPM,120,5\nGOTO/0,0,0\n"), "accepted");
}

// Autodesk's post writes the hole's bottom, and the clearance as a height where the tool stands before.
TEST(CyclesByPlaces, AskWhichEndOfTheHoleTheirPointIs) {
  const std::string text =
      kAutodeskHead + "RAPID\nGOTO/1,2,15,0,0,1\nCYCLE/DRILL, 12.0, MMPM, 120.0, 15.0\nGOTO/1,2,-12,0,0,1\n";
  EXPECT_NE(Refusal(text).find("state toolpath.cam.cycle_point: top or bottom"), std::string::npos)
      << Refusal(text);
  CamReadOptions options;
  options.cycle_point = CyclePoint::kBottom;
  CamPath path = Path(text, options);
  ExpectAt(path.points[1], {1, 2, 15}, kUp);
  ExpectAt(path.points[2], {1, 2, -12}, kUp);
  EXPECT_TRUE(path.keys_used.contains("cycle_point"));
  options.cycle_point = CyclePoint::kTop;
  path = Path(text, options);
  ExpectAt(path.points[1], {1, 2, 3}, kUp);
  ExpectAt(path.points[2], {1, 2, -24}, kUp);
  EXPECT_EQ(Path("$$*CATIA0\n" + text.substr(text.find("UNITS"))).points.size(), 4u) << "CATIA's is the top";
}

TEST(Arcs, TurnAsOftenAsTheyAreTold) {
  const auto swept = [](const CamPath& path) {
    double angle = 0;
    for (size_t i = 1; i < path.points.size(); ++i) {
      const Vector &a = path.points[i - 1].position, &b = path.points[i].position;
      angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
    }
    return angle;
  };
  const std::string start = "UNITS/MM\nGOTO/10,0,0\n";
  EXPECT_NEAR(swept(Path(start + "MOVARC/0,0,0, 0,0,1, 10, ANGLE, 90.0\nGOTO/0,10,-1\n")), kPi / 2, 1e-9);
  EXPECT_NEAR(swept(Path(start + "MOVARC/0,0,0,0,0,-1,10,ANGLE,270\nGOTO/0,10,-1\n")), -3 * kPi / 2, 1e-9);
  EXPECT_NEAR(swept(Path(start + "MOVARC/0,0,0,0,0,1,10,ANGLE,1170\nGOTO/0,10,-9\n")), 6.5 * kPi, 1e-9);
  EXPECT_NEAR(swept(Path(start + "MOVARC/0,0,0,0,0,1,10,ANGLE,720\nGOTO/10,0,-9\n")), 4 * kPi, 1e-9);
  EXPECT_NE(Refusal(start + "MOVARC/0,0,0,0,0,1,10,ANGLE,100\nGOTO/0,10,-9\n"), "accepted");
  const std::string block = "G21 G17\nG0 X10 Y0 Z0\n";
  EXPECT_NEAR(swept(Path(block + "G3 X0 Y10 Z-9 I-10 J0 P3 F9\n")), 4.5 * kPi, 1e-9);
  EXPECT_NEAR(swept(Path(block + "G2 X10 Y0 Z-9 I-10 J0 P2 F9\n")), -4 * kPi, 1e-9);
  EXPECT_NEAR(swept(Path(block + "G3 X0 Y10 I-10 J0 P1 F9\n")), kPi / 2, 1e-9);
  EXPECT_NEAR(swept(Path("G710 G17\nG0 X10 Y0 Z0\nG3 X0 Y10 Z-9 I-10 J0 TURN=2 F9\n")), 4.5 * kPi, 1e-9);
  EXPECT_NE(Refusal(block + "G3 X0 Y10 I-10 J0 P1.5 F9\n"), "accepted");
  EXPECT_NE(Refusal(block + "G3 X0 Y10 Z-9 I-10 J0 K-3 F9\n"), "accepted") << "a rise for each turn";
  EXPECT_EQ(Refusal(block + "G3 X0 Y10 Z-9 I-10 J0 K0 F9\n"), "accepted");
  EXPECT_NE(Refusal("G710 G17\nG0 X10 Y0 Z0\nG3 X0 Y10 I-10 J0 P2 F9\n"), "accepted") << "SINUMERIK has no P";
}

}  // namespace
}  // namespace millpose
