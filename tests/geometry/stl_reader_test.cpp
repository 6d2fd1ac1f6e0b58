// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/stl_reader.hpp"

#include <cstring>

#include "base/error.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/replaced.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

const Triangles kStlBox = BoxShape({0, 0, 0}, {1, 2, 3});

void ExpectBox(const RawMesh& mesh) {
  ASSERT_EQ(mesh.triangles.faces.size(), 12);
  const Triangles soup = Soup(kStlBox);
  EXPECT_EQ(mesh.triangles.faces, soup.faces);
  EXPECT_EQ(mesh.triangles.vertices, soup.vertices);
}

std::string StlError(const std::string& bytes) {
  return RefusalOf([&] { ReadMesh(bytes, "part.stl"); });
}

std::string Upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

TEST(StlReader, ReadsBinaryAlsoBehindASolidHeader) {
  ExpectBox(ReadMesh(BinaryStl(kStlBox), "part.stl"));
  ExpectBox(ReadMesh(BinaryStl(kStlBox, "solid made by a CAD system"), "part.stl"));
  ExpectBox(ReadMesh(BinaryStl(kStlBox, "solid x\nfacet normal"), "part.stl"));
}

TEST(StlReader, ReadsTextInAnyCaseWithAnyLineEnds) {
  const std::string text = TextStl(kStlBox);
  ExpectBox(ReadMesh(text, "part.stl"));
  ExpectBox(ReadMesh(Upper(text), "part.stl"));
  ExpectBox(ReadMesh(Everywhere(text, "\n", "\r\n"), "part.stl"));
  ExpectBox(ReadMesh(Everywhere(text, "\n", "\r"), "part.stl"));
  ExpectBox(ReadMesh("\n  " + Everywhere(text, "solid test", "solid"), "part.stl"));
}

TEST(StlReader, ReadsSeveralSolidsAndNotesAMissingEnd) {
  const std::string text = TextStl(kStlBox);
  EXPECT_EQ(ReadMesh(text + text, "part.stl").triangles.faces.size(), 24);
  const RawMesh mesh = ReadMesh(text.substr(0, text.find("endsolid")), "part.stl");
  ExpectBox(mesh);
  ASSERT_EQ(mesh.notes.size(), 1);
  EXPECT_EQ(mesh.notes[0], "\"endsolid\" is missing at the end");
}

TEST(StlReader, NotesBytesBehindTheLastFacet) {
  const RawMesh mesh = ReadMesh(BinaryStl(kStlBox) + "tail", "part.stl");
  ExpectBox(mesh);
  EXPECT_EQ(mesh.notes, std::vector<std::string>{"4 bytes behind the last facet were ignored"});
}

TEST(StlReader, RefusesWhatTheSizeCannotHold) {
  std::string bytes = BinaryStl(kStlBox);
  EXPECT_EQ(StlError(bytes.substr(0, 300)),
            "part.stl, byte 80: the header promises 12 facets, the 300 bytes of the file hold 4: the file is "
            "cut off "
            "or not an STL");
  std::memset(&bytes[80], 0xff, 4);
  EXPECT_EQ(StlError(bytes).substr(0, 61), "part.stl, byte 80: the header promises 4294967295 facets, the");
  EXPECT_EQ(StlError(""), "part.stl: the file is empty");
  EXPECT_EQ(StlError("solid nothing\nendsolid nothing\n"), "part.stl: the file holds no triangles");
  EXPECT_EQ(StlError(BinaryStl({})), "part.stl: the file holds no triangles");
  EXPECT_EQ(
      StlError("short"),
      "part.stl:1:1: text of no known mesh format begins with \"short\"; STL, OBJ, PLY, OFF, STEP, IGES and "
      "3MF are read");
}

TEST(StlReader, RefusesNumbersThatAreNotFinite) {
  std::string bytes = BinaryStl(kStlBox);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&bytes[84 + 50 * 3 + 12 + 4], &nan, 4);
  EXPECT_EQ(StlError(bytes), "part.stl, byte 246: facet 4: vertex (0, nan, 3) is not finite");
  EXPECT_EQ(StlError(Everywhere(TextStl(kStlBox), "vertex 1 2 3", "vertex 1 inf 3")).substr(0, 67),
            "part.stl:20:16: expected a finite number, found \"inf\"");
}

TEST(StlReader, TellsThePlaceOfWhatItCannotRead) {
  EXPECT_EQ(StlError("solid a\nfacet normal 0 0 1\n outer loop\n  vertex 1 2 x3\n"),
            "part.stl:4:14: expected a finite number, found \"x3\"");
  EXPECT_EQ(StlError("solid a\nfacet normal 0 0 1\n outer loop\n  vertex 1 2 3\n  vertex 1 2 3\n endloop\n"),
            "part.stl:6:2: expected \"vertex\", found \"endloop\"");
  EXPECT_EQ(StlError("solid a\rfacet normal 0 0 1\r outer lop\r"),
            "part.stl:3:8: expected \"loop\", found \"lop\"");
  EXPECT_EQ(StlError("solid a\nfacet normal 0 0 1\n outer loop\n  vertex 1 2"),
            "part.stl:4:13: expected a finite number, found the end of the file");
}

std::string Joined(std::string lines) {
  std::ranges::replace(lines, '\n', ' ');
  return lines;
}

TEST(StlReader, PassesOverWordsBehindAFacet) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n";
  const RawMesh mesh =
      ReadStl("solid a\n" + facet + "endfacet 0.5 red\n" + facet + "endfacet\nendsolid a\n", "part");
  EXPECT_EQ(mesh.triangles.faces.size(), 2);
  EXPECT_EQ(mesh.notes, std::vector<std::string>{"words behind 1 \"endfacet\" were ignored"});
  const RawMesh line =
      ReadStl("solid a\n" + Joined(facet) + "endfacet " + Joined(facet) + "endfacet endsolid", "part");
  EXPECT_EQ(line.triangles.faces.size(), 2);
  EXPECT_TRUE(line.notes.empty());
}

}  // namespace
}  // namespace millpose
