// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/cam_path.hpp"

#include "base/error.hpp"
#include "base/file.hpp"
#include "geometry/import/mesh_import.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/cam_writer.hpp"
#include "tests/toolpath/with.hpp"
#include "toolpath/cam/cam_import.hpp"
#include "toolpath/make_toolpath.hpp"

namespace millpose {
namespace {

// Snippets name no unit: the job does, for the formats that it can name it for.
CamPath Apt(const std::string& text) {
  CamReadOptions options;
  if (!text.starts_with("x_")) options.unit = 1;
  return ReadCamPath(text, "path.cls", options);
}

std::string AptError(const std::string& text) {
  return RefusalOf([&] { Apt(text); });
}

TEST(Apt, AxesAreModalAndRapidHoldsOnce) {
  const CamPath path =
      Apt("GOTO / 1.0, 2., .5, 0,0,2\r\nrapid/\r\nGoto/4,5,6\r\nGOTO/7,8,9,1,0,0 $$ comment\r\n");
  ASSERT_EQ(path.points.size(), 3);
  EXPECT_EQ(path.points[0].position, Eigen::Vector3d(1, 2, 0.5));
  EXPECT_EQ(path.points[1].axis, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(path.points[2].axis, Eigen::Vector3d::UnitX());
  EXPECT_FALSE(path.points[0].rapid);
  EXPECT_TRUE(path.points[1].rapid);
  EXPECT_FALSE(path.points[2].rapid);
  EXPECT_EQ(path.points[2].line, 4);
}

TEST(Apt, FeedsInAllOrdersAndUnits) {
  const CamPath path =
      Apt("FEDRAT/600.0,MMPM\nGOTO/0,0,0\nFEDRAT/MMPM,1200\nGOTO/1,0,0\nFEDRAT/10,IPM\nGOTO/2,0,0\n"
          "SPINDL/RPM,3000,CLW\nFEDRAT/MMPR,0.1\nGOTO/3,0,0\nFEDRAT/0.01,IPR\nGOTO/4,0,0\nFEDRAT/90\nGOTO/"
          "5,0,0\nFEDRAT/60,PERMIN\nGOTO/6,0,0\n");
  const std::array<double, 7> expected{10, 20, 254.0 / 60, 5, 12.7, 1.5, 1};
  for (size_t i = 0; i < 7; ++i) EXPECT_NEAR(path.points[i].feed_rate, expected[i], 1e-12) << i;
}

TEST(Apt, InchesContinuedLinesSequenceNumbersAndDeltas) {
  std::string card = "GOTO/1,0,0";
  card.resize(72, ' ');
  const CamPath path = Apt("UNITS/INCHES\nGOTO/1,2,$\n3\n" + card + "00000030\nGODLTA/0,0,1\nGODLTA/2\n");
  EXPECT_EQ(path.points[0].position, 25.4 * Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(path.points[1].position, 25.4 * Eigen::Vector3d(1, 0, 0));
  EXPECT_LT((path.points[2].position - 25.4 * Eigen::Vector3d(1, 0, 1)).norm(), 1e-12);
  EXPECT_LT((path.points[3].position - 25.4 * Eigen::Vector3d(1, 0, 3)).norm(), 1e-12);
}

TEST(Apt, InverseTimesAreRefusedOriginsAreTheMachinesAndTracutMustBeOver) {
  EXPECT_EQ(AptError("GOTO/0,0,0\nFEDRAT/INVERS,12.5\nGOTO/1,0,0\n"),
            "path.cls:2:8: FEDRAT/INVERS with a value is not read: let the CAM system write feeds per minute "
            "or per "
            "revolution (MMPM, IPM, MMPR, IPR)");
  EXPECT_EQ(AptError("GOTO/0,0,0\nFEDRAT/12.5,INVERS\nGOTO/1,0,0\n").substr(0, 13), "path.cls:2:13");
  const CamPath path =
      Apt("FEDRAT/600,MMPM\nFEDRAT/INVERS,AUTO\nORIGIN/100,200,300\nTRACUT/NOMORE\nGOTO/1,2,3\n"
          "TRANS/0,0,0\nGOTO/4,5,6\n");
  EXPECT_EQ(path.points[0].feed_rate, 10);
  EXPECT_EQ(path.points[0].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(path.points[1].position, Eigen::Vector3d(4, 5, 6));
  const std::vector<std::string> notes{
      "2 ORIGIN or TRANS: where the machine's zero lies; the points are taken in the part's system as given",
      "skipped, as they say nothing about the motion: 1 TRACUT"};
  EXPECT_EQ(path.notes, notes);
  EXPECT_EQ(AptError("ORIGIN/A,B\nGOTO/1,2,3\n"), "path.cls:1:8: ORIGIN needs numbers, found \"A\"");
  EXPECT_EQ(AptError("TRACUT/1,0,0,5,0,1,0,0,0,0,1,0\nGOTO/1,2,3\n"),
            "path.cls:1:1: TRACUT is not read: let the CAM system write the points as they are milled");
}

TEST(Apt, LoadedToolsCommentsAndSilentWords) {
  const CamPath path =
      Apt("$$ a comment / GOTO/9,9,9\nPARTNO/P1\nLOADTL/1\nMULTAX/ON\nCOOLNT/ON\nGOTO/0,0,0 $$ GOTO/8,8,8\n"
          "UNITS/MM\nTOOLNO/2\nGOTO/5,0,0\nSTOP\nFINI\n");
  ASSERT_EQ(path.points.size(), 2);
  EXPECT_FALSE(path.points[0].rapid);
  EXPECT_TRUE(path.points[1].fresh);  // the way to another tool is no cut
  const std::vector<std::string> notes{
      "2 tool changes",
      "skipped, as they say nothing about the motion: 1 COOLNT, 1 FINI, 1 MULTAX, 1 PARTNO, 1 STOP"};
  EXPECT_EQ(path.notes, notes);
}

TEST(CamPath, PointsBeyondReachAreRefusedInEveryFormat) {
  const auto error = [](const std::string& text) {
    const std::string what = AptError(text);
    return what.substr(0, what.find(" (") + 2);
  };
  EXPECT_EQ(error("GOTO/0,0,0\nGOTO/0,0,1.1E9\n"), "path.cls:2: the point (");
  EXPECT_EQ(error("GOTO/0,0,0\nGODLTA/0,0,1E9\nGODLTA/0,0,1E9\n"), "path.cls:3: the point (");
  EXPECT_EQ(error("x_m,y_m,z_m\n1,2,3\n1E7,0,0\n"), "path.cls:3: the point (");
  EXPECT_EQ(AptError("G1 X0 Y0 Z0 F100\nX9999999999\n").substr(0, 13), "path.cls:2:1:");
}

// The angle that the path sweeps about the z axis through the origin, rad.
double Swept(const CamPath& path) {
  double angle = 0;
  for (size_t i = 1; i < path.points.size(); ++i) {
    const Eigen::Vector3d &a = path.points[i - 1].position, &b = path.points[i].position;
    angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
  }
  return angle;
}

TEST(Apt, CirclesAreExpandedWithinTheTolerance) {
  const CamPath path = Apt("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,4\n");
  EXPECT_EQ(path.notes, std::vector<std::string>{"1 CIRCLE expanded by the chord tolerance"});
  ASSERT_GT(path.points.size(), 10);
  for (size_t i = 0; i < path.points.size(); ++i) {
    const Eigen::Vector3d& p = path.points[i].position;
    EXPECT_NEAR(p.head<2>().norm(), 10, 1e-9);
    EXPECT_GE(p.x(), -1e-9);  // the quarter, not the other three
    if (i > 0) {
      EXPECT_GE((p + path.points[i - 1].position).head<2>().norm() / 2, 10 - 0.01);
    }
  }
}

TEST(Apt, CirclesGoTheWayThatTheirSystemMeans) {
  const double quarter = kPi / 2;
  // The plain form is right-handed about its axis.
  EXPECT_NEAR(Swept(Apt("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\n")), quarter, 1e-9);
  EXPECT_NEAR(Swept(Apt("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,-1\nGOTO/0,10,0\n")), -3 * quarter, 1e-9);
  // NX's form is clockwise about its axis.
  EXPECT_NEAR(Swept(Apt("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,-1,10,0.06,0.5,30,0\nGOTO/0,10,0\n")), quarter, 1e-9);
  EXPECT_NEAR(Swept(Apt("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10,0.06,0.5,30,0\nGOTO/0,10,0\n")), -3 * quarter,
              1e-9);
  EXPECT_NEAR(Swept(Apt("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10,0.06,0.5,30,0\nGOTO/10,0,0\n")), -4 * quarter,
              1e-9);
  EXPECT_NEAR(Swept(Apt("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,-1,10,0.06,0.5,30,0,TIMES,2\nGOTO/10,0,-2\n")),
              8 * quarter, 1e-9);
  // INDIRV is the tangent at the start, also for the plain form.
  EXPECT_NEAR(Swept(Apt("GOTO/10,0,0\nINDIRV/0,-1,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\n")), -3 * quarter,
              1e-9);
  // A bore of 355 degrees is no short straight way.
  EXPECT_NEAR(Swept(Apt("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/9.961947,-0.871557,0\n")), DegToRad(355),
              1e-6);
  EXPECT_EQ(
      AptError("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,12,0\n"),
      "path.cls:2:1: the points before and after the circle lie 10 mm and 12 mm from its axis, its radius "
      "is 10 mm");
  EXPECT_EQ(AptError("GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10,0.06,0.5,30,0,TIMES,0\nGOTO/10,0,0\n"),
            "path.cls:2:43: TIMES needs a whole number from 1 to 1000");
}

TEST(Apt, TangentAndSignOfACircleMustAgree) {
  const double quarter = kPi / 2;
  // The cut before runs on clockwise, within 5 degrees or not.
  const std::string within = "GOTO/10.8,10,0\nGOTO/10,0,0\n", beside = "GOTO/11,10,0\nGOTO/10,0,0\n";
  const std::string circle = "CIRCLE/0,0,0,0,0,1,10\n", to = "GOTO/0,-10,0\n";
  const auto from = [](const std::string& start) { return Swept(Apt(start)); };
  EXPECT_NEAR(Swept(Apt(beside + circle + to)) - from(beside), 3 * quarter, 1e-9);
  EXPECT_EQ(
      AptError(within + circle + to),
      "path.cls:3:1: the cut before runs on into the clockwise turn about the circle's axis, the axis's "
      "sign says counter-clockwise: state toolpath.cam.circle: tangent or axis, whichever holds in this "
      "file");
  CamReadOptions options;
  options.circle = CircleSense::kTangent;
  EXPECT_NEAR(Swept(ReadCamPath("UNITS/MM\n" + within + circle + to, "x", options)) - from(within), -quarter,
              1e-9);
  options.circle = CircleSense::kAxis;
  EXPECT_NEAR(Swept(ReadCamPath("UNITS/MM\n" + within + circle + to, "x", options)) - from(within),
              3 * quarter, 1e-9);
  // A rapid to the start says nothing, and neither does the tangent of half and full revolutions.
  EXPECT_NEAR(Swept(Apt("RAPID\nGOTO/10,5,0\nRAPID\nGOTO/10,0,0\n" + circle + to)) + std::atan2(5, 10),
              3 * quarter, 1e-9);
  for (const double sign : {1.0, -1.0})
    for (const auto& [end, angle] : {std::pair("-10,0,0", 2 * quarter), std::pair("10,0,0", 4 * quarter)})
      EXPECT_NEAR(
          Swept(Apt(fmt::format("{}CIRCLE/0,0,0,0,0,{},10\nGOTO/{}\n", within, sign, end))) - from(within),
          sign * angle, 1e-9);
  // The direction at an arc's end, not that of its last chord.
  EXPECT_NEAR(
      Swept(Apt("GOTO/0,1,0\nCIRCLE/0,0,0,0,0,-1,1\nGOTO/1,0,0\nCIRCLE/0,0,0,0,0,-1,1\nGOTO/0,-1,0\n")),
      -2 * quarter, 1e-9);
}

TEST(Apt, ReadsTheCirclesOfCatia) {
  const double quarter = kPi / 2;
  const std::string start =
      "GOTO/10,0,5\nINDIRV/ 0.0, -1.0, 0.0\nTLON,GOFWD/ (CIRCLE/ 0.0, 0.0, 5.0,$\n  10.0)";
  EXPECT_NEAR(Swept(Apt(start + ",ON,(LINE/ 0,0,5,$\n -10,0,5)\nGOTO/-10,8,5\n")),
              -2 * quarter - std::atan2(8, 10), 1e-9);
  const CamPath whole = Apt(start + ",ON,2,INTOF,$\n(LINE/ 0,0,5,10,0,5)\n");
  EXPECT_NEAR(Swept(whole), -4 * quarter, 1e-9);
  EXPECT_EQ(whole.points.back().position, Eigen::Vector3d(10, 0, 5));
  EXPECT_EQ(AptError("GOTO/10,0,0\nTLON,GOFWD/(CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,10,0)\n"),
            "path.cls:2:1: the circle needs an INDIRV before it that is not radial");
  EXPECT_EQ(AptError("GOTO/10,0,0\nINDIRV/0,1,0\nTLON,GOFWD/(CYLNDR/0,0,0,10),ON,(LINE/0,0,0,0,10,0)\n")
                .substr(0, 49),
            "path.cls:3:12: the motion \"TLON,GOFWD\" cannot be ");
  EXPECT_EQ(AptError("GOTO/10,0,0\nGOLFT/L1,PAST,L2\n").substr(0, 34),
            "path.cls:2:7: the motion \"GOLFT\" c");
}

TEST(Apt, NamesItsCutters) {
  const CamPath path =
      Apt("TLDATA/MILL,30.0,2.0,75.0,0,0\nGOTO/0,0,0\nUNITS/INCHES\nCUTTER/1.0\nSPINDL/SMM,120,CLW\n"
          "FEDRAT/PERREV,0.01\nGOTO/1,0,0\n");
  ASSERT_EQ(path.cutters.size(), 2);
  EXPECT_EQ(path.cutters[0].diameter, 30);
  EXPECT_EQ(path.cutters[0].corner_radius, 2);
  EXPECT_EQ(path.cutters[1].diameter, 25.4);
  EXPECT_NEAR(path.points[1].feed_rate, 0.254 * 120e3 / (kPi * 25.4) / 60, 1e-9);
}

TEST(Apt, CoordinateSystemsAreApplied) {
  const CamPath path = Apt("MSYS/100,0,0,0,1,0,-1,0,0\nGOTO/1,2,3,1,0,0\n");
  EXPECT_LT((path.points[0].position - Eigen::Vector3d(98, 1, 3)).norm(), 1e-12);
  EXPECT_LT((path.points[0].axis - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(path.notes.size(), 1);
}

TEST(Apt, UnknownWordsAreCountedAndMotionsMustBeReadable) {
  const CamPath path =
      Apt("PPRINT OPERATION "
          "1\nPAINT/PATH\nPAINT/TOOL\nGOTO/0,0,0\nGOTO/2,0,0\n");
  EXPECT_EQ(path.points.size(), 2);
  EXPECT_EQ(path.notes,
            std::vector<std::string>{"skipped, as they say nothing about the motion: 2 PAINT, 1 PPRINT"});
  // All unknown words are reported at once, with the error that ended the reading.
  EXPECT_EQ(
      AptError("WHATEVER/1\nGOTO/0,0,0\nROTHED/1\nWHATEVER/2\nGOTO/1\n"),
      "path.cls:1:1: \"WHATEVER\" is not known (2 in the file), and a word that is not known may change the "
      "path: take it out if it says nothing about the motion\n"
      "path.cls:3:1: \"ROTHED\" is not known (1 in the file), and a word that is not known may change the "
      "path: take it out if it says nothing about the motion\n"
      "path.cls:5:1: GOTO needs 3 to 6 numbers, found 1");
  for (const std::string word :
       {"CUTCOM/LEFT,1", "INSERT/G01 X5", "INSERT/M428", "PREFUN/41", "ROTABL/45", "COPY/1"})
    EXPECT_EQ(AptError("GOTO/0,0,0\n" + std::string(word) + "\n").substr(0, 13), "path.cls:2:1:") << word;
  EXPECT_EQ(AptError("GOTO/1,2\n"), "path.cls:1:1: GOTO needs 3 to 6 numbers, found 2");
  EXPECT_EQ(AptError("GOTO/0,0,0\n  GOTO/1, 2x,3\n"), "path.cls:2:11: GOTO needs numbers, found \"2X\"");
  EXPECT_EQ(AptError("GOTO/0,0,$\n nan\n"), "path.cls:2:2: GOTO needs numbers, found \"NAN\"");
  EXPECT_EQ(AptError("GOTO/0,0,0,0,0,0\n"), "path.cls:1:12: the direction has no length");
  EXPECT_EQ(AptError("GOTO/0,0,0\nCIRCLE/0,0,0,0,0,1,5\n"),
            "path.cls:2:1: a CIRCLE is not followed by the GOTO that it leads to");
  EXPECT_EQ(AptError("GOTO/0,0,0\nCIRCLE/1E9,0,0,0,0,1,1E9\nGOTO/0,0,1\n"),
            "path.cls:2:1: the circle's radius of 1e+09 mm is above 1000000 mm");
  EXPECT_EQ(AptError("GOTO/1E6,0,0\nCIRCLE/0,0,0,0,0,1,1E6,0.06,0.5,30,0,TIMES,1000\nGOTO/1E6,0,9\n"),
            "path.cls:2:1: an arc of more than 1000000 points: is the chord tolerance of 0.01 mm meant?");
  std::string many = "GOTO/1E6,0,0\n";
  for (int i = 0; i < 200; ++i) many += "CIRCLE/0,0,0,0,0,1,1E6,0.06,0.5,30,0\nGOTO/1E6,0,0\n";
  EXPECT_NE(AptError(many).find("the path has more than 2000000 points"), std::string::npos);
  EXPECT_EQ(AptError("FINI\n"), "path.cls: the file holds no GOTO");
  EXPECT_EQ(AptError("UNITS/FEET\n").substr(0, 14), "path.cls:1:1: ");
}

TEST(CamCsv, ReadsUnitsSeparatorsAndPasses) {
  const CamPath path =
      ReadCamPath("x_in;y_in;z_in;i;j;k;feed_mm_min;pass;note\n1,5;0;0;0;0;2;600;1;7\n2;0;0;0;0;1;600;2;8\n",
                  "a.csv", {});
  EXPECT_EQ(path.points[0].position.x(), 1.5 * 25.4);
  EXPECT_EQ(path.points[0].axis, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(path.points[0].feed_rate, 10, 1e-12);
  EXPECT_TRUE(path.points[1].fresh);
  EXPECT_EQ(path.notes,
            std::vector<std::string>{"skipped, as they say nothing about the motion: 1 column note"});
}

TEST(CamCsv, TellsThePlaceOfErrors) {
  EXPECT_EQ(AptError("x_mm,y_mm,z_mm,a_deg,b_deg\n1,2,3,4,5\n"),
            "path.cls:1:16: \"column a_deg\" is not known (1 in the file), and a word that is not known may "
            "change the "
            "path: take it out if it says nothing about the motion\n"
            "path.cls:1:22: \"column b_deg\" is not known (1 in the file), and a word that is not known may "
            "change the "
            "path: take it out if it says nothing about the motion");
  EXPECT_EQ(AptError("x_mm,y_mm,z_mm,rapid\n1,2,3,2\n"), "path.cls:2:1: rapid is 0 or 1, found 2");
  EXPECT_EQ(AptError("x_mm,y_mm,z_mm\n1,2,3\n1,b,3\n"),
            "path.cls:3:3: expected a finite number, found \"b\"");
  EXPECT_EQ(AptError("x_mm,y_mm,z_mm\n1,2\n"), "path.cls:2:1: 2 values, the header names 3 columns");
  EXPECT_EQ(AptError("x_mm,y_mm\n1,2\n"), "path.cls:1:1: the header names no column z_mm (or z_m, z_in)");
  EXPECT_EQ(AptError("x_mm,y_mm,z_mm,i\n"), "path.cls:1:1: the tool axis needs all of the columns i, j, k");
}

TEST(CamPath, FilesThatAreNoToolPathSayWhatTheySeemToBe) {
  const auto guess = [](const std::string& text) {
    const std::string what = AptError(text);
    const size_t at = what.find("seems to be ");
    return at == std::string::npos ? what : what.substr(at + 12, what.find(';') - at - 12);
  };
  EXPECT_EQ(guess("&ACCESS RVP\nDEF PART( )\nLIN {X 1,Y 2,Z 3}\nEND\n"), "a KRL program (KUKA)");
  EXPECT_EQ(guess("DEF PART( )\nPTP HOME\n  SLIN {X 1,Y 2,Z 3}\nEND\n"), "a KRL program (KUKA)");
  EXPECT_EQ(guess("MODULE M\n PROC main()\n MoveL p10;\n ENDPROC\nENDMODULE\n"), "a RAPID program (ABB)");
  EXPECT_EQ(guess("0 BEGIN PGM PART MM\n1 L X+0 FMAX\n"), "a Heidenhain program in conversational form");
  EXPECT_EQ(guess("ISO-10303-21;\nHEADER;\n"), "a STEP model");
  EXPECT_EQ(guess("solid x\n facet normal 0 0 1\n"), "an STL mesh");
  EXPECT_EQ(guess("<?xml version=\"1.0\"?>\n"), "an XML file");
  EXPECT_EQ(guess(std::string("PK\x03\x04\0\0", 6)), "a ZIP archive");
  EXPECT_EQ(guess(std::string("\x01\0\x02", 3)), "a binary file");
  EXPECT_EQ(guess(" \n"), "an empty file");
  EXPECT_EQ(guess("L1=LINE/P1,P2\nGOLFT/L1,PAST,L2\n"),
            "an APT part program, which an APT processor has to turn into CLDATA first");
  EXPECT_EQ(guess("PARTNO/X\nFINI\n"), "path.cls: the file holds no GOTO");
  // A definition line of SINUMERIK and its PTP are no KRL.
  EXPECT_EQ(guess("DEF REAL _A\nG0 X0 Y0 Z0\nPTP G0 X1\n").substr(0, 13), "path.cls:3:1:");
}

TEST(CamPath, KeysOfTheJobThatHoldForAnotherFormatAreErrors) {
  CamReadOptions options;
  options.circle = CircleSense::kAxis;
  const auto error = [&](const std::string& text) {
    try {
      ReadCamPath(text, "x", options);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(error("UNITS/MM\nGOTO/1,2,3\n"), "");
  EXPECT_EQ(error("G0 X0 Y0 Z0\n"),
            "x: toolpath.cam.circle holds for APT CLDATA alone, and the file is G-code");
  options = {};
  options.tip_programming = true;
  EXPECT_EQ(error("x_mm,y_mm,z_mm\n1,2,3\n"),
            "x: toolpath.cam.tip_programming holds for G-code alone, and the file is CSV");
  options = {};
  options.kinematics_codes = {{428, true}};
  EXPECT_EQ(error("GOTO/1,2,3\n"),
            "x: toolpath.cam.kinematics_codes holds for G-code alone, and the file is APT CLDATA");
}

TEST(CamImport, SlicesComeBackFromAptAndCsv) {
  const std::string file = std::string(SourceDir()) + "/toolpaths/cabin_ring/cabin_ring.stl";
  const Mesh mesh = ImportMesh(ReadMesh(ReadFile(file), file), {}, file).mesh;
  ToolpathOptions options;
  options.stepover = 8;
  With<Rings>(options);
  options.region.facing = Eigen::Vector3d::UnitZ();
  options.region.facing_within = DegToRad(1);
  options.lead = DegToRad(3);
  options.feed_rate = 12.5;
  const Toolpath made = MakeToolpath(mesh, options, {});
  CamImportOptions import;
  import.spacing = 100;
  for (const std::string& text : {WriteApt(made, "ring"), WriteCamCsv(made)}) {
    CamImportReport report;
    const Toolpath read = ImportCamPath(ReadCamPath(text, "x", {}), &mesh, import, &report);
    ASSERT_EQ(read.passes.size(), made.passes.size());
    EXPECT_LT(report.largest_distance.value(), 1e-4);
    for (size_t i = 0; i < made.passes.size(); ++i) {
      EXPECT_TRUE(read.passes[i].closed);
      ASSERT_EQ(read.passes[i].points.size(), made.passes[i].points.size());
      for (size_t k = 0; k < made.passes[i].points.size(); ++k) {
        const MillingPoint &a = made.passes[i].points[k], &b = read.passes[i].points[k];
        EXPECT_LT((a.position - b.position).norm(), 1e-4);
        EXPECT_LT((a.tool_axis - b.tool_axis).norm(), 1e-8);
        EXPECT_LT((a.normal - b.normal).norm(), 1e-6);
        EXPECT_LT((a.feed - b.feed).norm(), 5e-3);  // chords, not tangents
        EXPECT_NEAR(a.feed_rate, b.feed_rate, 1e-9);
      }
    }
  }
}

TEST(CamImport, RapidsSplitPassesAndFarEndsAreLeads) {
  const Mesh mesh = SoundMesh(GridShape(10, 10, 10));
  CamImportOptions options;
  options.spacing = 4;
  options.feed_rate = 3;
  CamImportReport report;
  const Toolpath toolpath =
      ImportCamPath(Apt("RAPID\nGOTO/10,10,20,0,0,1\nGOTO/10,10,0\nGOTO/30,10,0\nGOTO/30,10,20\nRAPID\nGOTO/"
                        "50,50,0\nGOTO/60,50,0\nRAPID\nGOTO/0,0,90\n"),
                    &mesh, options, &report);
  ASSERT_EQ(toolpath.passes.size(), 2);
  const auto& points = toolpath.passes[0].points;
  ASSERT_EQ(points.size(), 1 + 5 + 5 + 5);
  EXPECT_EQ(points[0].kind, PointKind::kLeadIn);
  EXPECT_EQ(points[4].kind, PointKind::kLeadIn);
  EXPECT_EQ(points[5].kind, PointKind::kCut);
  EXPECT_EQ(points[10].kind, PointKind::kCut);
  EXPECT_EQ(points[11].kind, PointKind::kLeadOut);
  EXPECT_EQ(report.leads, 10);
  for (const MillingPoint& point : points) {
    EXPECT_EQ(point.normal, Eigen::Vector3d::UnitZ());
    EXPECT_LT((point.feed - Eigen::Vector3d::UnitX()).norm(), 1e-9);
    EXPECT_EQ(point.feed_rate, 3);
  }
  EXPECT_EQ(points[5].source_line, 3);
}

TEST(CamImport, LongWaysAreBounded) {
  try {
    ImportCamPath(Apt("GOTO/0,0,0\nGOTO/0,0,999999999\n"), nullptr, {}, nullptr);
    FAIL() << "let pass";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 40), "toolpath.spacing_mm: given 5; with line ");
  }
}

TEST(CamImport, WithoutAMeshTheAxisIsTheNormal) {
  const Toolpath toolpath =
      ImportCamPath(Apt("PAINT/PATH\nGOTO/0,0,0,0,0.6,0.8\nGOTO/10,0,0\nGOTO/10,0,0,0,0,1\nGOTO/10,9,0\n"),
                    nullptr, {}, nullptr);
  ASSERT_EQ(toolpath.passes.size(), 2);  // the axis turns on the spot
  EXPECT_EQ(toolpath.passes[0].points[0].normal, Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_THROW(ImportCamPath(Apt("RAPID\nGOTO/0,0,0\nRAPID\nGOTO/1,0,0\n"), nullptr, {}, nullptr),
               InputError);
}

}  // namespace
}  // namespace millpose
